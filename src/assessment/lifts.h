// The lifts of a run, and what lifting equations say about them.
#pragma once

#include <span>
#include <vector>

#include "assessment/hand_samples.h"
#include "ergonomics/lm_mmh.h"
#include "ergonomics/niosh.h"
#include "person/body_sample.h"

namespace predictor::assessment {

struct Lift {
  bool one_hand = false;                      // then the equations do not apply
  double begin = 0, end = 0;                  // [s]
  ergonomics::HandPlace origin, destination;  // of the middle of the gripping hands
  double vertical_force = 0;                  // mean over the lift, of all hands, upwards [N]
  ergonomics::AssistedLift niosh;
  ergonomics::Acceptable acceptable;  // by LM-MMH, of the carried mass [kg]
  double share_that_accepts = 0;      // of the person's sex, 0 … 1
};

// Design choices: a lift is a rise of at least this height between two turning points of the
// height, and a turning point is a reversal by more than the second value. Both [m].
inline constexpr double kMinLift = 0.05;
inline constexpr double kReversal = 0.02;

// The lifts during which at least one hand gripped all the time. `object_mass` [kg]. The frequency
// is that of this run.
std::vector<Lift> LiftsOf(std::span<const PersonSample> samples, const person::Stance& stance,
                          double object_mass, Sex sex);

}  // namespace predictor::assessment
