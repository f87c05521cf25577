// One robot arm, and one force/torque sensor: what a real device is made of. A driver is a class
// that implements one of them, in a folder of its own.
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
  Wrench F_S = Wrench::Zero();  // that the handle exerts on the sensor, about S, axes of S [N, N·m]
  std::uint64_t sequence = 0;   // counts readings; one that is given again has the same
  double age = 1e9;             // since it was measured, as far as known [s]
  bool saturated = false;       // the sensor says that its range is exceeded
  LinkCounts link;
};

// What an arm tells of itself.
struct ArmReading {
  JointVector q;               // [rad]
  JointVector v;               // [rad/s]
  std::uint64_t sequence = 0;  // counts the arm's samples
  double age = 1e9;            // of q and v [s]
  bool fault = false;          // it cannot move: not powered, protective stop, emergency stop, …
  // Its driver has it move still, or it says so itself, since it is led to rest by a way of its
  // own: rest, told now, would not be sent at once. False of one that is sent what it is told.
  bool in_motion = false;
  // It does not obey yet: its controller has not begun the motion that it was asked for, or was not
  // asked. False of one that needs no beginning.
  bool waits = false;
  bool no_power_off = false;  // what it was asked by to cut its power is lost; not: never was
  bool keeps_power = false;   // it says so, a second after PowerOff
  std::uint64_t inputs = 0;   // its digital inputs, a bit each, as the maker counts them
  WrenchReading wrench;       // of its own sensor or estimate, if it has one
  LinkCounts link;
};

// What an arm's controller was told, at its pendant, of all that hangs on its flange.
struct ToldPayload {
  double mass = 0;                           // [kg]
  Vector3 center_of_mass = Vector3::Zero();  // in the flange [m]
};

// Where an arm's controller says that its flange is while its joints are at q.
struct ToldFlange {
  JointVector q;           // [rad]
  Pose X_BF;               // of the flange in the base, axes as the maker has them
  std::string link;        // as the maker's models name the flange: how the link's name ends
  bool tool_known = true;  // false: it tells where its tool is, but not how on the flange: as there
};

// What was found when an arm or a sensor was connected to.
struct DeviceFacts {
  std::string name;         // for a person: make, model, versions, address
  int joints = 0;           // of an arm
  double rate = 0;          // of its samples [Hz]
  bool own_wrench = false;  // an arm: it measures a wrench itself
  double watchdog = 0;      // an arm stops by itself when it hears nothing for so long [s]
  // Of each joint of an arm: what its driver lets through; empty: what it is told [rad/s],
  // [rad/s²].
  std::vector<double> velocity = {}, acceleration = {};
  std::optional<ToldPayload> payload = std::nullopt;  // of an arm that tells it
  std::optional<ToldFlange> flange = std::nullopt;    // of an arm that tells it
  bool payload_taken_off = false;         // that payload's weight is not in its own wrench
  std::vector<std::string> remarks = {};  // what a person should know, a sentence each
};

// Read and Write are called by the tick: they never block, allocate or throw. What is wrong with
// the arm is told once by Status, and from then on until the arm is made anew.
class Arm {
 public:
  virtual ~Arm() = default;
  virtual const DeviceFacts& facts() const = 0;
  // The newest sample. kDevice: the connection is lost, or the arm says that it cannot move; the
  // sample is then the last one, with its age.
  virtual Status Read(ArmReading* reading) noexcept = 0;
  // Joint velocities [rad/s], one each tick; finite and bounded by the guard. `motion`: the state
  // is one in which the arm may move; if not, v is zero and the arm need not be in its motion mode.
  virtual Status Write(const JointVector& v, bool motion) noexcept = 0;
  // Each tick. `wanted`: the run is UNPOWERED. As that begins the robot is asked to cut its power;
  // one that tells whether it has says so by ArmReading::keeps_power. A robot that takes no such
  // request (a Franka) holds its place, powered, until its own enabling device or emergency stop is
  // used.
  virtual void PowerOff(bool wanted) noexcept { static_cast<void>(wanted); }
  // What a person is to be told of the last fault, in words ("protective stop"); "" if nothing. Not
  // from the tick.
  virtual std::string Trouble() const = 0;
};

// As for Arm.
class WrenchSensor {
 public:
  virtual ~WrenchSensor() = default;
  virtual const DeviceFacts& facts() const = 0;
  virtual Status Read(WrenchReading* reading) noexcept = 0;
  virtual std::string Trouble() const = 0;
};

}  // namespace predictor
