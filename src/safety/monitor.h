// The safety monitor checks each tick once, after rendering, and reports the first fault.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/archive.h"
#include "core/messages.h"
#include "safety/oscillation.h"
#include "safety/runaway.h"
#include "safety/vibration.h"
#include "scenario/scenario.h"

namespace predictor {

// All data that the monitor checks. The supervisor writes it.
struct MonitorInput {
  Hands present;
  const DeviceSample* sample = nullptr;            // null in direct mode
  std::array<HandWrench, kHands> wrench;           // absent hands are not checked
  std::array<FrameMotion, kHands> real, virtual_;  // handles H and D
  const WorldState* world = nullptr;
  // `render` is null in direct mode and in ticks in which the renderer did not run.
  const RenderResult* render = nullptr;
  std::array<JointVector, kHands> lower, upper;  // joint limits of the arms [rad]
  std::array<JointVector, kHands> velocity;      // maximum that may be commanded [rad/s]
  Status device, sensing, simulation, haptics;   // reported by the stages
  bool running = false;  // RUN: thresholds of tracking, coupling and oscillation apply
  bool follows = true;   // ALIGN, RUN: distances to joint and link limits are checked
  // In RECOVERY, a hand may be loaded, but the motion must not increase the load.
  bool recovers = false;
  int missed_deadlines = 0;  // number of consecutive missed deadlines
};

// The time between samples of a device [s], or 0 if it provides a sample in each tick.
struct SamplePeriods {
  double arm = 0, sensor = 0;
};

// Most checks use only the present tick. The checks for frozen readings, jumps, oscillation,
// vibration and runaway also use past ticks. The supervisor latches the reported fault.
//
// Of several faults in one tick, the first of these is reported:
//   1. faults of the stages, in the order device, sensing, simulation, haptics: each invalidates
//      the results of the later stages;
//   2. device: an arm is missing, has a fault, or sends the wrong number of joints;
//   3. sensor, physics, qp: a number that is not finite, or saturated: no threshold can be checked;
//      device: joints that jumped farther than any arm can move;
//   4. force, then torque: the load that the person at the handles feels;
//   5. stale: a sample that is too old, then a frozen sensor;
//   6. elbow, joint: the arms are about to collide or reach a limit;
//   7. tracking, coupling, oscillation or vibration, runaway: the emulation no longer behaves as
//      intended (RUN only);
//   8. deadline: missed ticks that have had no other effect so far.
// Some faults mean that an arm or sensor is no longer reliable enough to hold the arm: silence,
// saturation, a jump, or a stage that requests power-off. A stop with such a fault ends without
// power, even if another fault is reported. If both hands exceed their limits, the hand that
// exceeds its limit more is reported. A value that is NaN is treated as exceeding every threshold.
// For NaN, the value and the limit in the status are zero.
class Monitor {
 public:
  // The run stops if two links are closer than the security distance by more than this margin [m].
  // Rendering itself keeps the security distance. The margin covers the arms' lag behind the
  // command and the encoders' resolution. The resolution of 1e-5 rad for each of up to seven
  // joints, at up to 1 m, amounts to 0.07 mm.
  static constexpr double kLinkDistanceMargin = 0.001;
  // The run stops if a joint exceeds its limit by this margin [rad]. The margin is a hundred times
  // the encoders' resolution, and a twentieth of the distance that rendering keeps from the limit.
  static constexpr double kJointMargin = 0.001;
  // The run stops after kMissedDeadlines consecutive missed deadlines. The run also stops if the
  // share kMissedShare of the deadlines of one second is missed.
  static constexpr int kMissedDeadlines = 3;
  static constexpr double kMissedShare = 0.01;
  // An arm or sensor without a sample for this time is treated as silent and not only as late [s].
  static constexpr double kSilence = 0.020;
  // A joint has jumped if its motion between two samples exceeds this factor times the largest
  // commanded motion, plus this tolerance for the encoder [rad].
  static constexpr double kJumpFactor = 2.5, kJumpSlack = 0.002;
  // In RECOVERY, the limit of a hand's force is safety.force or the hand's smallest force since
  // RECOVERY began plus this share of safety.force, whichever is higher. The limit of the torque is
  // computed in the same way.
  static constexpr double kRecoveryRise = 1.0 / 3;
  // A sample is stale if its age exceeds both safety.max_age and this number of periods of its
  // device. A device may lose one sample, but not two consecutive samples.
  static constexpr double kMaxPeriods = 2.5;

  // `dt` is the duration of a tick [s]. `detects_runaway` states whether a sensor may be mounted or
  // wired in the wrong orientation.
  Monitor(const SafetySpec& safety, const RenderingSpec& rendering,
          const std::array<bool, kHands>& sensor_has_noise, double dt,
          const std::array<SamplePeriods, kHands>& periods = {}, bool detects_runaway = false);

  // Returns the first fault of this tick in the order above, or ok if there is none. Does not use
  // the heap or throw.
  Status Check(const MonitorInput& input) noexcept;
  // Returns whether joints jumped in the last Check, regardless of the fault that Check returned.
  bool jumped() const noexcept { return jumped_; }
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept {
    a(safety_.force, safety_.torque, oscillation_, vibration_, runaway_, past_, joints_, least_,
      missed_, was_running_);
  }
  // Sets the thresholds of a hand's wrench from now on [N], [N·m].
  void SetThresholds(double force, double torque) noexcept {
    safety_.force = force;
    safety_.torque = torque;
  }

 private:
  struct SensorPast {
    Wrench reading = Wrench::Zero();
    std::uint64_t sequence = 0;
    int same = 0;  // number of consecutive fresh readings with this value; 0: none
    void Archive(StateArchive& a) noexcept { a(reading, sequence, same); }
  };

  // The joints of an arm at the arm's last sample.
  struct JointPast {
    std::array<double, kMaxArmJoints> q{};
    std::uint64_t sequence = 0;
    double age = 0;  // time since that sample [s]
    bool known = false;
    void Archive(StateArchive& a) noexcept { a(q, sequence, age, known); }
  };

  // The smallest load of a hand since RECOVERY began [N], [N·m].
  struct Load {
    double force = HUGE_VAL, torque = HUGE_VAL;
    void Archive(StateArchive& a) noexcept { a(force, torque); }
  };

  void FollowSensors(const MonitorInput& input) noexcept;
  void FollowRecovery(const MonitorInput& input) noexcept;
  Status FollowJoints(const MonitorInput& input) noexcept;
  Status FollowDeadlines(const MonitorInput& input) noexcept;
  Status FollowOscillation(const MonitorInput& input) noexcept;
  Status FollowRunaway(const MonitorInput& input) noexcept;
  Status PowerOffFault(const MonitorInput& input, const Status& jump) const noexcept;
  // Returns the age [s] above which a device with this period is treated as silent.
  static constexpr double SilenceOf(double period) noexcept {
    return std::max(kSilence, kMaxPeriods * period);
  }
  Status CheckStages(const MonitorInput& input) const noexcept;
  Status CheckNumbers(const MonitorInput& input) const noexcept;
  Status CheckWrenches(const MonitorInput& input) const noexcept;
  Status CheckAge(const MonitorInput& input) const noexcept;
  Status CheckAges(const MonitorInput& input) const noexcept;
  Status CheckDistances(const MonitorInput& input) const noexcept;
  Status CheckEmulation(const MonitorInput& input) const noexcept;

  SafetySpec safety_;
  double security_distance_;
  std::array<bool, kHands> sensor_has_noise_;
  std::array<SamplePeriods, kHands> periods_;
  std::array<OscillationDetector, kHands> oscillation_;
  std::array<VibrationDetector, kHands> vibration_;
  std::array<RunawayDetector, kHands> runaway_;
  bool detects_runaway_ = false;
  std::array<SensorPast, kHands> past_;
  std::array<JointPast, kHands> joints_;
  std::array<Load, kHands> least_;
  double missed_ = 0;  // missed deadlines of about the last second
  double dt_;
  bool was_running_ = false;
  bool jumped_ = false;
};

}  // namespace predictor
