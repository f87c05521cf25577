// The parts of a real device: a robot arm and a force/torque sensor. A driver is a class that
// implements one of these interfaces. Each driver has its own folder.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/messages.h"
#include "core/types.h"

namespace predictor {

// A reading of a force/torque sensor.
struct WrenchReading {
  Wrench F_S = Wrench::Zero();  // wrench that the handle exerts on the sensor, about S, axes of S
                                // [N, N·m]
  std::uint64_t sequence = 0;   // counts readings; a repeated reading has the same number
  double age = 1e9;             // time since the measurement, as far as known [s]
  bool saturated = false;       // the sensor reports that its range was exceeded
  LinkCounts link;
};

// The state that an arm reports.
struct ArmReading {
  JointVector q;               // [rad]
  JointVector v;               // [rad/s]
  std::uint64_t sequence = 0;  // counts the arm's samples
  double age = 1e9;            // age of q and v [s]
  bool fault = false;  // the arm cannot move: no power, protective stop, emergency stop, …
  // True if the arm is still coming to rest, because its driver still moves it or because the arm
  // reports motion. In this state, the driver would not send a command to rest immediately. This
  // value is always false for an arm that executes commands directly.
  bool in_motion = false;
  // True if the arm does not execute commands yet, because its controller has not received the
  // request or has not started the requested motion. This value is always false for an arm that
  // needs no request before it moves.
  bool waits = false;
  bool no_power_off = false;  // the channel for power-off requests existed, but is lost
  bool keeps_power = false;   // the arm still reports power one second after PowerOff
  std::uint64_t inputs = 0;   // digital inputs, one bit each, numbered as by the manufacturer
  WrenchReading wrench;       // wrench of the arm's own sensor or estimator, if it has one
  LinkCounts link;
};

// The payload that is configured in an arm's controller. It includes everything that is mounted on
// the flange.
struct ReportedPayload {
  double mass = 0;                           // [kg]
  Vector3 center_of_mass = Vector3::Zero();  // centre of mass in the flange [m]
};

// The flange pose that an arm's controller reports for the joint positions q.
struct ReportedFlange {
  JointVector q;     // [rad]
  Pose X_BF;         // pose of the flange in the base, with the manufacturer's axes
  std::string link;  // the manufacturer's name of the flange, which is the end of the link's name
  bool tool_known = true;  // false: the tool's pose on the flange is unknown, so X_BF is the pose
                           // of the tool
};

// Information about an arm or a sensor, which is collected while the program connects to the
// device.
struct DeviceFacts {
  std::string name;         // name for the user: manufacturer, model, versions, address
  int joints = 0;           // number of joints of an arm
  double rate = 0;          // rate of its samples [Hz]
  bool own_wrench = false;  // an arm that measures a wrench itself
  double watchdog = 0;      // the arm stops by itself after this time without commands [s]
  // The limits of each joint that the driver enforces [rad/s], [rad/s²]. They may be empty.
  std::vector<double> velocity = {}, acceleration = {};
  std::optional<ReportedPayload> payload = std::nullopt;  // set if the arm reports it
  std::optional<ReportedFlange> flange = std::nullopt;    // set if the arm reports it
  bool payload_taken_off = false;  // the payload's weight is excluded from the arm's own wrench
  std::vector<std::string> remarks = {};  // notes for the user, one sentence each
};

// The tick calls Read and Write. These functions never block, allocate or throw. Status reports a
// fault of the arm. The fault remains until the arm object is constructed again.
class Arm {
 public:
  virtual ~Arm() = default;
  virtual const DeviceFacts& facts() const = 0;
  // Reads the newest sample. Returns kDevice if the connection is lost or the arm reports that it
  // cannot move. In this case, the function returns the last sample, with its age.
  virtual Status Read(ArmReading* reading) noexcept = 0;
  // Sends the joint velocities [rad/s]. Call this function once per tick. The guard ensures that
  // the velocities are finite and limited. `motion` states whether the arm may move in this state.
  // If the arm may not move, v is zero, and the arm need not be in its motion mode.
  virtual Status Write(const JointVector& v, bool motion) noexcept = 0;
  // Call this in each tick. `wanted` states whether the run is UNPOWERED. When `wanted` becomes
  // true, the driver requests the robot to switch off its power. If the robot still reports power,
  // ArmReading::keeps_power is set. A robot that has no such request (a Franka) holds its position
  // with power until someone uses its own enabling device or emergency stop.
  virtual void PowerOff(bool wanted) noexcept { static_cast<void>(wanted); }
  // Returns a description of the last fault for the user, such as "protective stop", or "" if there
  // was no fault. It must not be called in a tick.
  virtual std::string Trouble() const = 0;
};

// The same rules apply as for Arm.
class WrenchSensor {
 public:
  virtual ~WrenchSensor() = default;
  virtual const DeviceFacts& facts() const = 0;
  virtual Status Read(WrenchReading* reading) noexcept = 0;
  virtual std::string Trouble() const = 0;
};

}  // namespace predictor
