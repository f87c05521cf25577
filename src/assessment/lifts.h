// Finds the lifts and lowerings of a run and assesses them with lifting equations.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "assessment/hand_samples.h"
#include "ergonomics/damage.h"
#include "ergonomics/lm_mmh.h"
#include "ergonomics/niosh.h"
#include "person/body_sample.h"

namespace predictor::assessment {

// A lift or a lowering.
struct Lift {
  bool lowered = false;
  bool one_hand = false;      // moved with one hand: the lifting equations do not apply
  double begin = 0, end = 0;  // [s]
  // Points midway between the gripping hands at `begin` and `end`, but with the heights at which
  // the whole rise or fall starts and ends.
  ergonomics::HandPlace origin, destination;
  double vertical_force = 0;       // sum over the hands, averaged over the lift, upwards
                                   // [N]
  ergonomics::LiftTask task;       // the whole object, without the cobot, at the rate of all lifts
  ergonomics::AssistedLift niosh;  // of a lift only, not of a lowering
  ergonomics::Acceptable acceptable;  // acceptable mass by LM-MMH [kg]
  double share_that_accepts = 0;      // share of people of the same sex, 0 … 1; meaningless if
                                      // acceptable.outside
  // LiFFT with the largest moment during the lift [N·m], as one repetition. Without values if the
  // moment is not known.
  std::optional<double> moment, day_share;
  bool outside_lifft() const { return moment.value_or(0) > ergonomics::kLargestLiftMoment; }
};

// The lifts of a run, or of several runs, as one job with several tasks.
struct LiftingJob {
  std::size_t lifts = 0;
  double minutes = 0;  // duration of the runs
  // Composite lifting indices, for the masses that the hands carry and for the whole objects.
  double carried = 0, unassisted = 0;
};

// What a recording does not state about the lifts.
struct LiftingWork {
  double object_mass = 0;  // [kg]
  Sex sex = Sex::kMale;
  ergonomics::LiftDuration duration = ergonomics::LiftDuration::kShort;
  ergonomics::Coupling coupling = ergonomics::Coupling::kGood;
};

// Design choices [m]: a lift is a rise of at least kMinLift between two turning points of the
// height, and a turning point is a reversal by more than kReversal. A lowering is a fall instead of
// a rise. The object leaves the first height, and arrives at the last, when it is half of kReversal
// away.
inline constexpr double kMinLift = 0.05;
inline constexpr double kReversal = 0.02;

// Returns the lifts and lowerings during which at least one hand gripped all the time, in the order
// of time. The frequencies of lifting and of lowering are those in this run.
std::vector<Lift> LiftsOf(std::span<const PersonSample> samples, const person::Stance& stance,
                          const LiftingWork& work);

// Returns the lifts with two hands as one job. Each lift is a task that is repeated once in the
// duration of all runs. Lowerings are not part of the job.
LiftingJob JobOf(std::span<const Lift> lifts, double minutes);

// Returns how often a hand exerts itself: each time that it takes its handle, or, if there are
// more, each lift and lowering that begins before it lets go (design choice).
std::size_t ExertionsOf(std::span<const PersonSample> samples, std::size_t hand,
                        std::span<const Lift> lifts);

// Returns the diagonal of the smallest horizontal rectangle, along the axes of S, that contains all
// places of the hands' middle [m]. No horizontal movement of the run is longer.
double HorizontalTravel(std::span<const PersonSample> samples, const person::Stance& stance);

// Adds the damage of each lift. `moment` is the moment of LiFFT at each of the samples [N·m],
// low-passed with SmoothMoment.
void AddDamageOfLifts(std::span<const PersonSample> samples, std::span<const double> moment,
                      std::vector<Lift>* lifts);

}  // namespace predictor::assessment
