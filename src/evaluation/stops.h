// Derives the stops of a run from its records.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/record.h"
#include "core/rest_detector.h"
#include "scenario/scenario.h"

namespace predictor {

struct StopSummary {
  StopCause cause = StopCause::kNone;
  int hand = -1;                        // −1: neither
  double value = 0, limit = 0;          // SI
  Quantity quantity = Quantity::kNone;  // quantity of value and limit
  double time = 0;      // emulated time until the stop, including the time before resets [s]
  double duration = 0;  // time from the decision to rest [s]
  double distance = 0;  // path of the faster handle from the decision to rest [m]
  // The time from the moment when the true force (or torque) crosses its threshold to the decision
  // to stop. This time is known only for a simulated rig.
  std::optional<double> detection;  // [s]
  // If the simulation diverged, this is the joint of the cobot that was fastest in the last step
  // before the divergence, counted from 0. Otherwise −1.
  int fastest_joint = -1;
  StatusRecord harder = {};  // the fault that removed the power at the end of a stop that would
                             // otherwise have held
};

// Returns whether the arms did not come to rest although they were commanded to stop. The result is
// based on the final fault of the stop. If the run had ended without a cause, the result is based
// on the cause of the stop. In this case, duration and distance are only the values that were
// observed so far.
bool DidNotRest(const StopSummary& stop);

// Returns whether a stop censors what the person feels. The cause of such a stop is the force or
// the torque of a hand, the coupling, or tracking. (A stop because of tracking ends runs in which
// the handles would have to exceed their speed cap.) The largest values of such a run are lower
// bounds.
bool IsLimit(StopCause cause);

// Measures the lengths of the handles' paths in steps of kStep. With shorter steps, the
// quantisation of the encoders would accumulate.
class HandleOdometer {
 public:
  static constexpr double kStep = 1e-4;  // [m]

  // X_WH contains the poses of the handles. The poses of absent handles must be constant.
  void Start(const std::array<Pose, kHands>& X_WH) noexcept;
  // Returns the longer of the two handles' paths so far [m].
  double Add(const std::array<Pose, kHands>& X_WH) noexcept;

 private:
  // The position at the end of the last step of each path.
  std::array<Vector3, kHands> corner_ = {Vector3::Zero(), Vector3::Zero()};
  std::array<double, kHands> path_ = {};  // length up to the corner [m]
};

// Collects the stops. Add does not use the heap.
class StopLog {
 public:
  explicit StopLog(const Scenario& scenario);
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns the stops with a cause, in order. Only the first kMaxStops stops are kept, but count()
  // counts all stops.
  const std::vector<StopSummary>& stops() const { return stops_; }
  std::uint64_t count() const { return count_; }

  static constexpr std::size_t kMaxStops = 100;

 private:
  void FollowTime(const TickRecord& record);
  void FollowThresholds(const TickRecord& record);
  void FollowEnd(const TickRecord& record);
  void Begin(const TickRecord& record);
  void Measure(const TickRecord& record);

  std::vector<StopSummary> stops_;
  std::uint64_t count_ = 0;
  double force_, torque_;  // thresholds for `detection` [N], [N·m]
  double dt_;              // [s]
  std::array<double, kHands> force_crossed_,
      torque_crossed_;                // time of the last upward crossing [s]
  double before_ = 0, run_time_ = 0;  // emulated time before the last reset, and since then [s]
  StopCause cause_ = StopCause::kNone;

  // For the last stop, the path and the time of the handles from the decision to stop until the
  // handles are at rest.
  bool stopping_ = false;
  HandleOdometer odometer_;
  RestDetector rest_;
  std::uint64_t ticks_ = 0;  // number of ticks since the decision
};

}  // namespace predictor
