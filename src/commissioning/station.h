// One arm with its sensor and handle, for commissioning.
#pragma once

#include <memory>
#include <string>

#include "core/messages.h"
#include "devices/arm.h"
#include "models/robot.h"
#include "scenario/machine.h"

namespace predictor::commissioning {

class Station {
 public:
  static constexpr double kGravity = kStandardGravity;  // [m/s²]
  static constexpr double kOld = 0.2;                   // a sample this old cannot be used [s]

  // `sensor` is null if the arm has a built-in sensor. Throws DeviceError if there is no wrench or
  // if the arm's flange pose differs from the model. Throws InputError if the model is invalid or
  // has a different number of joints.
  Station(int hand, const MachineArm& spec, std::unique_ptr<Arm> arm,
          std::unique_ptr<WrenchSensor> sensor);

  // Call this once per millisecond. The function reads the arm and commands the arm to rest. An arm
  // that a person guides by hand reports that it cannot move. The function accepts this report as
  // long as the arm's samples are new. Throws DeviceError.
  void Watch();
  // Reads an arm that is about to move. The function throws DeviceError for every fault of the arm.
  void Sense() { Read(true); }
  // Sends a command [rad/s]. Call this after Sense. Throws DeviceError if the arm does not accept
  // the command.
  void Move(const JointVector& v);
  // Brings the arm to rest, even if there is another fault. If `motion` is false, the arm also
  // leaves its motion mode. Returns false if the arm does not accept the command or if its samples
  // are old.
  bool Slow(const JointVector& v, bool motion) noexcept;

  int hand() const { return hand_; }
  std::string name() const { return HandName(hand_); }
  const MachineArm& spec() const { return spec_; }
  const DeviceFacts& facts() const { return arm_->facts(); }
  const RobotModel& model() const { return *model_; }

  // Returns the reading of the last Watch or Sense.
  const ArmReading& reading() const { return reading_; }
  const WrenchReading& wrench() const { return wrench_; }
  bool fresh_joints() const { return fresh_joints_; }
  bool fresh_wrench() const { return fresh_wrench_; }
  // Returns the sample that the devices of a run would return for an arm at rest.
  ArmSample sample() const;
  Pose EndEffectorPose() const;
  Pose HandlePose() const;
  Vector3 GravityInSensor() const;  // gravity in axes of S [m/s²]
  // Returns the speed of the handle divided by the speed of a joint [m].
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

}  // namespace predictor::commissioning
