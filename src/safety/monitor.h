// The safety monitor: looks at one tick, once, after haptics, and says what is wrong.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/archive.h"
#include "core/messages.h"
#include "safety/oscillation.h"
#include "safety/runaway.h"
#include "scenario/scenario.h"

namespace predictor {

// Everything the monitor judges. Written by the emulator.
struct MonitorInput {
  std::array<bool, kHands> present = {};
  const DeviceSample* sample = nullptr;            // null in direct mode
  std::array<HandWrench, kHands> wrench;           // one that is not present is not judged
  std::array<FrameMotion, kHands> real, virtual_;  // handles H and D
  const WorldState* world = nullptr;
  // Null in direct mode and in a tick in which the renderer did not run.
  const RenderResult* render = nullptr;
  std::array<JointVector, kHands> lower, upper;  // joint limits of the arms [rad]
  std::array<JointVector, kHands> velocity;      // that may be commanded of them [rad/s]
  Status device, sensing, simulation, haptics;   // what the stages reported
  bool running = false;      // RUN: thresholds on tracking, coupling and oscillation count
  bool follows = true;       // ALIGN, RUN: the joints' limits count; elsewhere nothing goes there
  bool recovers = false;     // RECOVERY: a hand may be loaded, and no more by the motion
  int missed_deadlines = 0;  // in a row
};

// Between samples of a device [s]; 0 of one that samples each tick.
struct SamplePeriods {
  double arm = 0, sensor = 0;
};

// Judges each tick afresh, but for the sensors' frozen readings, the oscillation and what runs
// away, which need the past; latching what it finds is the StopController's part.
//
// Where several things are wrong in one tick, a person hears the first of:
//   1. what a stage reported, in the order device, sensing, simulation, haptics: each falsifies all
//      that comes after it, so that what follows is its consequence;
//   2. device: an arm is missing, at fault, or gives the wrong number of joints;
//   3. sensor, physics, qp: a number that is not finite, or saturated: no threshold can be judged;
//      device: joints that jumped as no arm can move;
//   4. force, then torque: what the person at the handles feels;
//   5. stale: a sample too old, then a sensor frozen;
//   6. elbow, joint: what the arms are about to hit;
//   7. tracking, coupling, oscillation, runaway: the emulation no longer does what it should (RUN
//   only);
//   8. deadline: ticks missed, without any effect so far.
// What says that an arm or sensor cannot be trusted to hold (silence, saturation, a jump, a stage
// that says so) asks for a stop that ends without power, also where a person hears of something
// else. Of two hands, the one that is further beyond its limit. Every
// threshold counts as exceeded by what is not a number. A status for something not finite carries
// zeros as value and limit.
class Monitor {
 public:
  // Link pairs nearer than the security distance by this stop [m]. Rendering approaches the
  // security distance from above without crossing it; what remains is the encoders' quantum (1e-5
  // rad of up to seven joints at up to 1 m: 0.07 mm) and the arms' lag behind the command.
  static constexpr double kElbowMargin = 0.001;
  // Joints beyond their limits by this stop [rad]: a hundred encoder quanta, and a twentieth of the
  // distance that rendering keeps.
  static constexpr double kJointMargin = 0.001;
  // Deadlines missed in a row that stop; and, one here and there, the share of a second's.
  static constexpr int kMissedDeadlines = 3;
  static constexpr double kMissedShare = 0.01;
  // Without any sample for so long, an arm or a sensor is silent, not late [s].
  static constexpr double kSilence = 0.020;
  // A joint that moved by more, over the time between two samples, has jumped: this many times what
  // may be commanded, and an encoder's slack [rad].
  static constexpr double kJumpFactor = 2.5, kJumpSlack = 0.002;
  // In RECOVERY a hand may be loaded by safety.force, or by the least since it began and this share
  // of safety.force more, whatever is higher; torque likewise.
  static constexpr double kRecoveryRise = 1.0 / 3;
  // Periods of its device after which a sample is too old, if they are longer than safety.max_age:
  // one may be lost, two not.
  static constexpr double kMostPeriods = 2.5;

  // dt: tick [s]. real: the sensors are, and so may read another way than they are pushed.
  Monitor(const SafetySpec& safety, const RenderingSpec& rendering,
          const std::array<bool, kHands>& sensor_has_noise, double dt,
          const std::array<SamplePeriods, kHands>& periods = {}, bool real = false);

  // The first thing wrong in this tick, in the order above; ok if none. No heap, no throw.
  Status Check(const MonitorInput& input) noexcept;
  // In the last Check joints had jumped, whatever else was told.
  bool jumped() const noexcept { return jumped_; }
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept {
    a(safety_.force, safety_.torque, oscillation_, runaway_, past_, joints_, least_, missed_,
      was_running_);
  }
  // Of a hand, from here on [N], [N·m].
  void SetThresholds(double force, double torque) noexcept {
    safety_.force = force;
    safety_.torque = torque;
  }

 private:
  struct SensorPast {
    Wrench reading = Wrench::Zero();
    std::uint64_t sequence = 0;
    int same = 0;  // fresh readings in a row with this payload; 0: none so far
    void Archive(StateArchive& a) noexcept { a(reading, sequence, same); }
  };

  // Joints of an arm at its last sample.
  struct JointPast {
    std::array<double, kMaxArmJoints> q{};
    std::uint64_t sequence = 0;
    double age = 0;  // ticks since [s]
    bool known = false;
    void Archive(StateArchive& a) noexcept { a(q, sequence, age, known); }
  };

  // Of a hand, the least since RECOVERY began [N], [N·m].
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
  Status MustNotHold(const MonitorInput& input, const Status& jump) const noexcept;
  // Age of a sample of such a period from which on it is silence [s].
  static constexpr double SilenceOf(double period) noexcept {
    return std::max(kSilence, kMostPeriods * period);
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
  std::array<RunawayDetector, kHands> runaway_;
  bool real_ = false;
  std::array<SensorPast, kHands> past_;
  std::array<JointPast, kHands> joints_;
  std::array<Load, kHands> least_;
  double missed_ = 0;  // deadlines, forgotten over a second
  double dt_;
  bool was_running_ = false;
  bool jumped_ = false;
};

}  // namespace predictor
