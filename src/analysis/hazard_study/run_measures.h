// Measures from the records of a run whether the emulator met its requirements. The measures are
// the time from the moment at which a hand's force exceeded the threshold to the stop, and the
// commanded speeds as shares of their caps.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "core/record.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns the smallest change of a force that a sensor distinguishes from its own noise [N]. This
// change is three standard deviations of a reading's noise and rounding. One reading in 370
// deviates by more.
double ResolvedForce(const SensorSpec& sensor);

// Finds the time at which the true force of each hand clearly exceeds `threshold` [N], that is, by
// more than `resolved` [N]. No monitor can detect a smaller excess in time, because the noise hides
// such an excess.
class ClearCrossing {
 public:
  ClearCrossing(double threshold, const std::array<double, kHands>& resolved)
      : threshold_(threshold), resolved_(resolved) {
    crossed_.fill(-1);
  }
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns how long the force of `hand` has clearly exceeded the threshold at the last record [s];
  // −1 if the force does not exceed the threshold.
  double duration(int hand) const;

 private:
  double threshold_;
  std::array<double, kHands> resolved_, crossed_;  // run time of the last upward crossing [s]
  double run_time_ = 0;                            // of the last record [s]
};

// Computes the handle speeds that were commanded in RUN, as shares of their caps. The speed is
// computed at the posture in which the arm obeys the command. This posture is the measured posture,
// advanced with the previous command by the lag of the arm's velocity loop. The cap on the handle's
// speed applies to the speed that is computed in this way. An object and its copies must be used by
// the same thread.
class CommandedSpeeds {
 public:
  // Throws InputError if an arm's model cannot be loaded.
  explicit CommandedSpeeds(const Scenario& scenario);
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns the largest share of safety.handle_speed or safety.handle_rotation_speed so far.
  double share() const { return share_; }

 private:
  struct Arm {
    std::shared_ptr<const RobotModel> model;
    std::shared_ptr<RobotData> data;  // workspace, which copies of the object share
    FrameId handle;
    double lag;        // [s]
    JointVector last;  // the previous command [rad/s]
  };
  std::array<std::optional<Arm>, kHands> arms_;  // empty: absent
  double speed_cap_, rotation_cap_;              // [m/s], [rad/s]
  double share_ = 0;
};

}  // namespace predictor
