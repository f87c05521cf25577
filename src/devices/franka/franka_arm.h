// A Franka arm (Research 3, or the older Panda) by the Franka Control Interface, at 1 kHz. Written
// from the interface's published headers and tested against a fake that libfranka drives: never run
// on hardware.
//
// Joint velocities under the arm's own joint impedance controller. What is sent keeps the published
// limits of velocity, acceleration, jerk and range (rate_limiter.h), or the arm's reflexes would
// stop it. Errors are never recovered from here: a person does, in Desk.
//
// Its wrench is an estimate out of the joints' torques, without a sensor at the flange: some
// newtons of bias that change with the pose and with friction, worse in motion, and none near a
// singular pose (its age then grows). The weight of the end-effector and the load that Desk is told
// of is not in it, so the scenario's handle has no weight then, or Desk none. Good enough to try
// things out, not to render stiff contacts.
#pragma once

#include <memory>
#include <optional>

#include "devices/arm.h"
#include "devices/franka/fci.h"
#include "devices/wire/network.h"

namespace predictor {

// Beyond these the arm's own reflex stops it.
struct FrankaCollision {
  std::array<double, fci::kJoints> torque{};  // of each joint [N·m]
  Wrench force = Wrench::Zero();              // at the stiffness frame [N], [N·m]
};

struct FrankaOptions {
  std::string host;
  std::uint16_t port = fci::kPort;
  std::optional<std::uint16_t> version;      // of the interface; none: 10, then 5, as it answers
  double limits = 0.95;                      // part of the published limits that is used
  Pose X_FS;                                 // of the sensor's frame in the flange
  std::optional<FrankaCollision> collision;  // none: as the arm has them
  bool listen = false;                       // nothing is set, and nothing will be moved
  double timeout = 5;                        // for each answer while connecting [s]
};

// What has gone wrong on the way without being a fault.
struct FrankaCounts {
  std::uint64_t states = 0;         // taken
  std::uint64_t missed_states = 0;  // that never came
  std::uint64_t old_states = 0;     // come again, or behind a newer one: dropped
  std::uint64_t malformed = 0;      // of a wrong size, or with impossible numbers: dropped
  std::uint64_t strangers = 0;      // datagrams of others, dropped
  std::uint64_t commands = 0;       // sent
  // Sent, but the arm says that it went on without; at a constant acceleration that is the same.
  std::uint64_t lost_commands = 0;
};

class FrankaArm : public Arm {
 public:
  // Of the thread that reads and writes.
  virtual FrankaCounts counts() const noexcept = 0;
};

// Throws DeviceError, also if the arm is not ready to move (brakes, user stop, an error). `network`
// outlives the arm.
std::unique_ptr<FrankaArm> ConnectFranka(const FrankaOptions& options, Network* network);

}  // namespace predictor
