// Finds the lifts of a run and assesses them with lifting equations.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "assessment/hand_samples.h"
#include "ergonomics/damage.h"
#include "ergonomics/lm_mmh.h"
#include "ergonomics/niosh.h"
#include "person/body_sample.h"

namespace predictor::assessment {

struct Lift {
  bool one_hand = false;      // lifted with one hand: the lifting equations do not apply
  double begin = 0, end = 0;  // [s]
  ergonomics::HandPlace origin, destination;  // points midway between the gripping hands
  double vertical_force = 0;                  // sum over the hands, averaged over the lift, upwards
                                              // [N]
  ergonomics::AssistedLift niosh;
  ergonomics::Acceptable acceptable;  // acceptable mass by LM-MMH [kg]
  double share_that_accepts = 0;      // share of people of the same sex, 0 … 1
  // LiFFT with the largest moment during the lift [N·m], as one repetition. Without values if the
  // moment is not known.
  std::optional<double> moment, day_share;
  bool outside_lifft() const { return moment.value_or(0) > ergonomics::kLargestLiftMoment; }
};

// Design choices [m]: a lift is a rise of at least kMinLift between two turning points of the
// height, and a turning point is a reversal by more than kReversal.
inline constexpr double kMinLift = 0.05;
inline constexpr double kReversal = 0.02;

// Returns the lifts during which at least one hand gripped all the time. `object_mass` is in [kg].
// The frequency of lifting is the frequency in this run.
std::vector<Lift> LiftsOf(std::span<const PersonSample> samples, const person::Stance& stance,
                          double object_mass, Sex sex);

// Adds the damage of each lift. `moment` is the moment of LiFFT at each of the samples [N·m],
// low-passed with SmoothMoment.
void AddDamageOfLifts(std::span<const PersonSample> samples, std::span<const double> moment,
                      std::vector<Lift>* lifts);

}  // namespace predictor::assessment
