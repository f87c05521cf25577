#include "devices/franka/rate_limiter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace predictor::fci {
namespace {

// A Panda's velocity limits do not depend on the position.
constexpr double kEverywhere = std::numeric_limits<double>::infinity();

constexpr JointLimits kPanda = {{
    {-2.8973, 2.8973, 2.1750, 15.0, 7500, kEverywhere, 0},
    {-1.7628, 1.7628, 2.1750, 7.5, 3750, kEverywhere, 0},
    {-2.8973, 2.8973, 2.1750, 10.0, 5000, kEverywhere, 0},
    {-3.0718, -0.0698, 2.1750, 12.5, 6250, kEverywhere, 0},
    {-2.8973, 2.8973, 2.6100, 15.0, 7500, kEverywhere, 0},
    {-0.0175, 3.7525, 2.6100, 20.0, 10000, kEverywhere, 0},
    {-2.8973, 2.8973, 2.6100, 20.0, 10000, kEverywhere, 0},
}};

// Two publications state different ranges. The ranges here are the narrower ones. The published
// velocity limits belong to the wider range (2.75010, ...). The decelerations here, which are
// published as 2 · deceleration, belong to the wider range too.
constexpr JointLimits kResearch3 = {{
    {-2.7437, 2.7437, 2.62, 10, 5000, 12.0 / 2, 0.30},
    {-1.7837, 1.7837, 2.62, 10, 5000, 5.17 / 2, 0.20},
    {-2.9007, 2.9007, 2.62, 10, 5000, 7.00 / 2, 0.20},
    {-3.0421, -0.1518, 2.62, 10, 5000, 8.00 / 2, 0.30},
    {-2.8065, 2.8065, 5.26, 10, 5000, 34.0 / 2, 0.35},
    {0.5445, 4.5169, 4.18, 10, 5000, 11.0 / 2, 0.35},
    {-3.0159, 3.0159, 5.26, 10, 5000, 34.0 / 2, 0.35},
}};

// Distance kept from the end of a joint's range [rad].
constexpr double kEnd = 0.001;
// The share of the acceleration that is used for braking before the end of a range. The remaining
// share is for following the request.
constexpr double kBraking = 0.8;
// Assumed delay before a joint brakes [s]. Lost commands and the limited jerk at the start of
// braking cause this delay.
constexpr double kLate = RateLimiter::kCoasting + 0.005;

// Returns the largest speed towards the end of the range that is permitted at the distance d and on
// the remaining way.
double Cap(const JointLimit& limit, double d) noexcept {
  const double D = std::min(limit.deceleration, kBraking * limit.acceleration);
  // This speed is the solution of v = sqrt(2 D (d − late · v)) − offset.
  const double b = limit.offset + D * kLate;
  const double root = b * b - limit.offset * limit.offset + 2 * D * std::max(0.0, d - kEnd);
  return std::clamp(std::sqrt(std::max(0.0, root)) - b, 0.0, limit.velocity);
}

// Returns the largest acceleration from which the velocity reaches its target without overshoot.
// The velocity differs from the target by `way`, and the acceleration falls by jerk · dt per
// millisecond. If the acceleration falls to zero in n + r such steps, with r below 1, the velocity
// still changes by (n + 1)(n / 2 + r) · jerk · dt².
double Reaching(const JointLimit& limit, double way) noexcept {
  const double step = limit.jerk * RateLimiter::kDt;
  const double u = way / (step * RateLimiter::kDt);
  const double n = std::floor((std::sqrt(1 + 8 * u) - 1) / 2);
  const double r = u / (n + 1) - n / 2;
  return std::min((n + r) * step, limit.acceleration);
}

// Returns the largest acceleration after which the robot can coast and stay below `cap`. While the
// acceleration then falls to zero, the velocity changes by a²/2j. This change is at most a · dt,
// because each published jerk is 500 times the acceleration limit.
double Coasting(double v, double cap) noexcept {
  return std::max(0.0, cap - v) / (RateLimiter::kCoasting + 2 * RateLimiter::kDt);
}

double NextVelocity(const JointLimit& limit, double q, double v, double a, double asked,
                    bool missed) noexcept {
  constexpr double dt = RateLimiter::kDt;
  const double up = Cap(limit, limit.upper - q), down = Cap(limit, q - limit.lower);
  const double target = std::isfinite(asked) ? std::clamp(asked, -down, up) : 0;
  const double way = target - v;
  double wish = std::copysign(Reaching(limit, std::abs(way)), way);
  wish = std::clamp(wish, std::min(0.0, -Coasting(-v, down)), Coasting(v, up));
  if (missed && wish * v > 0) wish = 0;
  const double next = std::clamp(wish, a - limit.jerk * dt, a + limit.jerk * dt);
  const double v_next = v + next * dt;
  constexpr double kRounding = 1e-12;  // [rad/s]
  return std::abs(target - v_next) < kRounding ? target : v_next;
}

}  // namespace

const JointLimits& PublishedLimits(std::uint16_t version) {
  return version == kPandaVersion ? kPanda : kResearch3;
}

RateLimiter::RateLimiter(const JointLimits& limits, double fraction) : limits_(limits) {
  if (!(fraction > 0 && fraction <= 0.99))
    throw std::invalid_argument("the fraction of the limits must be above 0 and at most 0.99");
  for (JointLimit& limit : limits_) {
    limit.velocity *= fraction;
    limit.acceleration *= fraction;
    limit.jerk *= fraction;
  }
}

void RateLimiter::Start(const Joints& v, const Joints& a) noexcept {
  v_ = v;
  a_ = a;
}

const Joints& RateLimiter::Next(const Joints& asked, const Joints& q, bool missed) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double v = NextVelocity(limits_[i], q[i], v_[i], a_[i], asked[i], missed);
    a_[i] = (v - v_[i]) / kDt;
    v_[i] = v;
  }
  return v_;
}

bool RateLimiter::AtRest() const noexcept {
  const auto zero = [](double x) { return x == 0; };
  return std::all_of(v_.begin(), v_.end(), zero) && std::all_of(a_.begin(), a_.end(), zero);
}

void WayBack::Begin(const Joints& v, const Joints& a) noexcept {
  v_ = v;
  a_ = a;
  time_ = 0;
}

// Follows the cubic polynomial that starts with velocity v and acceleration a and ends with zero
// velocity and zero acceleration.
Joints WayBack::Next() noexcept {
  Joints left{};
  time_ += RateLimiter::kDt;
  const double s = time_ / kTime;
  if (s >= 1) return left;
  for (std::size_t i = 0; i < kJoints; ++i)
    left[i] = (1 - s) * (1 - s) * (v_[i] * (1 + 2 * s) + a_[i] * time_);
  return left;
}

}  // namespace predictor::fci
