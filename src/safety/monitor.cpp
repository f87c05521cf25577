#include "safety/monitor.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

bool IsFinite(const FrameMotion& motion) {
  return predictor::IsFinite(motion.X_W) && motion.V_W.allFinite();
}

// Compares the values of one quantity of all hands, and keeps the value that exceeds its limit
// most.
class Worst {
 public:
  Worst(StopCause cause, double limit) : Worst(cause, limit, UsualQuantity(cause)) {}
  Worst(StopCause cause, double limit, Quantity quantity) : worst_{cause, -1, 0, limit, quantity} {}
  void Add(int hand, double value) noexcept { Add(hand, value, worst_.limit); }
  // `limit` is the limit of this hand.
  void Add(int hand, double value, double limit) noexcept {
    if (value <= limit) return;  // false if the value is not a number
    if (found_ && !(value - limit > worst_.value - worst_.limit)) return;
    found_ = true;
    worst_.hand = static_cast<std::int8_t>(hand);
    worst_.value = std::isfinite(value) ? value : 0;
    worst_.limit = limit;
  }
  Status status() const noexcept { return found_ ? worst_ : Status::Ok(); }

 private:
  Status worst_;
  bool found_ = false;
};

Status NotFinite(StopCause cause, int hand) {
  return {cause, static_cast<std::int8_t>(hand), 0, 0, Quantity::kNone};
}

// `age` may be infinite.
Status Silence(std::size_t hand, double age, double longest, Quantity whose) {
  const auto side = static_cast<std::int8_t>(hand);
  if (!std::isfinite(age)) return {StopCause::kStale, side, 0, 0, Quantity::kNone, true};
  return {StopCause::kStale, side, age, longest, whose, true};
}

Status CheckArm(const ArmSample& arm, Eigen::Index joints, int hand) {
  const auto side = static_cast<std::int8_t>(hand);
  if (!arm.present || arm.fault) return {StopCause::kDevice, side, 0, 0};
  if (arm.q.size() != joints || arm.v.size() != joints) {
    return {StopCause::kDevice, side, static_cast<double>(arm.q.size()),
            static_cast<double>(joints), Quantity::kCount};
  }
  return Status::Ok();
}

bool IsReading(const ArmSample& arm) {
  return arm.F_S_raw.allFinite() && arm.q.allFinite() && arm.v.allFinite() &&
         std::isfinite(arm.arm_age) && std::isfinite(arm.sensor_age);
}

}  // namespace

Monitor::Monitor(const SafetySpec& safety, const RenderingSpec& rendering,
                 const std::array<bool, kHands>& sensor_has_noise, double dt,
                 const std::array<SamplePeriods, kHands>& periods, bool detects_runaway)
    : safety_(safety),
      security_distance_(rendering.security_distance),
      sensor_has_noise_(sensor_has_noise),
      periods_(periods),
      oscillation_{OscillationDetector(safety.oscillation, dt),
                   OscillationDetector(safety.oscillation, dt)},
      vibration_{VibrationDetector(dt), VibrationDetector(dt)},
      runaway_{RunawayDetector(safety.handle_speed, dt), RunawayDetector(safety.handle_speed, dt)},
      detects_runaway_(detects_runaway),
      dt_(dt) {}

void Monitor::Reset() noexcept {
  past_ = {};
  joints_ = {};
  least_ = {};
  missed_ = 0;
  was_running_ = false;
}

Status Monitor::Check(const MonitorInput& input) noexcept {
  FollowSensors(input);
  FollowRecovery(input);
  const Status jump = FollowJoints(input);
  jumped_ = !jump.ok();
  const Status runaway = FollowRunaway(input);  // before FollowOscillation updates was_running_
  const Status oscillation = FollowOscillation(input);
  const Status deadlines = FollowDeadlines(input);
  Status status = CheckStages(input);
  if (status.ok()) status = CheckNumbers(input);
  if (status.ok()) status = jump;
  if (status.ok()) status = CheckWrenches(input);
  if (status.ok()) status = CheckAges(input);
  if (status.ok() && input.follows) status = CheckDistances(input);
  if (status.ok() && input.running) status = CheckEmulation(input);
  if (status.ok()) status = oscillation;
  if (status.ok()) status = runaway;
  if (status.ok()) status = deadlines;
  const Status severe = PowerOffFault(input, jump);
  if (status.ok() || severe.ok()) return status;
  if (!input.follows) return severe;
  status.power_off = true;
  return status;
}

// Returns the first fault that requires power-off (S1). The most severe fault determines how a stop
// ends, even if another fault is reported. If the arms do not follow a task, this fault is the
// reported fault.
Status Monitor::PowerOffFault(const MonitorInput& input, const Status& jump) const noexcept {
  if (jump.power_off) return jump;
  for (const Status* stage : {&input.device, &input.sensing, &input.simulation, &input.haptics})
    if (stage->power_off) return *stage;
  if (!input.sample) return Status::Ok();
  for (const int hand : input.present) {
    const ArmSample& sample = input.sample->arms[hand];
    if (sample.sensor_saturated)
      return {StopCause::kSensor, static_cast<std::int8_t>(hand), 0, 0, Quantity::kNone, true};
    const double longest = SilenceOf(periods_[hand].arm);
    if (sample.arm_age >= longest) return Silence(hand, sample.arm_age, longest, Quantity::kArmAge);
    const double longest_reading = SilenceOf(periods_[hand].sensor);
    if (sample.sensor_age >= longest_reading)
      return Silence(hand, sample.sensor_age, longest_reading, Quantity::kSensorAge);
  }
  return Status::Ok();
}

// Only fresh readings count, because a repeated packet contains no information about the sensor.
void Monitor::FollowSensors(const MonitorInput& input) noexcept {
  if (!input.sample) return;
  for (const int hand : input.present) {
    const ArmSample& arm = input.sample->arms[hand];
    SensorPast& past = past_[hand];
    if (!arm.present) continue;
    if (past.same > 0 && arm.sensor_sequence == past.sequence) continue;
    past.same = past.same > 0 && arm.F_S_raw == past.reading ? past.same + 1 : 1;
    past.reading = arm.F_S_raw;
    past.sequence = arm.sensor_sequence;
  }
}

// In RECOVERY, the hand that is being freed may be loaded beyond the usual thresholds. The usual
// thresholds must not prevent the motion that frees the hand. Any load above the smallest load
// since RECOVERY began is caused by the motion.
void Monitor::FollowRecovery(const MonitorInput& input) noexcept {
  for (int hand = 0; hand < kHands; ++hand) {
    Load& least = least_[hand];
    if (!input.recovers) least = {};
    const HandWrench& wrench = input.wrench[hand];
    if (!input.recovers || !input.present.Has(hand) || !wrench.present) continue;
    least.force = std::min(least.force, wrench.F_H_W.head<3>().norm());
    least.torque = std::min(least.torque, wrench.F_H_W.tail<3>().norm());
  }
}

// The function divides by the time between two different samples and not by that between ticks,
// because a repeated sample shows no motion.
Status Monitor::FollowJoints(const MonitorInput& input) noexcept {
  Status worst;
  if (!input.sample) return worst;
  for (int hand = 0; hand < kHands; ++hand) {
    const ArmSample& arm = input.sample->arms[hand];
    JointPast& past = joints_[hand];
    past.age += (1 + std::max(0, input.missed_deadlines)) * dt_;
    if (!input.present.Has(hand) || !arm.present) continue;
    if (past.known && arm.arm_sequence == past.sequence) continue;
    const Eigen::Index joints =
        std::min<Eigen::Index>({arm.q.size(), input.velocity[hand].size(), kMaxArmJoints});
    for (Eigen::Index j = 0; past.known && j < joints; ++j) {
      const double moved = std::abs(arm.q[j] - past.q[static_cast<std::size_t>(j)]);
      const double most = kJumpFactor * input.velocity[hand][j] * past.age + kJumpSlack;
      if (moved <= most || moved - most <= worst.value - worst.limit) continue;
      worst = {
          StopCause::kDevice, static_cast<std::int8_t>(hand), moved, most, Quantity::kAngle, true};
    }
    std::copy_n(arm.q.data(), joints, past.q.begin());
    past.sequence = arm.arm_sequence;
    past.age = 0;
    past.known = true;
  }
  return worst;
}

Status Monitor::FollowDeadlines(const MonitorInput& input) noexcept {
  const int missed = std::max(0, input.missed_deadlines);
  missed_ += missed - missed_ * std::min(1.0, dt_);
  if (missed >= kMissedDeadlines)
    return {StopCause::kDeadline, -1, static_cast<double>(missed),
            static_cast<double>(kMissedDeadlines - 1)};
  const double most = std::max<double>(kMissedDeadlines, kMissedShare / dt_);
  if (missed_ > most) return {StopCause::kDeadline, -1, missed_, most};
  return Status::Ok();
}

Status Monitor::FollowOscillation(const MonitorInput& input) noexcept {
  if (input.running && !was_running_) {
    for (OscillationDetector& detector : oscillation_) detector.Reset();
    for (VibrationDetector& detector : vibration_) detector.Reset();
  }
  was_running_ = input.running;
  Status status;
  if (!input.running || !safety_.oscillation.enabled) return status;
  for (const int hand : input.present) {
    const Vector3 force = input.wrench[hand].F_H_W.head<3>();
    if (!input.wrench[hand].present || !force.allFinite()) continue;
    const VibrationDetector::Finding vibration = vibration_[hand].Update(force);
    if (vibration.amplitude > status.value) {
      status = {StopCause::kOscillation, static_cast<std::int8_t>(hand), vibration.amplitude,
                vibration.limit, Quantity::kVibration};
    }
    const double amplitude = oscillation_[hand].Update(force);
    if (amplitude > status.value) {
      status = {StopCause::kOscillation, static_cast<std::int8_t>(hand), amplitude,
                safety_.oscillation.amplitude};
    }
  }
  return status;
}

Status Monitor::FollowRunaway(const MonitorInput& input) noexcept {
  Status status;
  if (!detects_runaway_) return status;
  for (int hand = 0; hand < kHands; ++hand) {
    RunawayDetector& detector = runaway_[hand];
    if (!was_running_) detector.Reset();
    const Vector3 force = input.wrench[hand].F_H_W.head<3>(), v = input.real[hand].V_W.head<3>();
    const bool known =
        input.present.Has(hand) && input.wrench[hand].present && force.allFinite() && v.allFinite();
    if (!input.sample || !input.running || !known || !detector.Update(force, v) || !status.ok())
      continue;
    status = {StopCause::kRunaway, static_cast<std::int8_t>(hand), detector.speed(),
              detector.threshold()};
  }
  return status;
}

Status Monitor::CheckStages(const MonitorInput& input) const noexcept {
  for (const Status* stage : {&input.device, &input.sensing, &input.simulation, &input.haptics}) {
    // A slack of the relative pose is a tracking fault, which counts only in RUN.
    if (stage->cause == StopCause::kTracking && !input.running) continue;
    if (!stage->ok()) return *stage;
  }
  return Status::Ok();
}

Status Monitor::CheckNumbers(const MonitorInput& input) const noexcept {
  for (const int hand : input.present) {
    const auto i = static_cast<std::size_t>(hand);
    if (input.sample) {
      const ArmSample& arm = input.sample->arms[i];
      const Status status = CheckArm(arm, input.lower[i].size(), hand);
      if (!status.ok()) return status;
      if (arm.sensor_saturated)
        return {StopCause::kSensor, static_cast<std::int8_t>(hand), 0, 0, Quantity::kNone};
      if (!IsReading(arm)) return NotFinite(StopCause::kSensor, hand);
    }
    if (!input.wrench[i].F_H_W.allFinite() || !IsFinite(input.real[i])) {
      return NotFinite(StopCause::kSensor, hand);
    }
    if (!IsFinite(input.virtual_[i]) || (input.world && !input.world->coupling[i].allFinite())) {
      return {StopCause::kPhysics, static_cast<std::int8_t>(hand), 0, 0, Quantity::kNotFinite};
    }
    if (input.render && !input.render->v[i].allFinite()) return NotFinite(StopCause::kQp, hand);
  }
  return Status::Ok();
}

Status Monitor::CheckWrenches(const MonitorInput& input) const noexcept {
  Worst force(StopCause::kForce, safety_.force), torque(StopCause::kTorque, safety_.torque);
  for (const int hand : input.present) {
    const auto i = static_cast<std::size_t>(hand);
    const HandWrench& wrench = input.wrench[i];
    if (!wrench.present) continue;
    const auto limit = [&](double usual, double least) {
      return input.recovers ? std::max(usual, least + kRecoveryRise * usual) : usual;
    };
    force.Add(hand, wrench.F_H_W.head<3>().norm(), limit(safety_.force, least_[i].force));
    torque.Add(hand, wrench.F_H_W.tail<3>().norm(), limit(safety_.torque, least_[i].torque));
  }
  return force.status().ok() ? torque.status() : force.status();
}

// Reports the sample whose age exceeds its limit most.
Status Monitor::CheckAge(const MonitorInput& input) const noexcept {
  Status worst;
  for (const int hand : input.present) {
    const ArmSample& arm = input.sample->arms[hand];
    const double ages[] = {arm.arm_age, arm.sensor_age};
    const double periods[] = {periods_[hand].arm, periods_[hand].sensor};
    const Quantity whose[] = {Quantity::kArmAge, Quantity::kSensorAge};
    for (std::size_t i = 0; i < 2; ++i) {
      // Silence is a fault, whatever age the scenario allows.
      const double limit =
          std::min(std::max(safety_.max_age, kMaxPeriods * periods[i]), SilenceOf(periods[i]));
      if (ages[i] <= limit) continue;
      if (!worst.ok() && ages[i] - limit <= worst.value - worst.limit) continue;
      worst = {StopCause::kStale, static_cast<std::int8_t>(hand), ages[i], limit, whose[i]};
    }
  }
  return worst;
}

Status Monitor::CheckAges(const MonitorInput& input) const noexcept {
  if (!input.sample) return Status::Ok();
  if (const Status age = CheckAge(input); !age.ok()) return age;
  Worst frozen(StopCause::kStale, safety_.frozen_samples - 1, Quantity::kCount);
  for (const int hand : input.present) {
    const auto i = static_cast<std::size_t>(hand);
    if (sensor_has_noise_[i]) frozen.Add(hand, past_[i].same);
  }
  return frozen.status();
}

Status Monitor::CheckDistances(const MonitorInput& input) const noexcept {
  if (input.render && !(input.render->link_distance >= security_distance_ - kLinkDistanceMargin)) {
    const double distance = input.render->link_distance;
    return {StopCause::kLinkDistance, -1, std::isfinite(distance) ? distance : 0,
            security_distance_};
  }
  if (!input.sample) return Status::Ok();
  Status worst;
  double furthest = kJointMargin;
  for (const int hand : input.present) {
    const JointVector& q = input.sample->arms[hand].q;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const double above = q[j] - input.upper[hand][j], below = input.lower[hand][j] - q[j];
      const double beyond = std::max(above, below);
      if (beyond <= furthest) continue;
      furthest = beyond;
      const double limit = above > below ? input.upper[hand][j] : input.lower[hand][j];
      worst = {StopCause::kJoint, static_cast<std::int8_t>(hand), q[j], limit};
    }
  }
  return worst;
}

Status Monitor::CheckEmulation(const MonitorInput& input) const noexcept {
  Worst position(StopCause::kTracking, safety_.tracking);
  Worst rotation(StopCause::kTracking, safety_.tracking_rotation, Quantity::kAngle);
  Worst force(StopCause::kCoupling, safety_.coupling);
  Worst torque(StopCause::kCoupling, safety_.coupling_torque, Quantity::kTorque);
  for (const int hand : input.present) {
    const auto i = static_cast<std::size_t>(hand);
    const Pose &real = input.real[i].X_W, &wanted = input.virtual_[i].X_W;
    position.Add(hand, (real.p - wanted.p).norm());
    rotation.Add(hand, RotationError(wanted.q, real.q).norm());
    if (!input.world) continue;
    force.Add(hand, input.world->coupling[i].head<3>().norm());
    torque.Add(hand, input.world->coupling[i].tail<3>().norm());
  }
  for (const Worst* quantity : {&position, &rotation, &force, &torque}) {
    if (!quantity->status().ok()) return quantity->status();
  }
  return Status::Ok();
}

}  // namespace predictor
