#include "safety/stop.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace predictor {

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

double StopProfile::Next() noexcept {
  if (done_) return 0;
  const double speed = SpeedAt(++tick_ * dt_);
  // Rounding must not leave a last crawl of 1e-20 m/s.
  done_ = speed < 1e-12 * speed_ || tick_ * dt_ >= duration();
  return done_ ? 0 : speed / speed_;
}

StopController::StopController(const SafetySpec& safety,
                               const std::array<JointBounds, kHands>& bounds, double dt)
    : safety_(safety), bounds_(bounds), dt_(dt) {
  Reset();
}

void StopController::Reset() noexcept {
  report_ = {};
  profile_ = {};
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    command_[arm].setZero(bounds_[arm].lower.size());
    corner_[arm].setZero();
    still_[arm].setZero();
  }
  path_ = {};
  ticks_ = rest_ticks_ = still_ticks_ = 0;
  active_ = done_ = seen_ = twists_known_ = twists_split_ = false;
}

// Deceleration of the handles [m/s²] at which no joint needs more than its acceleration.
double StopController::JointAllowance(double handle_speed) const noexcept {
  double allowed = safety_.stop_acceleration;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const Eigen::Index joints = std::min(command_[arm].size(), bounds_[arm].acceleration.size());
    for (Eigen::Index i = 0; i < joints; ++i) {
      const double joint_speed = std::abs(command_[arm][i]);
      if (joint_speed == 0) continue;
      const double a = kShareOfJoints * bounds_[arm].acceleration[i];
      allowed = std::min(allowed, a * handle_speed / joint_speed);
    }
  }
  return allowed;
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
    command_[arm] = last_command[arm];
    moving = moving || (command_[arm].array() != 0).any();
  }
  twists_known_ =
      handle_twists && (*handle_twists)[0].allFinite() && (*handle_twists)[1].allFinite();
  if (twists_known_) twist_ = *handle_twists;
  double speed = std::isfinite(handle_speed) ? handle_speed : safety_.handle_speed;
  // Joints may move while the handles stand: then the joints' bounds alone decide, which the
  // allowance expresses in proportion to any speed but zero.
  speed = moving ? std::max(speed, 1e-6) : 0;
  profile_ = StopProfile(JointAllowance(speed), safety_.stop_jerk, dt_, safety_.handle_speed);
  profile_.Begin(speed, handle_rate);
}

void StopController::Next(std::array<JointVector, kHands>* v) noexcept {
  const double factor = profile_.Next();
  for (std::size_t arm = 0; arm < kHands; ++arm) (*v)[arm] = factor * command_[arm];
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
  constexpr double kLength = 0.2;    // weighs rotation against translation [m]
  Vector6 weight;
  weight << 1, 1, 1, kLength, kLength, kLength;
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
    twist_[arm] = TwistOf(geometry.J[arm], command_[arm]);
  twists_known_ = twists_split_ = true;
  if (geometry.J[0].cols() > 0)
    twist_[1] -= ShiftTwist(twist_[0], geometry.p_WH[1] - geometry.p_WH[0]);
}

void StopController::Next(const StopGeometry& geometry,
                          std::array<JointVector, kHands>* v) noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm)
    if (geometry.J[arm].cols() != command_[arm].size()) return Next(v);
  if (!twists_split_) BeginTwists(geometry);
  const double factor = profile_.Next();
  const bool both = geometry.J[0].cols() > 0;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
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
    if (std::isfinite(size)) out += std::min(1.0, most / std::max(size, 1e-300)) * correction;
  }
}

void StopController::Observe(const std::array<Vector3, kHands>& p_WH) noexcept {
  if (!active_ || done_) return;
  if (!seen_) {
    seen_ = true;
    corner_ = still_ = p_WH;
    return;
  }
  report_.duration = ++ticks_ * dt_;
  bool moved = false;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const double step = (p_WH[arm] - corner_[arm]).norm();
    if (step >= kPathStep) {
      path_[arm] += step;
      corner_[arm] = p_WH[arm];
    }
    const double rest = step >= kPathStep ? 0 : step;
    report_.distance = std::max(report_.distance, path_[arm] + rest);
    moved = moved || (p_WH[arm] - still_[arm]).norm() > kRest;
  }
  still_ticks_ = moved ? 0 : still_ticks_ + 1;
  if (moved) still_ = p_WH;
  if (!profile_.done()) return;
  const bool rests = still_ticks_ * dt_ >= kRestTime;
  done_ = rests || ++rest_ticks_ * dt_ >= kPatience;
  // They came to rest when they last moved.
  if (rests) report_.duration = (ticks_ - still_ticks_) * dt_;
}

}  // namespace predictor
