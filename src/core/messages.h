// What the modules pass to one another within a tick. Plain structs; who writes each is said.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/status.h"
#include "core/types.h"

namespace predictor {

// What became of the packets of a link, since it was made.
struct LinkCounts {
  std::uint64_t taken = 0;
  std::uint64_t lost = 0;     // that never came, or too late to be of use
  std::uint64_t refused = 0;  // of a wrong size, unreadable, or somebody else's
};

// One arm and its force/torque sensor as read from the device. Written by devices.
struct ArmSample {
  bool present = false;
  JointVector q;                      // joint positions [rad]
  JointVector v;                      // joint velocities [rad/s]
  Wrench F_S_raw = Wrench::Zero();    // reading: wrench that the handle exerts on the sensor,
                                      // about S, axes of S; bias, weight and inertia in it
  std::uint64_t arm_sequence = 0;     // counts the arm's samples
  std::uint64_t sensor_sequence = 0;  // counts the sensor's samples
  double arm_age = 0;                 // of q and v [s]
  double sensor_age = 0;              // of the wrench [s]
  bool sensor_saturated = false;      // the sensor says that its range is exceeded
  bool fault = false;                 // the arm reports a fault or is not powered
  bool in_motion = false;             // its driver has it move still, whatever it was told
  bool waits = false;                 // it does not obey yet: its controller has not begun to
  bool no_power_off = false, keeps_power = false;  // as the warnings of these names
  LinkCounts arm_link, sensor_link;
};

struct DeviceSample {
  std::array<ArmSample, kHands> arms;
};

// What a page says that a person's hand does. Written by the emulator, for a simulated rig only.
struct HandInput {
  bool grip = false;
  Pose X_WH;         // where the hand wants its handle
  double age = 1e9;  // since the page said so [s]
};

// Written by safety's guard, the last before the wire.
struct DeviceCommand {
  RunState state = RunState::kInit;     // what a person would see on the page
  double run_time = 0;                  // time since RUN began [s]; stands still when stopped
  std::array<JointVector, kHands> v;    // joint velocities [rad/s]
  std::array<HandInput, kHands> hands;  // simulated rig: what its person does, if a page says so
};

// Motion of one frame in the world. Written by whoever computes kinematics.
struct FrameMotion {
  Pose X_W;                       // pose in W
  Twist V_W = Twist::Zero();      // twist in W, about the frame's origin
  Vector6 A_W = Vector6::Zero();  // its time derivative (classical acceleration, not spatial)
};

// Wrench of one hand, out of the raw reading. Written by sensing.
struct HandWrench {
  bool present = false;
  Wrench F_H_W = Wrench::Zero();  // exerted by the hand on the handle, about H, axes of W
};

// What drives one step of the simulation. Written by the emulator.
struct WorldInput {
  std::array<bool, kHands> present = {};                                // which handles exist
  std::array<Wrench, kHands> F_H_W = {Wrench::Zero(), Wrench::Zero()};  // of the hands
  bool coupled = false;                       // real handles exist and may lag behind
  std::array<FrameMotion, kHands> handle;     // real handles H (A_W unused)
  std::array<double, kHands> hand_mass = {};  // direct mode: mass of the hand on D [kg]
};

// What may be changed of the virtual cobot's controller while running: factors of the scenario's
// values. Written by the emulator.
struct ControllerTuning {
  double stiffness_translation = 1;
  double stiffness_rotation = 1;
  double damping_ratio = 1;
  bool operator==(const ControllerTuning&) const = default;
};

// The virtual world after a step. Written by simulation.
struct WorldState {
  double time = 0;  // simulated time [s]
  int cobot_dof = 0;
  JointVector q, v;                        // of the virtual cobot [rad], [rad/s]
  JointVector torque;                      // commanded by its controller [N·m]
  std::array<FrameMotion, kHands> handle;  // virtual handles D
  FrameMotion object;                      // object frame O
  FrameMotion end_effector;                // cobot's end-effector E
  std::array<Wrench, kHands> coupling = {Wrench::Zero(), Wrench::Zero()};  // on D, about D, in W
  double energy = 0;  // kinetic + potential, set-point spring in [J]
};

// What haptic rendering asks of the arms, and how well it could. Written by haptics.
struct RenderResult {
  std::array<JointVector, kHands> v;         // joint velocities [rad/s]
  Vector6 relative_slack = Vector6::Zero();  // by which the rigid constraint gave [m/s, rad/s]
  double elbow_slack = 0;                    // by which the worst row of a limit gave [m/s]
  double elbow_distance = HUGE_VAL;          // nearest link pair [m]; +inf without pairs
  bool relaxed = false;                      // a slack is above its tolerance
  bool failed = false;                       // no verified solution: v slows the last down
  int iterations = 0;                        // of the solver
  // What was active, by a multiplier that is not zero: bit = joint of an arm, or row of the limits.
  std::array<std::uint16_t, kHands> at_lower = {}, at_upper = {};
  std::uint16_t rows = 0;
  double kkt_residual = 0;                         // largest, scaled
  std::array<double, kHands> manipulability = {};  // sqrt(det(J Jᵀ)), translational
};

// Linear model of the virtual world about a state at rest: dx/dt = A x + B u, y = C x. x: positions
// (tangent space), then velocities, so that handles are displaced by C's velocity part times
// positions. u: wrenches on the handles (left, right; 12), y: twists of the handles (12). Absent
// side: zeros.
struct LinearModel {
  Eigen::MatrixXd A, B, C;
};

}  // namespace predictor
