#include "safety/stop.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/motion.h"

namespace predictor {
namespace {

// Following: how strongly an arm takes up the other's speed [-] and way [1/s], times its own lag:
// half of where the loop through arm and measurement would swing; and that at most, as for an arm
// that counts by its commands. What is smaller
// than the threshold, as a share of the first speed, is noise; so is what comes from speeds below
// the slowest [m/s].
constexpr double kSpeedLag = 0.045, kWayLag = 0.45, kMostOfSpeed = 6, kMostOfWay = 60;
constexpr double kThreshold = 0.05, kSlowest = 0.01;

double Product(const Twist& a, const Twist& b) noexcept {
  return a.head<3>().dot(b.head<3>()) + kStopLength * kStopLength * a.tail<3>().dot(b.tail<3>());
}

}  // namespace

StopProfile::StopProfile(double acceleration, double jerk, double dt, double speed_cap)
    : acceleration_(acceleration), jerk_(jerk), dt_(dt), cap_(speed_cap) {}

void StopProfile::Begin(double speed, double rate) noexcept {
  tick_ = 0;
  speed_ = std::isfinite(speed) ? std::max(0.0, speed) : 0;
  done_ = speed_ == 0;
  // What the speed may still gain, and from which deceleration it would pass through zero.
  const double gain = std::max(0.0, std::min(cap_ - speed_, (kOvershoot - 1) * speed_));
  const double highest = std::min(acceleration_, std::sqrt(2 * jerk_ * gain));
  const double lowest = std::max(-acceleration_, -std::sqrt(2 * jerk_ * speed_));
  rate_ = std::isfinite(rate) ? std::clamp(rate, lowest, highest) : 0;
  // Jerk −j down to −peak, hold, jerk +j back to zero; without the hold the speed lost in the two
  // ramps is (2 peak² − rate²)/2j.
  const double peak = std::sqrt(jerk_ * speed_ + rate_ * rate_ / 2);
  peak_ = std::min(acceleration_, peak);
  const double lost = (2 * peak_ * peak_ - rate_ * rate_) / (2 * jerk_);
  ramp_in_ = (rate_ + peak_) / jerk_;
  hold_ = peak_ < peak ? (speed_ - lost) / peak_ : 0;
  ramp_out_ = peak_ / jerk_;
}

double StopProfile::SpeedAt(double t) const noexcept {
  if (t < ramp_in_) return speed_ + t * (rate_ - jerk_ * t / 2);
  const double left = duration() - t;
  if (left <= 0) return 0;
  if (left < ramp_out_) return jerk_ * left * left / 2;
  return jerk_ * ramp_out_ * ramp_out_ / 2 + peak_ * (left - ramp_out_);
}

double StopProfile::RateAt(double t) const noexcept {
  if (t < ramp_in_) return rate_ - jerk_ * t;
  const double left = duration() - t;
  if (left <= 0) return 0;
  return left < ramp_out_ ? -jerk_ * left : -peak_;
}

double StopProfile::Next() noexcept {
  if (done_) return 0;
  const double speed = SpeedAt(++tick_ * dt_);
  // Rounding must not leave a last crawl of 1e-20 m/s.
  done_ = speed < 1e-12 * speed_ || tick_ * dt_ >= duration();
  return done_ ? 0 : speed / speed_;
}

double StopProfile::Way() const noexcept {
  const double in = ramp_in_, out = ramp_out_;
  const double v = speed_ + in * (rate_ - jerk_ * in / 2);
  return in * (speed_ + in * (rate_ / 2 - jerk_ * in / 6)) + hold_ * (v - peak_ * hold_ / 2) +
         jerk_ * out * out * out / 6;
}

double BrakeShare::FurtherWay() const noexcept {
  StopProfile hard = brake_;
  hard.Begin(factor_ * first_, rate_);
  return hard.Way();
}

BrakeShare::BrakeShare(const StopProfile& begun, double hold, double dt)
    : brake_(begun),
      first_(begun.speed()),
      hold_(hold),
      rate_(begun.rate()),
      dt_(dt),
      factor_(begun.done() ? 0 : 1) {}

double BrakeShare::Next(double common, double rate, double behind) noexcept {
  if (factor_ == 0) return 0;
  const bool holds = hold_ > 0.5 * dt_;
  apart_ = apart_ || holds || behind > 0;
  hold_ -= dt_;
  const double speed = factor_ * first_;
  if (!apart_) {
    rate_ = rate;
    return factor_ = common;
  }
  // Between braking as hard as may be and letting go of the brake, both within the jerk.
  const double step = brake_.jerk() * dt_;
  const double soft_rate = rate_ < 0 ? std::min(0.0, rate_ + step) : std::max(0.0, rate_ - step);
  const double soft = speed + (rate_ + soft_rate) / 2 * dt_;
  brake_.Begin(speed, rate_);
  const double hard = brake_.SpeedAt(dt_), hard_rate = brake_.RateAt(dt_);
  // Near rest what is left to do is not worth creeping.
  const bool creeps = factor_ < kThreshold && common == 0;
  const double wanted = holds ? soft : creeps ? 0 : (common + behind) * first_;
  const double share = soft > hard ? std::clamp((wanted - hard) / (soft - hard), 0.0, 1.0) : 0.0;
  rate_ = hard_rate + share * (soft_rate - hard_rate);
  factor_ = (hard + share * (soft - hard)) / first_;
  // Rounding must not leave a last crawl.
  if (factor_ < 1e-9) factor_ = 0;
  return factor_;
}

StopController::StopController(const SafetySpec& safety,
                               const std::array<JointBounds, kHands>& bounds, double dt,
                               const std::array<double, kHands>& lags)
    : StopController(safety, bounds, dt, lags, lags) {}

StopController::StopController(const SafetySpec& safety,
                               const std::array<JointBounds, kHands>& bounds, double dt,
                               const std::array<double, kHands>& lags,
                               const std::array<double, kHands>& coasting)
    : safety_(safety), bounds_(bounds), dt_(dt), lags_(lags), coasting_(coasting) {
  Reset();
}

void StopController::Reset() noexcept {
  report_ = {};
  profile_ = {};
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    command_[arm].setZero(bounds_[arm].lower.size());
    corrected_[arm] = command_[arm];
    corner_[arm].setZero();
    still_[arm] = {};
  }
  for (BrakeShare& share : shares_) share = {};
  gone_ = followed_ = path_ = {};
  way_left_ = after_ = 0;
  ticks_ = rest_ticks_ = still_ticks_ = 0;
  mover_ = -1;
  active_ = done_ = restless_ = seen_ = twists_known_ = twists_split_ = false;
}

// What the handles may do, `most` at most, so that no joint does more than `share` of its bound:
// all go in the proportion of the commands to `handle_speed` [m/s].
double StopController::Allowance(JointVector JointBounds::*bound, double share, double handle_speed,
                                 double most) const noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const JointVector& bounds = bounds_[arm].*bound;
    const Eigen::Index joints = std::min(command_[arm].size(), bounds.size());
    for (Eigen::Index i = 0; i < joints; ++i) {
      const double joint_speed = std::abs(command_[arm][i]);
      if (joint_speed > 0) most = std::min(most, share * bounds[i] * handle_speed / joint_speed);
    }
  }
  return most;
}

void StopController::Begin(const Status& cause, double time,
                           const std::array<JointVector, kHands>& last_command, double handle_speed,
                           double handle_rate,
                           const std::array<Twist, kHands>* handle_twists) noexcept {
  if (active_) {
    if (report_.status.ok()) report_.status = cause;
    return;
  }
  Reset();
  active_ = true;
  report_.status = cause;
  report_.time = time;
  bool moving = false;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    if (!last_command[arm].allFinite()) continue;  // stays at zero
    command_[arm] = corrected_[arm] = last_command[arm];
    moving = moving || (command_[arm].array() != 0).any();
  }
  twists_known_ =
      handle_twists && (*handle_twists)[0].allFinite() && (*handle_twists)[1].allFinite();
  if (twists_known_) twist_ = begun_ = *handle_twists;
  double speed = std::isfinite(handle_speed) ? handle_speed : safety_.handle_speed;
  // Joints may move while the handles stand: then the joints' bounds alone decide, which the
  // allowance expresses in proportion to any speed but zero.
  speed = moving ? std::max(speed, 1e-6) : 0;
  // A joint that was cut at its velocity while the others sped up would lead its handle astray.
  profile_ = StopProfile(
      Allowance(&JointBounds::acceleration, kShareOfJoints, speed, safety_.stop_acceleration),
      safety_.stop_jerk, dt_, Allowance(&JointBounds::velocity, 1, speed, safety_.handle_speed));
  profile_.Begin(speed, handle_rate);
  way_left_ = profile_.Way();
  const bool both = command_[0].size() > 0 && command_[1].size() > 0;
  const double latest = std::max(coasting_[0], coasting_[1]);
  for (std::size_t arm = 0; arm < kHands; ++arm)
    shares_[arm] = BrakeShare(profile_, both ? latest - coasting_[arm] : 0, dt_);
}

// By which share of its first speed each arm has to be faster to keep up with the other.
std::array<double, kHands> StopController::Behind(const StopGeometry& geometry,
                                                  int ticks) noexcept {
  std::array<double, kHands> behind = {}, speed = {};
  if (!geometry.measured) return behind;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const double square = Product(begun_[arm], begun_[arm]);
    if (!(square > kSlowest * kSlowest)) return behind;
    // Less than its lag remains of an arm only if it makes up for it.
    const bool makes_up = coasting_[arm] < lags_[arm];
    speed[arm] =
        makes_up ? shares_[arm].factor() : Product(geometry.V_W[arm], begun_[arm]) / square;
    gone_[arm] += speed[arm] * ticks * dt_;
  }
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const std::size_t other = 1 - arm;
    // One that counts by its commands is measured without its lag.
    const double lag = std::max(coasting_[arm] < lags_[arm] ? 0.0 : lags_[arm], 1e-3);
    const double share = std::min(kMostOfSpeed, kSpeedLag / lag) * (speed[other] - speed[arm]) +
                         std::min(kMostOfWay, kWayLag / lag) * (gone_[other] - gone_[arm]) -
                         kThreshold;
    // What it brakes later than the other for its own lag's sake is not following.
    const double most = kMostFollowing + std::max(0.0, coasting_[other] - coasting_[arm]);
    const double braking =
        (shares_[arm].FurtherWay() - way_left_) / std::max(1e-9, profile_.speed());
    const bool may = followed_[arm] + braking < most && after_ < kMostFollowingTime;
    if (may && share > 0) behind[arm] = std::min(share, 1.0);
  }
  return behind;
}

// geometry: or null.
std::array<double, kHands> StopController::NextFactors(const StopGeometry* geometry,
                                                       int ticks) noexcept {
  std::array<double, kHands> factors{}, behind{};
  for (int tick = 0; tick < ticks; ++tick) {
    const double common = profile_.Next();
    way_left_ -= common * profile_.speed() * dt_;
    if (profile_.done()) after_ += dt_;
    if (tick == 0 && geometry) behind = Behind(*geometry, ticks);
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      factors[arm] = shares_[arm].Next(common, profile_.rate_now(), behind[arm]);
      followed_[arm] += (factors[arm] - common) * dt_;
    }
  }
  return factors;
}

bool StopController::commands_rest() const noexcept {
  return shares_[0].done() && shares_[1].done();
}

void StopController::Next(std::array<JointVector, kHands>* v, int ticks) noexcept {
  const auto factors = NextFactors(nullptr, ticks);
  for (std::size_t arm = 0; arm < kHands; ++arm) (*v)[arm] = factors[arm] * corrected_[arm];
}

namespace {

Twist TwistOf(const Jacobian& J, const JointVector& v) noexcept {
  Twist V = Twist::Zero();
  for (Eigen::Index j = 0; j < J.cols(); ++j) V += v[j] * J.col(j);
  return V;
}

// Joint velocities that add `V` to the handle's twist, by damped least squares.
JointVector JointsFor(const Twist& V, const Jacobian& J) noexcept {
  constexpr double kDamping = 0.03;  // singular values below it are hardly used
  Vector6 weight;
  weight << 1, 1, 1, kStopLength, kStopLength, kStopLength;
  Matrix6 JJt = kDamping * kDamping * Matrix6::Identity();
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    const Vector6 column = weight.cwiseProduct(J.col(j));
    JJt.noalias() += column * column.transpose();
  }
  const Vector6 y = weight.cwiseProduct(Vector6(JJt.llt().solve(weight.cwiseProduct(V))));
  JointVector v(J.cols());
  for (Eigen::Index j = 0; j < J.cols(); ++j) v[j] = J.col(j).dot(y);
  return v;
}

}  // namespace

// Twists of the handles by the last command. That of the right one is split: what it has as one
// rigid body with the left is carried along by it, what is left (tracking's own) keeps its
// direction.
void StopController::BeginTwists(const StopGeometry& geometry) noexcept {
  for (std::size_t arm = 0; arm < kHands && !twists_known_; ++arm)
    twist_[arm] = begun_[arm] = TwistOf(geometry.J[arm], command_[arm]);
  twists_known_ = twists_split_ = true;
  if (geometry.J[0].cols() > 0)
    twist_[1] -= ShiftTwist(twist_[0], geometry.p_WH[1] - geometry.p_WH[0]);
}

void StopController::Next(const StopGeometry& geometry, std::array<JointVector, kHands>* v,
                          int ticks) noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm)
    if (geometry.J[arm].cols() != command_[arm].size()) return Next(v, ticks);
  if (!twists_split_) BeginTwists(geometry);
  const auto factors = NextFactors(&geometry, ticks);
  const bool both = geometry.J[0].cols() > 0;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const double factor = factors[arm];
    JointVector& out = (*v)[arm];
    out = factor * command_[arm];
    if (out.size() == 0 || factor == 0) continue;
    Twist wanted = factor * twist_[arm];
    if (arm == 1 && both)
      wanted += ShiftTwist(Twist(factor * twist_[0]), geometry.p_WH[1] - geometry.p_WH[0]);
    const JointVector correction =
        JointsFor(wanted - TwistOf(geometry.J[arm], out), geometry.J[arm]);
    const double size = correction.norm();
    const double most = kMostCorrection * out.norm();
    if (!std::isfinite(size)) continue;
    out += std::min(1.0, most / std::max(size, 1e-300)) * correction;
    corrected_[arm] = out / factor;
  }
}

bool StopController::Moved(const Pose& from, const Pose& to) noexcept {
  return (to.p - from.p).norm() > kRest ||
         kHandleLength * RotationError(to.q, from.q).norm() > kRest;
}

void StopController::Observe(const std::array<Pose, kHands>& X_WH, bool in_motion) noexcept {
  if (!active_ || done_) return;
  if (!seen_) {
    seen_ = true;
    still_ = X_WH;
    for (std::size_t arm = 0; arm < kHands; ++arm) corner_[arm] = X_WH[arm].p;
    return;
  }
  report_.duration = ++ticks_ * dt_;
  bool moved = in_motion;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const double step = (X_WH[arm].p - corner_[arm]).norm();
    if (step >= kPathStep) {
      path_[arm] += step;
      corner_[arm] = X_WH[arm].p;
    }
    const double rest = step >= kPathStep ? 0 : step;
    report_.distance = std::max(report_.distance, path_[arm] + rest);
    if (!Moved(still_[arm], X_WH[arm])) continue;
    moved = true;
    mover_ = static_cast<int>(arm);
  }
  // An arm may be led back a little after its last command: it counts as still from then on only.
  still_ticks_ = moved || !commands_rest() ? 0 : still_ticks_ + 1;
  if (moved) still_ = X_WH;
  if (!commands_rest()) return;
  const bool rests = still_ticks_ * dt_ >= kRestTime;
  done_ = rests || ++rest_ticks_ * dt_ >= kPatience;
  restless_ = !rests;
  // They came to rest when they last moved.
  if (rests) report_.duration = (ticks_ - still_ticks_) * dt_;
}

}  // namespace predictor
