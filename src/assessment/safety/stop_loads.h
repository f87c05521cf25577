// Computes the loads that a stop of the emulator causes in the joints of the person who holds the
// handles.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "assessment/frame.h"
#include "assessment/hand_samples.h"
#include "assessment/person_setup.h"
#include "evaluation/stops.h"
#include "person/posture_samples.h"

namespace predictor::assessment {

// A stop, and the samples from kBefore before its decision until kAfter after the arms come to
// rest. A hand that held a handle when the stop was decided counts as still holding the handle,
// because a person cannot let go that quickly. A simulated operator, in contrast, lets go at a
// stop. The operator's force then fades, but the posture remains.
struct StopWindow {
  StopSummary stop;
  std::vector<PersonSample> samples;  // samples at kSampleRate
  std::size_t decided = 0;            // the first sample after the decision
};

// Extracts the time windows around the stops from a run.
class StopWindows {
 public:
  static constexpr double kBefore = 0.2, kAfter = 0.1;  // [s]
  static constexpr double kLongest = 1.5;               // maximum length of a window [s]
  static constexpr std::size_t kMaxCuts = 20;           // maximum number of stops; later ones are
                                                        // ignored

  explicit StopWindows(const Scenario& scenario);
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns all stops that have been found so far. The windows of these stops are complete or end
  // with the run.
  std::vector<StopWindow> windows() const;

 private:
  struct Cut {
    std::vector<TickRecord> ticks;
    std::size_t decided = 0;  // index into ticks
    std::size_t after = 0;    // ticks since the arms came to rest
    bool open = true;
  };
  StopWindow WindowOf(const Cut& cut, const StopSummary& stop) const;

  std::size_t ticks_a_sample_;
  StopLog log_;
  std::uint64_t stops_ = 0;
  std::deque<TickRecord> recent_;  // previous ticks, for at most kBefore
  std::vector<Cut> cuts_;          // one for each of the first kMaxCuts stops
};

// The torque of one joint during a stop. No value is a number if the joint belongs to a shoulder
// that is raised during the stop (see IsRaised), or if a posture is unknown (see Frame).
struct StopLoad {
  std::string joint;  // "left shoulder flexion"
  double before = 0;  // torque when the stop was decided [N·m]
  double peak = 0;    // largest magnitude since the decision [N·m]
  // Change of the torque since the decision that has the largest magnitude, which the stop caused
  // [N·m].
  double change = 0;
  std::optional<person::Interval> change_90;  // 90 % interval over the possible postures [N·m]
  std::optional<double> use;                  // largest share of mean strength; empty if the
                                              // program has no strength for this joint
};

struct StopJudgement {
  StopSummary stop;
  std::vector<StopLoad> loads;  // loads of the arms that held a handle
};

// Wrenches and motions are measured at 100 Hz (means of 10 ms). The accelerations of the posture
// are low-passed at 6 Hz, so the inertial load of the person's own arm is underestimated. The
// measured wrench includes the inertial load of the object that the hand holds.
StopJudgement JudgeStop(const PersonSetup& setup, const StopWindow& window, bool intervals);

}  // namespace predictor::assessment
