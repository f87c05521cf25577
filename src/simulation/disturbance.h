// The effects of the events that act on the virtual cobot at present.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/messages.h"
#include "core/types.h"

namespace predictor {

// The limits of the attachment's grip on the object.
struct GripLimits {
  double force = HUGE_VAL;   // above it, the object slides [N]; 0 with a torque of 0: open
  double torque = HUGE_VAL;  // above it, the object turns [N·m]
  double reach = HUGE_VAL;   // after sliding this far, the object leaves the grip [m]
  bool operator==(const GripLimits&) const = default;
};

// The last commands of the cobot's program to its gripper. Each time is the time since a command
// was given [s], or infinite if it was never given.
struct GripperCommands {
  double released = HUGE_VAL, grasped = HUGE_VAL;
  // These values belong to the last command to grasp. The first two are the largest permitted
  // distance of the object from the place where the gripper held it at the start [m], [rad]. The
  // third is the time that the cobot takes to compensate its payload [s].
  double distance = 0, angle = 0, load_time = 0;

  bool was_opened() const noexcept { return released < HUGE_VAL; }
  bool is_open() const noexcept { return released < grasped; }
};

// The last commands to the gripper that the cobot carries as its object. Times as above.
struct PickUpCommands {
  double let_go = HUGE_VAL, picked = HUGE_VAL;
  // Of the last command to pick up: which movable object, how far its shapes may be from those of
  // the gripper [m], the limits of the grip, the mass that the cobot then compensates [kg], and how
  // long it takes to do so [s].
  int movable = -1;
  double gap = 0;
  GripLimits grip;
  double mass = 0, load_time = 0;

  bool is_open() const noexcept { return movable < 0 || let_go < picked; }
};

// The default values are those of an undisturbed cobot.
struct Disturbance {
  bool brakes = false;                  // the brakes are closed, and the motors give no torque
  bool powerless = false;               // the motors give no torque
  bool frozen = false;                  // the controller stops, and its last torques act
  bool standby = false;                 // cobot.standby_controller commands
  double delay = 0;                     // of the controller's torques, added to its own [s]
  double payload = 0;                   // overestimated mass of the load [kg]
  double coulomb = 0;                   // overcompensated Coulomb friction [N·m]
  double viscous = 0;                   // overcompensated viscous friction [N·m·s/rad]
  Wrench sensor = Wrench::Zero();       // added to the wrist sensor's reading [N], [N·m]
  Vector6 set_point = Vector6::Zero();  // shift of the set-point in W [m], [rad]
  ControllerTuning gains;               // factors of the controller's values
  GripLimits grip;                      // of the attachment
  GripperCommands gripper;
  PickUpCommands pick_up;
  std::uint64_t obstacles = 0;  // fixtures that are there now: bit = number of the fixture
};

// Returns the fixtures that are absent. `obstacles` are those that events let appear, and `present`
// those of them that should be there now. One that was `absent` before and overlaps what could
// touch it (`touched`) stays absent, because the contact would push the other body away violently.
// Bit: number of the fixture.
constexpr std::uint64_t AbsentFixtures(std::uint64_t obstacles, std::uint64_t present,
                                       std::uint64_t absent, std::uint64_t touched) {
  return obstacles & (~present | (absent & touched));
}

}  // namespace predictor
