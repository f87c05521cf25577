// Data that the modules pass to one another within a tick. The comment at each struct names the
// module that writes this struct.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/hands.h"
#include "core/status.h"
#include "core/types.h"

namespace predictor {

// Numbers of packets on a link since the link was opened.
struct LinkCounts {
  std::uint64_t taken = 0;
  std::uint64_t lost = 0;     // never arrived, or arrived too late to be used
  std::uint64_t refused = 0;  // of the wrong size, unreadable, or from another sender
};

// The values of one arm and its force/torque sensor, as read from the device. Devices write this
// struct.
struct ArmSample {
  bool present = false;
  JointVector q;                      // joint positions [rad]
  JointVector v;                      // joint velocities [rad/s]
  Wrench F_S_raw = Wrench::Zero();    // reading: wrench that the handle exerts on the sensor, about
                                      // S, axes of S; includes bias, weight and inertia
  std::uint64_t arm_sequence = 0;     // counts the arm's samples
  std::uint64_t sensor_sequence = 0;  // counts the sensor's samples
  double arm_age = 0;                 // of q and v [s]
  double sensor_age = 0;              // of the wrench [s]
  bool sensor_saturated = false;      // the sensor reports that its range was exceeded
  bool fault = false;                 // the arm reports a fault or is not powered
  bool in_motion = false;             // the driver is still ramping the arm down
  bool waits = false;                 // the arm's controller has not started the motion yet
  bool no_power_off = false;          // see Warning::kNoPowerOff
  bool keeps_power = false;           // see Warning::kKeepsPower
  LinkCounts arm_link, sensor_link;
};

struct DeviceSample {
  std::array<ArmSample, kHands> arms;
};

// The state of an operator's hand that a page sends. The emulator writes this struct, only for a
// simulated rig.
struct HandInput {
  bool grip = false;
  Pose X_WH;         // set-point of the handle
  double age = 1e9;  // time since the page sent it [s]
};

// The command to a device. The guard, which is the last stage before the device, writes this
// command.
struct DeviceCommand {
  RunState state = RunState::kInit;     // as shown on the page
  double run_time = 0;                  // time since RUN began [s]; constant while stopped
  std::array<JointVector, kHands> v;    // joint velocities [rad/s]
  std::array<HandInput, kHands> hands;  // simulated rig: the operator's hands, if a page moves them
};

// Motion of a frame in the world. The modules that compute kinematics write this struct.
struct FrameMotion {
  Pose X_W;                       // pose in W
  Twist V_W = Twist::Zero();      // twist in W, about the frame's origin
  Vector6 A_W = Vector6::Zero();  // its time derivative (classical acceleration, not spatial)
};

// Wrench of one hand, estimated from the raw reading. Sensing writes this struct.
struct HandWrench {
  bool present = false;
  Wrench F_H_W = Wrench::Zero();  // exerted by the hand on the handle, about H, axes of W
};

// Inputs of one simulation step. The emulator writes them.
struct WorldInput {
  Hands present;                                                        // which handles exist
  std::array<Wrench, kHands> F_H_W = {Wrench::Zero(), Wrench::Zero()};  // of the hands
  bool coupled = false;                       // real handles exist and may lag behind
  std::array<FrameMotion, kHands> handle;     // real handles H (A_W unused)
  std::array<double, kHands> hand_mass = {};  // direct mode: mass of the hand on D [kg]
};

// Settings of the virtual cobot's controller that can be changed during a run. They are factors by
// which the scenario's values are multiplied. The emulator writes this struct.
struct ControllerTuning {
  double stiffness_translation = 1;
  double stiffness_rotation = 1;
  double damping_ratio = 1;
  bool operator==(const ControllerTuning&) const = default;
};

// Motion of the frame of a movable object in the world.
struct MovableMotion {
  Pose X_W;                   // pose in W
  Twist V_W = Twist::Zero();  // twist in W, about the frame's origin
};

// The movable objects (environment.objects), in the scenario's order.
struct Movables {
  int count = 0;
  std::array<MovableMotion, kMaxMovables> motion;
  int held = -1;  // the one that the carried object holds; −1: none
  AttachmentState grip = AttachmentState::kOpen;  // the state of this grip
};

// The virtual world after a step. The simulation writes this struct.
struct WorldState {
  double time = 0;  // simulated time [s]
  int cobot_dof = 0;
  JointVector q, v;                        // of the virtual cobot [rad], [rad/s]
  JointVector torque;                      // commanded by its controller [N·m]
  std::array<FrameMotion, kHands> handle;  // virtual handles D
  FrameMotion object;                      // object frame O
  FrameMotion end_effector;                // cobot's end-effector E
  std::array<Wrench, kHands> coupling = {Wrench::Zero(), Wrench::Zero()};  // on D, about D, in W
  double energy = 0;  // kinetic + potential, including the set-point spring [J]
  ControllerOutcome controller = ControllerOutcome::kComputed;  // in the last step
  std::uint16_t events = 0;       // active hazards: bit = entry of the scenario's `events`
  std::uint8_t latest_event = 0;  // 1 + number of the hazard that began last; 0: none
  std::uint8_t cobot_stop = 0;    // protective stop of the cobot itself: CobotStop
  AttachmentState attachment = AttachmentState::kHolds;
  Movables movables;
};

// In a replay, the answer of a controller outside the program, taken from the record of the tick.
struct ControllerAnswer {
  JointVector torque;  // torque that was applied [N·m]
  double energy = 0;   // energy of the virtual world [J]
  ControllerOutcome outcome = ControllerOutcome::kComputed;
  Status failure;
};

inline constexpr int kMaxLimits = 8;  // number of limits registered with rendering

// Result of haptic rendering. Haptics writes this struct.
struct RenderResult {
  std::array<JointVector, kHands> v;                   // joint velocities [rad/s]
  Vector6 relative_slack = Vector6::Zero();            // of the relative-pose task [m/s, rad/s]
  double limit_slack = 0;                              // of the most relaxed row of a limit [m/s]
  double link_distance = HUGE_VAL;                     // nearest link pair [m]; +inf without pairs
  std::array<double, kMaxLimits> slack_by_limit = {};  // [m/s]; order and names: RegisteredLimits
  bool relaxed = false;                                // a slack is above its tolerance
  bool failed = false;  // no verified solution: v decelerates from the previous one
  int iterations = 0;   // iterations of the solver
  // Active bounds and rows (nonzero multiplier). Each bit stands for a joint of an arm, or for a
  // row.
  std::array<std::uint16_t, kHands> at_lower = {}, at_upper = {};
  std::uint16_t rows = 0;
  double kkt_residual = 0;                         // largest, scaled
  std::array<double, kHands> manipulability = {};  // sqrt(det(J Jᵀ)), translational
};

// Linear model of the virtual world near a state at rest: dx/dt = A x + B u, y = C x. The state x
// contains positions (tangent space), then velocities, then any states of the wrist sensor, of the
// controller's memory and of the controller's delay. The displacement of the handles is the
// velocity part of C times the positions. The input u contains the 12 components of the wrenches on
// the left and right handles, and the output y contains the 12 components of the handles' twists.
// Entries of an absent side are zero.
struct LinearModel {
  Eigen::MatrixXd A, B, C;
  int dof = 0;  // number of positions, which is also that of velocities
};

}  // namespace predictor
