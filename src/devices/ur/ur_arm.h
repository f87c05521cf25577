// A Universal Robots arm that is read and moved through RTDE (TCP 30004) and our program on its
// controller (ur_script.h). The driver supports the e-Series and later, and the CB3. The driver has
// been tested only with our fake controller, which an independent client also drives, and has never
// run on hardware.
#pragma once

#include <memory>
#include <string>

#include "devices/arm.h"
#include "devices/standstill.h"
#include "devices/wire/network.h"

namespace predictor {

struct UrOptions {
  std::string host;
  // Only the arm's state is read. No program runs on the controller, and nothing is sent. A person
  // may move the arm (local control, free-drive). ArmReading::fault then reports that the arm
  // cannot move, which is not an error.
  bool listen = false;
  double acceleration = 20;  // acceleration of speedj [rad/s²]; above the guard's limit
  double deceleration = kUrStandstill.deceleration;  // deceleration of stopj [rad/s²]
  // The first register used (ur_script.h). The RTDE guide reserves registers 24 … 42 for clients
  // (from PolyScope 3.9 or 5.3). Registers 0 … 18 belong to the fieldbuses (from 3.4).
  int first_register = 24;
  std::uint16_t rtde_port = 30004;
  std::uint16_t script_port = 30002;  // 30001 … 30003
  // The port to query Remote Control and for power-off, or 0 if neither is available.
  std::uint16_t dashboard_port = 29999;
};

// Connects, sends the program and waits until it runs. The arm stands still until the first Write.
// Throws DeviceError if there is no answer, if the version or a register is refused, if the arm
// cannot move, if another program runs, or if our program does not start. `network` must outlive
// the arm.
//
// Velocities are sent every 2 ms to a 500 Hz controller and every 4 ms to a 125 Hz controller. The
// controller reads everything that arrives in a cycle and keeps the last value (RTDE guide), so it
// receives a new counter in each cycle although its clock differs from ours. If no counter arrives,
// the program on the controller brakes within facts().watchdog and ends. After a fault, the driver
// sends zeros with a constant counter, so a program that a person resumes at the pendant ends, too.
//
// The age of a sample is computed from the controller's time-stamp, relative to the recent packet
// with the shortest delay. The age therefore includes delays of the network. The sequence number
// counts new time-stamps.
//
// The wrench is ft_raw_wrench of the sensor in the flange of e-Series arms, from PolyScope 5.9; S
// is the flange. This is the only value from which the controller has not subtracted its payload.
// It includes weight and inertia of the handle, as WrenchReading requires (actual_TCP_force is
// compensated and rotated to the base's axes). The guide states neither the sign nor the axes of
// this value. We assume the wrench that the tool exerts on the flange, in the axes of the flange.
// This assumption is based on a statement in Universal Robots' forum about the external sensor that
// replaces the built-in sensor (the weight of a hanging payload points downwards). If the
// assumption is wrong, the push test refuses the arm. A CB3 has no sensor, only an estimate from
// motor currents, which is not used: see facts().own_wrench.
std::unique_ptr<Arm> ConnectUr(const UrOptions& options, Network* network);

}  // namespace predictor
