// A Franka arm (Research 3 or the older Panda), driven through the Franka Control Interface at 1
// kHz. The driver follows the published headers of the interface, and was tested with a fake robot
// that libfranka also drives. The driver has never run on hardware.
//
// The driver commands joint velocities. The arm's own joint impedance controller executes them. The
// commands stay within the published limits of velocity, acceleration, jerk and range
// (rate_limiter.h), because otherwise the arm's reflexes would stop it. The driver never recovers
// from errors. A person must clear them in Desk.
//
// The wrench is estimated from the joint torques, without a sensor at the flange. The estimate has
// a bias of some newtons, which changes with pose and friction. In motion, the estimate is less
// accurate. Near a singular pose, the arm provides no estimate, so the age of the wrench grows. The
// wrench excludes the weight of the end-effector and of the load that are configured in Desk. The
// handle's weight must therefore be entered either in the scenario or in Desk, but not in both. The
// estimate is good enough for experiments, but not for rendering stiff contacts.
#pragma once

#include <memory>
#include <optional>

#include "devices/arm.h"
#include "devices/franka/fci.h"
#include "devices/wire/network.h"

namespace predictor {

// Thresholds above which the arm's own reflex stops it.
struct FrankaCollision {
  std::array<double, fci::kJoints> torque{};  // torque of each joint [N·m]
  Wrench force = Wrench::Zero();              // wrench at the stiffness frame [N], [N·m]
};

struct FrankaOptions {
  std::string host;
  std::uint16_t port = fci::kPort;
  std::optional<std::uint16_t> version;      // interface version; empty: 10, or 5 if 10 is refused
  double limits = 0.95;                      // share of the published limits that is used
  Pose X_FS;                                 // pose of the sensor's frame in the flange
  std::optional<FrankaCollision> collision;  // empty: the arm's own settings
  bool listen = false;  // the arm is only read, and neither configured nor moved
  double timeout = 5;   // maximum wait for each answer while connecting [s]
};

// Numbers of irregularities that are not faults.
struct FrankaCounts {
  std::uint64_t states = 0;         // accepted states
  std::uint64_t missed_states = 0;  // states that never arrived
  std::uint64_t old_states = 0;     // states that were repeated or older than the newest one, and
                                    // dropped
  std::uint64_t malformed = 0;  // states of a wrong size or with impossible numbers, and dropped
  std::uint64_t strangers = 0;  // datagrams from other senders, dropped
  std::uint64_t commands = 0;   // commands sent
  // Number of commands that were sent but not received, according to the arm's reports. If the
  // acceleration is constant, a lost command has no effect.
  std::uint64_t lost_commands = 0;
};

class FrankaArm : public Arm {
 public:
  // Only the thread that reads and writes may call this function.
  virtual FrankaCounts counts() const noexcept = 0;
};

// Throws DeviceError if the connection fails or the arm is not ready to move (brakes, user stop, an
// error). `network` must outlive the arm.
std::unique_ptr<FrankaArm> ConnectFranka(const FrankaOptions& options, Network* network);

}  // namespace predictor
