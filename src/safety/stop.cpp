#include "safety/stop.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/joint_twist.h"
#include "core/motion.h"

namespace predictor {
namespace {

// The gains with which an arm follows the other arm's lead in speed [-] and in distance [1/s].
// After division by the arm's own lag, these gains are half of the gains at which the loop through
// arm and measurement would oscillate. The maximum gains apply to an arm that is represented by its
// commands.
constexpr double kSpeedLag = 0.045, kDistanceLag = 0.45, kMaxSpeedGain = 6, kMaxDistanceGain = 60;
// Differences below this share of the initial speed are treated as noise.
constexpr double kThreshold = 0.05;
// If the initial speed is below this value, neither arm waits for the other [m/s].
constexpr double kMinSpeed = 0.01;

double Product(const Twist& a, const Twist& b) noexcept {
  return a.head<3>().dot(b.head<3>()) + kStopLength * kStopLength * a.tail<3>().dot(b.tail<3>());
}

}  // namespace

StopController::StopController(const SafetySpec& safety,
                               const std::array<JointBounds, kHands>& bounds, double dt,
                               const std::array<double, kHands>& lags)
    : StopController(safety, bounds, dt, lags, lags) {}

StopController::StopController(const SafetySpec& safety,
                               const std::array<JointBounds, kHands>& bounds, double dt,
                               const std::array<double, kHands>& lags,
                               const std::array<double, kHands>& overruns)
    : safety_(safety), bounds_(bounds), dt_(dt), lags_(lags), overruns_(overruns) {
  Reset();
}

void StopController::Reset() noexcept {
  report_ = {};
  profile_ = {};
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    command_[arm].setZero(bounds_[arm].lower.size());
    corrected_[arm] = command_[arm];
  }
  for (ArmBrake& brake : brakes_) brake = {};
  gone_ = followed_ = {};
  profile_left_ = after_ = 0;
  rest_ = {};
  ticks_ = rest_ticks_ = still_ticks_ = 0;
  active_ = done_ = timed_out_ = seen_ = twists_known_ = twists_split_ = false;
}

// Returns a bound of the handles' speed or acceleration, at most `max`, that keeps each joint
// within `share` of its own bound. Joints and handles move in proportion to the commands that
// caused `handle_speed` [m/s].
double StopController::Allowance(JointVector JointBounds::*bound, double share, double handle_speed,
                                 double max) const noexcept {
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const JointVector& bounds = bounds_[arm].*bound;
    const Eigen::Index joints = std::min(command_[arm].size(), bounds.size());
    for (Eigen::Index i = 0; i < joints; ++i) {
      const double joint_speed = std::abs(command_[arm][i]);
      if (joint_speed > 0) max = std::min(max, share * bounds[i] * handle_speed / joint_speed);
    }
  }
  return max;
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
  // The joints may move while the handles stand still. If the handles stand still, only the joints'
  // bounds matter. The allowance expresses these bounds in proportion to any nonzero speed.
  speed = moving ? std::max(speed, 1e-6) : 0;
  // If one joint were clipped at its velocity bound while the others accelerated, its handle would
  // leave its path.
  profile_ = StopProfile(
      Allowance(&JointBounds::acceleration, kShareOfJoints, speed, safety_.stop_acceleration),
      safety_.stop_jerk, dt_, Allowance(&JointBounds::velocity, 1, speed, safety_.handle_speed));
  profile_.Begin(speed, handle_rate);
  profile_left_ = profile_.Distance();
  const bool both = command_[0].size() > 0 && command_[1].size() > 0;
  const double longest = std::max(overruns_[0], overruns_[1]);
  for (std::size_t arm = 0; arm < kHands; ++arm)
    brakes_[arm] = ArmBrake(profile_, both ? longest - overruns_[arm] : 0, dt_);
}

// Returns the share of its initial speed by which each arm must speed up to keep up with the other
// arm.
std::array<double, kHands> StopController::Behind(const StopGeometry& geometry,
                                                  int ticks) noexcept {
  std::array<double, kHands> behind = {}, speed = {};
  if (!geometry.measured) return behind;
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const double square = Product(begun_[arm], begun_[arm]);
    if (!(square > kMinSpeed * kMinSpeed)) return behind;
    speed[arm] =
        MakesUp(arm) ? brakes_[arm].factor() : Product(geometry.V_W[arm], begun_[arm]) / square;
    gone_[arm] += speed[arm] * ticks * dt_;
  }
  for (std::size_t arm = 0; arm < kHands; ++arm) {
    const std::size_t other = 1 - arm;
    // In this comparison, an arm that is represented by its commands has no lag.
    const double lag = std::max(MakesUp(arm) ? 0.0 : lags_[arm], 1e-3);
    const double share =
        std::min(kMaxSpeedGain, kSpeedLag / lag) * (speed[other] - speed[arm]) +
        std::min(kMaxDistanceGain, kDistanceLag / lag) * (gone_[other] - gone_[arm]) - kThreshold;
    // An arm that brakes later because the other arm overruns more is not regarded as following the
    // other arm.
    const double max = kMaxFollowing + std::max(0.0, overruns_[other] - overruns_[arm]);
    const double braking =
        (brakes_[arm].RemainingDistance() - profile_left_) / std::max(1e-9, profile_.speed());
    const bool may = followed_[arm] + braking < max && after_ < kMaxFollowingTime;
    if (may && share > 0) behind[arm] = std::min(share, 1.0);
  }
  return behind;
}

// `geometry` may be null.
std::array<double, kHands> StopController::NextFactors(const StopGeometry* geometry,
                                                       int ticks) noexcept {
  std::array<double, kHands> factors{}, behind{};
  for (int tick = 0; tick < ticks; ++tick) {
    const double common = profile_.Next();
    profile_left_ -= common * profile_.speed() * dt_;
    if (profile_.done()) after_ += dt_;
    if (tick == 0 && geometry) behind = Behind(*geometry, ticks);
    for (std::size_t arm = 0; arm < kHands; ++arm) {
      factors[arm] = brakes_[arm].Next(common, profile_.rate_now(), behind[arm]);
      followed_[arm] += (factors[arm] - common) * dt_;
    }
  }
  return factors;
}

bool StopController::commands_rest() const noexcept {
  return brakes_[0].done() && brakes_[1].done();
}

void StopController::Next(std::array<JointVector, kHands>* v, int ticks) noexcept {
  const auto factors = NextFactors(nullptr, ticks);
  for (std::size_t arm = 0; arm < kHands; ++arm) (*v)[arm] = factors[arm] * corrected_[arm];
}

namespace {

// Returns joint velocities that add `V` to the handle's twist, by damped least squares.
JointVector JointsFor(const Twist& V, const Jacobian& J) noexcept {
  constexpr double kDamping = 0.03;  // singular values below this are hardly used
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

// The twists of the handles due to the last command. The twist of the right handle is split into
// two parts. The part that moves with the left handle as one rigid body follows that body. The rest
// of the right handle's twist, which tracking added, keeps its direction.
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
    const double max = kMaxCorrection * out.norm();
    if (!std::isfinite(size)) continue;
    out += std::min(1.0, max / std::max(size, 1e-300)) * correction;
    corrected_[arm] = out / factor;
  }
}

void StopController::Observe(const std::array<Pose, kHands>& X_WH, bool in_motion) noexcept {
  if (!active_ || done_) return;
  if (!seen_) {
    seen_ = true;
    rest_.Start(X_WH);
    return;
  }
  report_.duration = ++ticks_ * dt_;
  const bool moved = rest_.Update(X_WH, in_motion);
  // After its last command, an arm may be moved back a little. The arm counts as at rest only after
  // this last motion.
  still_ticks_ = moved || !commands_rest() ? 0 : still_ticks_ + 1;
  if (!commands_rest()) return;
  const bool rests = still_ticks_ * dt_ >= kRestTime;
  done_ = rests || ++rest_ticks_ * dt_ >= kPatience;
  timed_out_ = !rests;
  // The time at which the arms rest is the time of the handles' last motion.
  if (rests) report_.duration = (ticks_ - still_ticks_) * dt_;
}

void StopController::Archive(StateArchive& a) noexcept {
  a(profile_, brakes_, gone_, followed_, profile_left_, after_, report_.status, report_.time,
    report_.duration, command_, corrected_, twist_, begun_, twists_known_, twists_split_,
    rest_.still_, ticks_, rest_ticks_, still_ticks_, active_, done_, timed_out_, seen_,
    rest_.mover_);
  if (rest_.mover_ < -1 || rest_.mover_ >= kHands) a.Fail();
}

}  // namespace predictor
