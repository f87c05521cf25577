// What the hazards that act at present do to the virtual cobot.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/messages.h"
#include "core/types.h"

namespace predictor {

inline constexpr int kMaxFixtures = 64;  // of a scenario

// What the attachment's grip on the object holds.
struct GripLimits {
  double force = HUGE_VAL;   // beyond it, the object slides [N]; 0 with a torque of 0: open
  double torque = HUGE_VAL;  // beyond it, it turns [N·m]
  double reach = HUGE_VAL;   // if it slid farther, it left the grip for good [m]
  bool operator==(const GripLimits&) const = default;
};

// The default values are those of an undisturbed cobot.
struct Disturbance {
  bool brakes = false;                  // the brakes are closed, and the motors give no torque
  bool powerless = false;               // the motors give no torque
  bool frozen = false;                  // the controller stands still, and its last torques act
  bool standby = false;                 // cobot.standby_controller commands
  double delay = 0;                     // of the controller's torques, added to its own [s]
  double payload = 0;                   // mass that the controller compensates too much [kg]
  double coulomb = 0;                   // friction that it compensates too much [N·m]
  double viscous = 0;                   // " [N·m·s/rad]
  Wrench sensor = Wrench::Zero();       // added to the wrist sensor's reading [N], [N·m]
  Vector6 set_point = Vector6::Zero();  // shift of the set-point in W [m], [rad]
  ControllerTuning gains;               // factors of the controller's values
  GripLimits grip;                      // of the attachment
  std::uint64_t obstacles = 0;          // fixtures that are there now: bit = number of the fixture
};

}  // namespace predictor
