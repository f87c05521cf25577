// A Universal Robots arm. The driver reads and moves the arm through RTDE (TCP 30004) and through
// our program on the arm's controller (ur_script.h). The driver supports the e-Series and later,
// and the CB3. The driver has never run on hardware. It has been tested only with our fake
// controller, which an independent client also drives.
#pragma once

#include <memory>
#include <string>

#include "devices/arm.h"
#include "devices/standstill.h"
#include "devices/wire/network.h"

namespace predictor {

struct UrOptions {
  std::string host;
  // The program only reads the arm's state. No program of ours runs on the controller, and no
  // commands are sent. A person may move the arm (local control, free-drive). ArmReading::fault
  // then reports that the arm cannot move, which is not an error.
  bool listen = false;
  double acceleration = 20;  // acceleration of speedj [rad/s²]; above the guard's limit
  double deceleration = kUrStandstill.deceleration;  // deceleration of stopj [rad/s²]
  // The first register used (ur_script.h). The RTDE guide reserves registers 24 … 42 for clients
  // (from PolyScope 3.9 or 5.3). Registers 0 … 18 belong to the fieldbuses (from PolyScope 3.4).
  int first_register = 24;
  std::uint16_t rtde_port = 30004;
  std::uint16_t script_port = 30002;  // 30001 … 30003
  // The port for querying Remote Control and for requesting power-off, or 0 if neither is
  // available.
  std::uint16_t dashboard_port = 29999;
};

// Connects, sends the program and waits until it runs. The arm stands still until the first Write.
// Throws DeviceError if there is no answer, if the version or a register is refused, if the arm
// cannot move, if another program runs, or if our program does not start. `network` must outlive
// the arm.
//
// The driver sends velocities every 2 ms to a 500 Hz controller and every 4 ms to a 125 Hz
// controller. The controller reads everything that arrives in a cycle and keeps the last value
// (RTDE guide). It therefore receives a new counter in each cycle, although its clock differs from
// the clock of this computer. If no counter arrives, the program on the controller brakes within
// facts().watchdog and ends. After a fault, the driver sends zeros with a constant counter. If a
// person resumes the program at the pendant, the program therefore ends.
//
// The age of a sample is computed from the controller's time-stamp, relative to the recent packet
// with the shortest delay. The age of a sample therefore includes delays of the network. The
// sequence number counts new time-stamps.
//
// On e-Series arms with PolyScope 5.9 or newer, the wrench is ft_raw_wrench, the raw reading of the
// sensor in the flange. The frame S is the flange. This is the only wrench from which the
// controller has not subtracted the payload. The raw reading includes the weight and inertia of the
// handle, as WrenchReading requires. (actual_TCP_force is compensated and rotated to the axes of
// the base.) The guide states neither the sign nor the axes of this value. We assume that the value
// is the wrench that the tool exerts on the flange, in the axes of the flange. This assumption is
// based on a statement in Universal Robots' forum about the external sensor that replaces the
// built-in sensor: the weight of a hanging payload points downwards. If the assumption is wrong,
// the push test refuses the arm. A CB3 has no sensor. It only estimates the wrench from motor
// currents, and this estimate is not used (see facts().own_wrench).
std::unique_ptr<Arm> ConnectUr(const UrOptions& options, Network* network);

}  // namespace predictor
