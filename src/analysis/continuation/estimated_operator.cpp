#include "analysis/continuation/estimated_operator.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

constexpr double kAccelerationTime = 0.02;  // interval over which accelerations are computed [s]
constexpr double kMaxSightDelay = 0.5;      // [s]
Vector3 SpeedOf(const TickRecord& record, std::size_t hand) {
  const auto& twist = record.hands[hand].real.twist;
  return {twist[0], twist[1], twist[2]};
}

// Returns the acceleration of the handle at each record [m/s²]. The acceleration is a backward
// difference, because the motion after the last record is unknown.
std::vector<Vector3> AccelerationsOf(std::span<const TickRecord> past, std::size_t hand,
                                     double step) {
  const auto lag = static_cast<std::size_t>(std::max(1L, std::lround(kAccelerationTime / step)));
  std::vector<Vector3> a(past.size(), Vector3::Zero());
  for (std::size_t i = 1; i < past.size(); ++i) {
    const std::size_t from = i > lag ? i - lag : 0;
    a[i] = (SpeedOf(past[i], hand) - SpeedOf(past[from], hand)) /
           (step * static_cast<double>(i - from));
  }
  return a;
}

double LogUniform(double low, double high, RandomStream* random) {
  return low * std::pow(high / low, random->Uniform());
}

}  // namespace

OperatorDraw DrawOperator(const ArmDistribution& arms, const HandSpec& hand,
                          const IntentModel& intent, std::uint64_t seed, int number) {
  const std::string name = "continuation." + std::to_string(number);
  RandomStream of_arm(seed, name + ".arm"), of_intent(seed, name + ".intent");
  OperatorDraw draw;
  draw.arm = arms.Draw(&of_arm);
  draw.trend_time = LogUniform(intent.shortest_trend, intent.longest_trend, &of_intent);
  draw.change = intent.change * std::exp(intent.change_spread * of_intent.Normal());
  const bool ends = of_intent.Uniform() < intent.chance_of_end;
  const double end = LogUniform(intent.earliest_end, intent.latest_end, &of_intent);
  draw.end = ends ? end : HUGE_VAL;
  draw.stiffening = intent.max_stiffening * of_intent.Uniform();
  draw.sight = intent.max_sight * of_intent.Uniform() * hand.visual_stiffness;
  draw.sight_delay = std::min(
      hand.visual_delay * std::exp(intent.sight_delay_spread * of_intent.Normal()), kMaxSightDelay);
  draw.noise = RandomStream(seed, name + ".noise");
  return draw;
}

void EstimatedHand::Prepare(const HandRecord& first, double dt, const OperatorDraw& draw) {
  draw_ = draw;
  stiffness_ << draw.arm.stiffness, Vector3::Constant(draw.arm.rotation_stiffness);
  damping_ << draw.arm.Damping(), Vector3::Constant(draw.arm.rotation_damping);
  dt_ = dt;
  time_ = 0;
  origin_ = FromRecord(first.real.pose);
  stretch_.setZero();
  spring_.setZero();
  reflex_.Reset(draw.arm.reflex_delay / dt,
                damping_.cwiseProduct(Eigen::Map<const Vector6>(first.real.twist.data())));
  sight_.Reset(draw.sight_delay / dt, Vector3::Zero());
}

// Returns the wrench with which the arm resists a motion, without its inertia. `force` is the force
// of the hand. The arm becomes stiffer with a larger force.
Vector6 EstimatedHand::Resist(const Pose& X_W, const Twist& V_W, double force) noexcept {
  const double stiffer = 1 + draw_.stiffening * force / kStiffeningForce;
  const Vector6 stretch = PoseError(X_W, origin_);
  spring_ += stiffer * stiffness_.cwiseProduct(stretch - stretch_);
  stretch_ = stretch;
  const Vector6 z = spring_ + std::sqrt(stiffer) * damping_.cwiseProduct(V_W);
  Vector6 resistance = z + draw_.arm.reflex_gain * reflex_.Update(z);
  resistance.head<3>() += draw_.sight.cwiseProduct(sight_.Update(stretch.head<3>()));
  return resistance;
}

// The function also fills the delay lines with the values of the past. Between two records, the
// handle counts as being at rest.
std::vector<Vector6> EstimatedHand::DriveBefore(std::span<const TickRecord> past, std::size_t hand,
                                                double record_step) {
  const auto steps = static_cast<int>(std::max(1L, std::lround(record_step / dt_)));
  const std::vector<Vector3> a = AccelerationsOf(past, hand, record_step);
  std::vector<Vector6> drive(past.size());
  for (std::size_t i = 0; i < past.size(); ++i) {
    const HandRecord& h = past[i].hands[hand];
    const Pose X_W = FromRecord(h.real.pose);
    const Vector6 V_W = Eigen::Map<const Vector6>(h.real.twist.data());
    const Vector6 F = Eigen::Map<const Vector6>(h.wrench.data());
    force_ = F.head<3>().norm();
    torque_ = F.tail<3>().norm();
    for (int k = 0; k < steps; ++k) drive[i] = F + Resist(X_W, V_W, force_);
    drive[i].head<3>() += draw_.arm.mass * a[i];
  }
  return drive;
}

// Fits a straight line by least squares.
void EstimatedHand::FitTrend(const std::vector<Vector6>& drive, double record_step,
                             const IntentModel& intent) {
  const auto wanted = static_cast<std::size_t>(std::lround(draw_.trend_time / record_step)) + 1;
  const std::size_t n = std::min(drive.size(), std::max<std::size_t>(wanted, 2));
  const std::size_t first = drive.size() - n;
  Vector6 mean = Vector6::Zero(), cross = Vector6::Zero();
  double square = 0;
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (std::size_t i = 0; i < n; ++i) mean += drive[first + i] / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = (static_cast<double>(i) - middle) * record_step;
    cross += t * drive[first + i];
    square += t * t;
  }
  trend_ = cross / square;
  drive_ = mean + trend_ * middle * record_step;
  rest_ = drive.back() - drive_;
  const auto early = static_cast<std::size_t>(std::lround(kBaselineTime / record_step));
  const std::size_t earlier = std::clamp<std::size_t>(early, 1, drive.size());
  baseline_.setZero();
  for (std::size_t i = 0; i < earlier; ++i) baseline_ += drive[i] / static_cast<double>(earlier);
  const double rate = std::max(trend_.head<3>().norm(), 1e-9);
  persistence_ = std::clamp(draw_.change * force_ / rate, dt_, intent.longest_change);
}

void EstimatedHand::Begin(std::span<const TickRecord> past, std::size_t hand, double record_step,
                          double dt, const IntentModel& intent, const OperatorDraw& draw) {
  const HandRecord& last = past.back().hands[hand];
  holds_ = last.present != 0 && last.gripping != 0;
  if (!holds_) return;
  Prepare(past.front().hands[hand], dt, draw);
  FitTrend(DriveBefore(past, hand, record_step), record_step, intent);
  end_time_ = intent.end_time;
  keep_ = std::exp(-dt / intent.noise_time);
  kick_ = intent.noise * std::sqrt(1 - keep_ * keep_);
  speed_.setZero();
  moved_.setZero();
  speed_keep_ = std::exp(-dt / intent.wander_time);
  speed_kick_ = intent.wander * std::sqrt(1 - speed_keep_ * speed_keep_);
  noise_.setZero();
}

Wrench EstimatedHand::Step(const FrameMotion& handle) noexcept {
  if (!holds_) return Wrench::Zero();
  time_ += dt_;
  const double axis = 1 / std::sqrt(3.0);  // component of a vector of length 1
  for (double& x : noise_) x = keep_ * x + kick_ * axis * draw_.noise.Normal();
  for (double& x : speed_) x = speed_keep_ * x + speed_kick_ * draw_.noise.Normal();
  rest_ *= keep_;
  moved_ += dt_ * speed_;
  const double lasted = persistence_ * (1 - std::exp(-time_ / persistence_));
  const double left = time_ < draw_.end ? 1 : std::exp((draw_.end - time_) / end_time_);
  Wrench F = baseline_ + left * (drive_ + lasted * trend_ - baseline_) + rest_ -
             Resist(handle.X_W, handle.V_W, force_);
  F.head<3>() += force_ * noise_.head<3>();
  F.tail<3>() += torque_ * noise_.tail<3>();
  F.head<3>() += (1 + draw_.arm.reflex_gain) * draw_.arm.stiffness.cwiseProduct(moved_) -
                 draw_.arm.mass * handle.A_W.head<3>();
  force_ = F.head<3>().norm();
  torque_ = F.tail<3>().norm();
  return F;
}

void EstimatedOperator::Begin(std::span<const TickRecord> past, double record_step,
                              const IntentModel& intent, const OperatorDraw& draw) {
  for (std::size_t i = 0; i < kHands; ++i)
    hands_[i].Begin(past, i, record_step, step_, intent, draw);
  mass_ = draw.arm.mass;
  estimated_ = true;
}

void EstimatedOperator::Step(const OperatorInput& input, OperatorOutput* output) noexcept {
  step_ = input.dt;
  if (!estimated_) {
    if (recorded_) recorded_->Step(input, output);
    return;
  }
  *output = OperatorOutput();
  for (const int hand : input.present) {
    const auto i = static_cast<std::size_t>(hand);
    if (!input.running || !hands_[i].holds()) continue;
    output->F_H_W[i] = hands_[i].Step(input.handle[i]);
    output->grip[i] = 1;
    output->hand_mass[i] = mass_;
  }
}

void EstimatedOperator::Reset() noexcept {
  if (recorded_) recorded_->Reset();
}

void EstimatedOperator::Archive(StateArchive& a) noexcept {
  if (recorded_) recorded_->Archive(a);
}

}  // namespace predictor
