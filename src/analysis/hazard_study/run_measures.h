// Measures from the records of a run whether the emulator kept its promises: how soon it stopped
// after a hand's force exceeded the threshold, and whether a commanded speed exceeded its cap.
#pragma once

#include <array>
#include <memory>

#include "core/record.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns the smallest change of a force that a sensor distinguishes from its own noise [N]: three
// standard deviations of a reading's noise and rounding, so that one reading in 370 deviates more.
double ResolvedForce(const SensorSpec& sensor);

// Finds when the true force of each hand exceeds `threshold` [N] clearly, that is by more than
// `resolved` [N]. No monitor can see a smaller excess in time, because it is hidden in the noise.
class ClearCrossing {
 public:
  ClearCrossing(double threshold, const std::array<double, kHands>& resolved)
      : threshold_(threshold), resolved_(resolved) {
    crossed_.fill(-1);
  }
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns the time for which the force of `hand` has exceeded the threshold clearly, in the last
  // record [s]; −1: it does not exceed it clearly.
  double duration(int hand) const;

 private:
  double threshold_;
  std::array<double, kHands> resolved_, crossed_;  // run time of the last upward crossing [s]
  double run_time_ = 0;                            // of the last record [s]
};

// Computes the speeds of the handles that were commanded in RUN, as a share of their caps. The
// speed is that at the posture in which the arm obeys the command: the measured one, moved on by
// the previous command for the lag of the arm's velocity loop. The cap is defined for this speed.
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
    RobotData data;
    FrameId handle;
    double lag;        // [s]
    JointVector last;  // the previous command [rad/s]
  };
  std::array<std::unique_ptr<Arm>, kHands> arms_;  // null: absent
  double speed_cap_, rotation_cap_;                // [m/s], [rad/s]
  double share_ = 0;
};

}  // namespace predictor
