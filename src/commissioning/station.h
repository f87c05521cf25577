// One arm with its sensor and handle as commissioning uses it.
#pragma once

#include <memory>
#include <string>

#include "core/messages.h"
#include "devices/arm.h"
#include "models/robot.h"
#include "scenario/machine.h"

namespace predictor {

class Station {
 public:
  static constexpr double kGravity = kStandardGravity;  // [m/s²]
  static constexpr double kOld = 0.2;                   // a sample this old says nothing [s]

  // sensor: null for the arm's own. Throws DeviceError: there is no wrench, or
  // the arm's flange is elsewhere than by the model; InputError: the model,
  // or it has another number of joints than the arm.
  Station(int hand, const MachineArm& spec, std::unique_ptr<Arm> arm,
          std::unique_ptr<WrenchSensor> sensor);

  // Once a millisecond: reads, and has the arm stand. An arm that a person leads says that it
  // cannot move: that is no matter as long as its samples are young. Throws DeviceError.
  void Watch();
  // Reads an arm that is to move: here every doubt of the arm's is a DeviceError.
  void Sense() { Read(true); }
  // A command [rad/s], after Sense. Throws DeviceError: the arm does not take it.
  void Move(const JointVector& v);
  // Both where it is brought to rest, whatever else is wrong. motion: false lets it leave its
  // motion. False: the arm does not take it, or its samples are old.
  bool Slow(const JointVector& v, bool motion) noexcept;

  int hand() const { return hand_; }
  std::string name() const { return kHandNames[static_cast<std::size_t>(hand_)]; }
  const MachineArm& spec() const { return spec_; }
  const DeviceFacts& facts() const { return arm_->facts(); }
  const RobotModel& model() const { return *model_; }

  // As of the last Watch or Sense.
  const ArmReading& reading() const { return reading_; }
  const WrenchReading& wrench() const { return wrench_; }
  bool fresh_joints() const { return fresh_joints_; }
  bool fresh_wrench() const { return fresh_wrench_; }
  // As a run has it, at rest.
  ArmSample sample() const;
  Pose EndEffectorPose() const;
  Pose HandlePose() const;
  Vector3 GravityInSensor() const;  // gravity in axes of S [m/s²]
  // Speed of the handle by a joint's [m].
  double Lever(int joint) const;

 private:
  void Read(bool strict);
  [[noreturn]] void Fail(const std::string& trouble) const;

  int hand_;
  MachineArm spec_;
  std::unique_ptr<Arm> arm_;
  std::unique_ptr<WrenchSensor> sensor_;
  std::shared_ptr<const RobotModel> model_;
  FrameId end_effector_, handle_;
  RobotData data_;
  JointVector rest_;
  ArmReading reading_;
  WrenchReading wrench_;
  bool fresh_joints_ = false, fresh_wrench_ = false;
};

}  // namespace predictor
