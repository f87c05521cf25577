#include "rig/simulated_arm.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "rig/rig.h"
#include "scenario/located.h"

namespace predictor {
namespace {

std::string Use(int hand, const char* what) {
  return std::string("rig.") + HandName(hand) + "." + what;
}

std::shared_ptr<const RobotModel> LoadArm(const Scenario& scenario, int hand) {
  const ArmSpec& spec = scenario.arm(hand);
  return RobotModel::Load(
      {spec.model, scenario.file.parent_path(), spec.remove_links, scenario.X_WB(hand)});
}

Wrench Bias(const RigSpec& rig) { return Wrench(rig.sensor_bias.data()); }

}  // namespace

SimulatedArm::SimulatedArm(const Scenario& scenario, int hand, const JointVector& start, double dt)
    : spec_(scenario.arm(hand)),
      rig_(scenario.rig),
      gravity_(scenario.environment.gravity),
      dt_(dt),
      X_ES_(spec_.sensor.pose.ToPose()),
      X_EH_(spec_.handle.ToPose()),
      model_(LoadArm(scenario, hand)),
      end_effector_(model_->Frame(spec_.end_effector)),
      data_(*model_),
      q_(start),
      sensor_(spec_.sensor, Bias(rig_), dt, RandomStream(scenario.seed, Use(hand, "sensor"))),
      velocity_noise_(scenario.seed, Use(hand, "velocity")) {
  const int dof = model_->dof();
  if (start.size() != dof) {
    throw InputError(DeviceArmKey(hand), "The simulated rig received " +
                                             std::to_string(start.size()) +
                                             " initial joint angles, but the arm has " +
                                             std::to_string(dof) + " joints.");
  }
  const int limits = static_cast<int>(spec_.acceleration_limit.size());
  if (limits != 1 && limits != dof) {
    throw InputError(DeviceArmKey(hand) + ".acceleration_limit",
                     "There are " + std::to_string(limits) + " limits for " + std::to_string(dof) +
                         " joints. Give one limit for all joints or one limit for each joint.");
  }
  const VelocityLoopSpec loop = rig_.loop.value_or(spec_.loop);
  const double delay = loop.delay + rig_.computation_delay;
  if (delay > VelocityLoop::kMaxDelay || spec_.sensor.delay > ForceSensor::kMaxDelay) {
    throw InputError(
        DeviceArmKey(hand),
        "The simulated rig can delay commands by at most 0.25 s and sensor readings by at most "
        "0.05 s. Reduce the delay of the loop, the computation or the sensor.");
  }
  v_ = a_ = command_ = q_measured_ = v_measured_ = JointVector::Zero(dof);
  acceleration_ = JointVector::Zero(dof);
  for (int j = 0; j < dof; ++j) {
    acceleration_[j] = OneOrEach(spec_.acceleration_limit, j);
    loops_.emplace_back(loop, delay, dt, model_->velocity_limit()[j], acceleration_[j]);
    loops_.back().Reset(start[j]);
  }
  UpdateKinematics();
  Measure();
  sensor_.Reset(SensorWrench(Wrench::Zero()));
}

void SimulatedArm::Command(const JointVector& v) noexcept {
  const bool none = v.size() == 0;
  fault_ = !none && (v.size() != q_.size() || !v.allFinite());
  if (fault_) return;
  since_command_ = 0;
  if (none) {
    command_.setZero();
  } else {
    command_ = v;
  }
}

void SimulatedArm::Move() noexcept {
  since_command_ += dt_;
  const bool silent = since_command_ > Rig::kWatchdog + 1e-9;
  for (int j = 0; j < static_cast<int>(loops_.size()); ++j) {
    if (silent) {
      const double step = acceleration_[j] * dt_;
      command_[j] -= std::clamp(command_[j], -step, step);
    }
    VelocityLoop& loop = loops_[static_cast<std::size_t>(j)];
    loop.Step(command_[j]);
    q_[j] = loop.q();
    v_[j] = loop.v();
    a_[j] = loop.a();
  }
  UpdateKinematics();
  Measure();
}

void SimulatedArm::Measure() noexcept {
  const double quantum = rig_.encoder_resolution;
  for (int j = 0; j < q_.size(); ++j) {
    q_measured_[j] = quantum > 0 ? quantum * std::round(q_[j] / quantum) : q_[j];
    v_measured_[j] = v_[j] + rig_.velocity_noise * velocity_noise_.Normal();
  }
  ++sequence_;
}

void SimulatedArm::UpdateKinematics() noexcept {
  data_.UpdateKinematics(*model_, q_, v_);
  const FrameMotion E = data_.MotionOf(*model_, end_effector_, a_);
  handle_ = MotionOfFixed(E, X_EH_);
  sensor_frame_ = MotionOfFixed(E, X_ES_);
}

Wrench SimulatedArm::SensorWrench(const Wrench& F_H_W) const noexcept {
  const Wrench F_S_W = ShiftWrench(F_H_W, handle_.X_W.p - sensor_frame_.X_W.p);
  const Quaternion to_S = sensor_frame_.X_W.q.conjugate();
  Wrench F_S;
  F_S << to_S * Vector3(F_S_W.head<3>()), to_S * Vector3(F_S_W.tail<3>());
  return F_S + HandleLoad(spec_.payload, sensor_frame_, gravity_);
}

void SimulatedArm::Sense(const Wrench& F_H_W) noexcept { sensor_.Step(SensorWrench(F_H_W)); }

void SimulatedArm::Read(ArmSample* sample) noexcept {
  sample->present = true;
  sample->q = q_measured_;
  sample->v = v_measured_;
  sample->F_S_raw = sensor_.reading();
  sample->arm_sequence = sample->sensor_sequence = sequence_;
  sample->arm_age = sample->sensor_age = 0;
  sample->sensor_saturated = sensor_.saturated();
  sample->fault = fault_;
}

void SimulatedArm::Archive(StateArchive& a) noexcept {
  a(loops_, q_, v_, a_, q_measured_, v_measured_, command_, since_command_, fault_, sensor_,
    velocity_noise_, sequence_);
  if (!a.saves() && a.ok()) UpdateKinematics();
}

}  // namespace predictor
