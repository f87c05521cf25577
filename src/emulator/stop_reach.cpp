#include "emulator/stop_reach.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "emulator/placement.h"
#include "haptics/stability.h"
#include "models/arm_limits.h"
#include "rig/velocity_loop.h"
#include "safety/stop.h"

namespace predictor {
namespace {

// The gain of the position loop of an arm that follows positions [1/s]. The value is an assumption,
// because no manufacturer publishes the gain.
constexpr double kPositionGain = 20;
constexpr double kMaxRestSpeed = 5e-3;  // [m/s]
constexpr double kSettlingTime = 2;     // time for the loop to settle before the stop begins [s]
constexpr double kPatience = 1.5;  // longest time from the end of the commands to the handle's rest
                                   // [s]

// The motion of a handle in one direction, as the arm's velocity loop executes it.
class Handle {
 public:
  Handle(const ArmSpec& arm, double dt)
      : loop_(arm.loop, arm.loop.delay, dt, std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()),
        gain_(arm.follows_position ? kPositionGain : 0),
        dt_(dt) {}
  // Returns the distance travelled in one tick with the command `v` [m].
  double Step(double v) noexcept {
    const double before = loop_.q();
    loop_.Step(v + gain_ * (led_ - before));
    led_ += v * dt_;
    return std::abs(loop_.q() - before);
  }

 private:
  VelocityLoop loop_;
  double gain_, dt_;
  double led_ = 0;  // integral of the commands [m]
};

// `hold` is the delay before the arm brakes [s].
StopBudget StopOf(const ArmSpec& arm, const StopProfile& profile, double hold, double dt) {
  Handle handle(arm, dt);
  for (double t = -kSettlingTime; t < 0; t += dt)
    handle.Step(std::max(0.0, profile.speed() + std::max(0.0, profile.rate()) * t));
  StopBudget stop{0, 0};
  for (double t = dt; t < hold + profile.duration() + kPatience; t += dt) {
    const double way = handle.Step(t < hold ? profile.speed() : profile.SpeedAt(t - hold));
    stop.way += way;
    if (way > kMaxRestSpeed * dt) stop.time = t;
  }
  return stop;
}

}  // namespace

double Overrun(const ArmSpec& arm, double dt) {
  return arm.follows_position ? dt : HapticLoop::Lag(arm.loop, dt);
}

double MinStopAcceleration(const Scenario& s) {
  double least = s.safety.stop_acceleration;
  for (const int hand : s.hands()) {
    const ArmLimits limits = LimitsOf(s.arm(hand), *LoadArm(s, hand));
    const double slowest = (limits.acceleration.array() / limits.velocity.array()).minCoeff();
    least = std::min(least, StopController::kShareOfJoints * slowest * s.safety.handle_speed);
  }
  return least;
}

StopBudget StopOfArms(const Scenario& s, double acceleration) {
  const double dt = 1 / s.rate, speed = s.safety.handle_speed, jerk = s.safety.stop_jerk;
  double latest = 0;
  for (const int hand : s.hands()) latest = std::max(latest, Overrun(s.arm(hand), dt));
  // The handles move at constant speed or accelerate to this speed, as in WorstStop.
  const double rate = std::min(acceleration, std::sqrt(0.4 * jerk * speed));
  StopBudget worst{0, 0};
  for (const double up : {0.0, rate}) {
    StopProfile profile(acceleration, jerk, dt, speed);
    profile.Begin(speed - up * up / (2 * jerk), up);
    for (const int hand : s.hands()) {
      const ArmSpec& arm = s.arm(hand);
      const StopBudget stop = StopOf(arm, profile, latest - Overrun(arm, dt), dt);
      worst.time = std::max(worst.time, stop.time);
      worst.way = std::max(worst.way, stop.way);
    }
  }
  if (!s.Has(0) || !s.Has(1)) return worst;
  return {worst.time + StopController::kMaxFollowing,
          worst.way + StopController::kMaxFollowing * speed};
}

}  // namespace predictor
