#include "commissioning/station.h"

#include <utility>

#include "commissioning/arm_checks.h"
#include "core/error.h"
#include "core/format.h"
#include "devices/wire/network.h"
#include "models/arm_model.h"

namespace predictor::commissioning {

Station::Station(int hand, const MachineArm& spec, std::unique_ptr<Arm> arm,
                 std::unique_ptr<WrenchSensor> sensor)
    : hand_(hand),
      spec_(spec),
      arm_(std::move(arm)),
      sensor_(std::move(sensor)),
      model_(LoadArmModel(spec.arm, spec.arm.base.X_RB(), {}, "arms." + name() + ".arm")),
      end_effector_(model_->Frame(spec.arm.end_effector)),
      handle_(model_->Frame(spec.arm.end_effector, spec.arm.handle.ToPose())),
      data_(*model_),
      rest_(JointVector::Zero(model_->dof())) {
  if (!sensor_ && !facts().own_wrench)
    Fail("it does not measure a wrench at its handle. Add a force/torque sensor to this arm.");
  const std::string key = "arms." + name() + ".arm.model";
  if (facts().joints != model_->dof())
    throw InputError::At(
        key, Formatted("%s has %d joints, but %s has %d. Give the model of this arm.", key.c_str(),
                       model_->dof(), facts().name.c_str(), facts().joints));
  if (const std::string refusal = KinematicsRefusal(facts(), spec.arm, *model_); !refusal.empty())
    Fail(refusal);
}

void Station::Fail(const std::string& trouble) const {
  throw DeviceError("The " + name() + " arm, " + facts().name + ": " + trouble);
}

void Station::Read(bool strict) {
  const std::uint64_t joints = reading_.sequence, readings = wrench_.sequence;
  Status status = arm_->Read(&reading_);
  if (sensor_) {
    const Status sensed = sensor_->Read(&wrench_);
    if (!sensed.ok()) throw DeviceError(sensor_->facts().name + ": " + sensor_->Trouble());
  } else {
    wrench_ = reading_.wrench;
  }
  if (strict && !status.ok()) Fail(arm_->Trouble());
  if (!(reading_.age <= kOld && wrench_.age <= kOld)) {
    const std::string trouble = arm_->Trouble();
    Fail(trouble.empty() ? "it has stopped sending its state." : trouble);
  }
  if (reading_.q.size() != model_->dof() || !reading_.q.allFinite() || !wrench_.F_S.allFinite())
    Fail("it sends invalid numbers.");
  fresh_joints_ = reading_.sequence != joints;
  fresh_wrench_ = wrench_.sequence != readings;
  if (fresh_joints_) data_.UpdateKinematics(*model_, reading_.q, rest_);
}

void Station::Watch() {
  Read(false);
  static_cast<void>(arm_->Write(rest_, false));
}

void Station::Move(const JointVector& v) {
  if (!arm_->Write(v, true).ok()) Fail(arm_->Trouble());
}

bool Station::Slow(const JointVector& v, bool motion) noexcept {
  const Status status = arm_->Read(&reading_);
  return arm_->Write(v, motion).ok() && status.ok() && reading_.age <= kOld;
}

ArmSample Station::sample() const {
  ArmSample sample;
  sample.present = true;
  sample.q = reading_.q;
  sample.v = rest_;
  sample.F_S_raw = wrench_.F_S;
  sample.arm_sequence = reading_.sequence;
  sample.sensor_sequence = wrench_.sequence;
  sample.arm_age = reading_.age;
  sample.sensor_age = wrench_.age;
  sample.sensor_saturated = wrench_.saturated;
  sample.fault = reading_.fault;
  return sample;
}

Pose Station::EndEffectorPose() const { return data_.FramePose(*model_, end_effector_); }

Pose Station::HandlePose() const { return data_.FramePose(*model_, handle_); }

Vector3 Station::GravityInSensor() const {
  const Quaternion q_WS = EndEffectorPose().q * spec_.arm.sensor.pose.ToPose().q;
  return q_WS.conjugate() * Vector3(0, 0, -kGravity);
}

double Station::Lever(int joint) const {
  Jacobian J;
  J.setZero(6, model_->dof());
  data_.FrameJacobian(*model_, handle_, &J);
  return J.col(joint).head<3>().norm();
}

}  // namespace predictor::commissioning
