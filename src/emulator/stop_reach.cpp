#include "emulator/stop_reach.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "emulator/placement.h"
#include "haptics/limits.h"
#include "haptics/stability.h"
#include "rig/velocity_loop.h"
#include "safety/stop.h"

namespace predictor {
namespace {

// By which an arm that follows a position is pulled to it [1/s]. No maker gives a figure: assumed.
constexpr double kPull = 20;
constexpr double kRest = 5e-3;     // slower is at rest [m/s]
constexpr double kBefore = 2;      // of going on, so that the loop has settled [s]
constexpr double kPatience = 1.5;  // for its end after the commands' [s]

// One direction of a handle, as its arm's velocity loop moves it.
class Handle {
 public:
  Handle(const ArmSpec& arm, double dt)
      : loop_(arm.loop, arm.loop.delay, dt, std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()),
        pull_(arm.follows_position ? kPull : 0),
        dt_(dt) {}
  // The way that it goes within a tick [m].
  double Step(double v) noexcept {
    const double before = loop_.q();
    loop_.Step(v + pull_ * (led_ - before));
    led_ += v * dt_;
    return std::abs(loop_.q() - before);
  }

 private:
  VelocityLoop loop_;
  double pull_, dt_;
  double led_ = 0;  // where its velocities lead [m]
};

// hold: before it brakes [s].
StopBudget StopOf(const ArmSpec& arm, const StopProfile& profile, double hold, double dt) {
  Handle handle(arm, dt);
  for (double t = -kBefore; t < 0; t += dt)
    handle.Step(std::max(0.0, profile.speed() + std::max(0.0, profile.rate()) * t));
  StopBudget stop{0, 0};
  for (double t = dt; t < hold + profile.duration() + kPatience; t += dt) {
    const double way = handle.Step(t < hold ? profile.speed() : profile.SpeedAt(t - hold));
    stop.way += way;
    if (way > kRest * dt) stop.time = t;
  }
  return stop;
}

}  // namespace

double CoastingOf(const ArmSpec& arm, double dt) {
  return arm.follows_position ? dt : HapticLoop::Lag(arm.loop, dt);
}

double LeastStopAcceleration(const Scenario& s) {
  double least = s.safety.stop_acceleration;
  for (int hand = 0; hand < kHands; ++hand) {
    if (!s.Has(hand)) continue;
    const ArmLimits limits = LimitsOf(s.arm(hand), *LoadArm(s, hand));
    const double slowest = (limits.acceleration.array() / limits.velocity.array()).minCoeff();
    least = std::min(least, StopController::kShareOfJoints * slowest * s.safety.handle_speed);
  }
  return least;
}

StopBudget StopOfArms(const Scenario& s, double acceleration) {
  const double dt = 1 / s.rate, speed = s.safety.handle_speed, jerk = s.safety.stop_jerk;
  double latest = 0;
  for (int hand = 0; hand < kHands; ++hand)
    if (s.Has(hand)) latest = std::max(latest, CoastingOf(s.arm(hand), dt));
  // At that speed, or speeding up to it as WorstStop does.
  const double rate = std::min(acceleration, std::sqrt(0.4 * jerk * speed));
  StopBudget worst{0, 0};
  for (const double up : {0.0, rate}) {
    StopProfile profile(acceleration, jerk, dt, speed);
    profile.Begin(speed - up * up / (2 * jerk), up);
    for (int hand = 0; hand < kHands; ++hand) {
      if (!s.Has(hand)) continue;
      const ArmSpec& arm = s.arm(hand);
      const StopBudget stop = StopOf(arm, profile, latest - CoastingOf(arm, dt), dt);
      worst.time = std::max(worst.time, stop.time);
      worst.way = std::max(worst.way, stop.way);
    }
  }
  if (!s.Has(0) || !s.Has(1)) return worst;
  return {worst.time + StopController::kMostFollowing,
          worst.way + StopController::kMostFollowing * speed};
}

}  // namespace predictor
