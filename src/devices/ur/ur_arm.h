// An arm of Universal Robots, followed and moved through RTDE (TCP 30004) and a program of ours on
// its controller (ur_script.h). e-Series and later, and CB3. Never run on hardware: only on a fake
// of ours that a client of others drives too.
#pragma once

#include <memory>
#include <string>

#include "devices/arm.h"
#include "devices/standstill.h"
#include "devices/wire/network.h"

namespace predictor {

struct UrOptions {
  std::string host;
  // Only its state is read: no program, nothing sent, whoever moves it (a person in local control,
  // by free-drive). That it cannot move is then told by ArmReading::fault, and is no error.
  bool listen = false;
  double acceleration =
      20;  // in speedj, of the leading joint [rad/s²]: above what the guard allows
  double deceleration = kUrStandstill.deceleration;  // in stopj, of the leading joint [rad/s²]
  // Of those that are used (ur_script.h): 24 … 42, which the RTDE guide leaves to clients from
  // PolyScope 3.9 or 5.3 on; 0 … 18, its fieldbuses', from 3.4 on.
  int first_register = 24;
  std::uint16_t rtde_port = 30004;
  std::uint16_t script_port = 30002;  // 30001 … 30003
  // It is asked whether Remote Control is on, and to cut the power. 0: neither.
  std::uint16_t dashboard_port = 29999;
};

// Connects, sends the program and waits until it runs; the arm stands, and goes on standing until
// something is written. Throws DeviceError: nobody answers, the version or a register is refused,
// the arm cannot move, another program runs, or ours does not start. `network` outlives the arm.
//
// Velocities are sent every 2 ms to a controller of 500 Hz, every 4 ms to one of 125 Hz, which
// takes all that arrive in a cycle and keeps the last (RTDE guide): so it sees a new counter in
// each cycle although its clock is not ours. If none comes, the program on the controller brakes
// within facts().watchdog and ends. After a fault zeros are sent with a counter that stands still,
// so that a program that a person resumes at the pendant ends too.
//
// A sample's age is told by the controller's time-stamp, against the quickest package of late: so
// packages that a network holds back are as old as they are. Sequence counts new time-stamps.
//
// The wrench: ft_raw_wrench, of the sensor that e-Series arms have in their flange, from PolyScope
// 5.9 on; S is the flange. It is the only value that the controller has not taken its idea of the
// payload off: weight and inertia of the handle are in it, as WrenchReading wants (actual_TCP_force
// is compensated, and turned to the base's axes). The guide tells neither its sign nor its axes.
// Taken here: that the tool exerts on the flange, axes of the flange, as follows from what
// Universal Robots' forum says of the external sensor that takes its place (a payload that hangs
// on it shows its weight downwards). The push-test at arming refuses it if that is wrong. A CB3
// has no sensor, only an estimate by motor currents, which is not offered: facts().own_wrench.
std::unique_ptr<Arm> ConnectUr(const UrOptions& options, Network* network);

}  // namespace predictor
