// The bytes of the Franka Control Interface (FCI), as they lie in memory: little-endian, packed.
//
// TCP, the robot's port 1337: requests and answers, each a Header and what belongs to it; an answer
// has its request's command and id. UDP: a robot state each millisecond, to the port that Connect
// named, and one robot command in answer to each.
//
// The interface's version does not tell the layout of a state; its version and size do:
//   version  5: Panda, libfranka up to 0.9          2373 bytes, numbers are double
//   version 10: Franka Research 3, early            1233 bytes, numbers are float
//   version 10: the same, system 5.9 and newer      1377 bytes, and accelerometers
// Sources: frankaemika/libfranka-common and frankarobotics/libfranka-common,
// research_interface/robot/{rbk_types,service_types,error}.h; sizes as libfranka 0.9.2 and 0.21.3
// accept them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace predictor::fci {

static_assert(std::endian::native == std::endian::little, "packets are copied as they lie");

inline constexpr std::uint16_t kPort = 1337;
inline constexpr std::uint16_t kPandaVersion = 5, kResearch3Version = 10;
inline constexpr int kJoints = 7;
inline constexpr int kErrors = 41;

enum class MotionGeneratorMode : std::uint8_t {
  kIdle,
  kJointPosition,
  kJointVelocity,
  kCartesianPosition,
  kCartesianVelocity,
  kNone,
};

enum class ControllerMode : std::uint8_t {
  kJointImpedance,
  kCartesianImpedance,
  kExternalController,
  kOther,
};

enum class RobotMode : std::uint8_t {
  kOther,
  kIdle,
  kMove,
  kGuiding,
  kReflex,
  kUserStopped,
  kAutomaticErrorRecovery,
};

#pragma pack(push, 1)

// Matrices are column by column. Frames: O base, F flange, NE and EE nominal and true end-effector,
// K stiffness frame. Wrenches: force [N], torque [N·m].
template <class Real>
struct Signals {
  std::uint64_t message_id;  // counts milliseconds of the robot
  Real O_T_EE[16], O_T_EE_d[16], F_T_EE[16], EE_T_K[16], F_T_NE[16], NE_T_EE[16];
  Real m_ee, I_ee[9], F_x_Cee[3];  // [kg], [kg·m²], [m]
  Real m_load, I_load[9], F_x_Cload[3];
  Real elbow[2], elbow_d[2];
  Real tau_J[7], tau_J_d[7], dtau_J[7];  // [N·m], [N·m/s]
  Real q[7], q_d[7];                     // measured, desired [rad]
  Real dq[7], dq_d[7];                   // [rad/s]
  Real ddq_d[7];                         // [rad/s²]
  Real joint_contact[7], cartesian_contact[6], joint_collision[7], cartesian_collision[6];
  Real tau_ext_hat_filtered[7];
  Real O_F_ext_hat_K[6], K_F_ext_hat_K[6];  // by the robot on what it touches, about K
  Real O_dP_EE_d[6], O_ddP_O[3];
  Real elbow_c[2], delbow_c[2], ddelbow_c[2];
  Real O_T_EE_c[16], O_dP_EE_c[6], O_ddP_EE_c[6];
  Real theta[7], dtheta[7];
};
template <class Real>
struct Modes {
  MotionGeneratorMode motion_generator_mode;
  ControllerMode controller_mode;
  std::uint8_t errors[kErrors];         // of now, by ErrorName
  std::uint8_t reflex_reason[kErrors];  // what aborted the last motion
  RobotMode robot_mode;
  Real control_command_success_rate;  // of the last 100 commands, 0 to 1
};

struct PandaState {
  Signals<double> signals;
  Modes<double> modes;
};
struct EarlyResearch3State {
  Signals<float> signals;
  Modes<float> modes;
};
struct Research3State {
  Signals<float> signals;
  float accelerometers[36];  // top and bottom of six joints [m/s²]
  Modes<float> modes;
};

struct PandaCommand {
  std::uint64_t message_id;  // of the state that it answers
  double q_c[7];
  double dq_c[7];  // [rad/s]
  double O_T_EE_c[16], O_dP_EE_c[6], elbow_c[2];
  std::uint8_t valid_elbow;
  std::uint8_t motion_generation_finished;
  double tau_J_d[7];
};
struct Research3Command : PandaCommand {
  std::uint8_t torque_command_finished;
};

// Before every request and answer.
struct Header {
  std::uint32_t command;  // its number, as the version counts
  std::uint32_t id;       // of the request, the client's choice
  std::uint32_t size;     // of all, this header included [bytes]
};

struct ConnectRequest {
  std::uint16_t version;
  std::uint16_t udp_port;  // at which the client hears states
};
struct ConnectResponse {
  std::uint8_t status;    // 0 success, 1 incompatible version
  std::uint16_t version;  // the robot's
};

enum class MoveController : std::uint32_t { kJointImpedance, kCartesianImpedance, kExternal };
enum class MoveGenerator : std::uint32_t {
  kJointPosition,
  kJointVelocity,
  kCartesianPosition,
  kCartesianVelocity,
  kNone,
};
struct Deviation {
  double translation, rotation, elbow;  // [m], [rad], [rad]
};
struct PandaMove {
  MoveController controller;
  MoveGenerator generator;
  Deviation path, goal;
};
struct Research3Move : PandaMove {
  std::uint8_t use_async_motion_generator;
  double maximum_velocity[7];
};

struct CollisionRequest {
  double lower_torque_acceleration[7], upper_torque_acceleration[7];  // [N·m]
  double lower_torque_nominal[7], upper_torque_nominal[7];
  double lower_force_acceleration[6], upper_force_acceleration[6];  // [N], [N·m]
  double lower_force_nominal[6], upper_force_nominal[6];
};

#pragma pack(pop)

static_assert(sizeof(PandaState) == 2373);
static_assert(sizeof(EarlyResearch3State) == 1233);
static_assert(sizeof(Research3State) == 1377);
static_assert(sizeof(PandaCommand) == 370);
static_assert(sizeof(Research3Command) == 371);
static_assert(sizeof(Header) == 12);
static_assert(sizeof(ConnectRequest) == 4 && sizeof(ConnectResponse) == 3);
static_assert(sizeof(PandaMove) == 56 && sizeof(Research3Move) == 113);
static_assert(sizeof(CollisionRequest) == 416);

}  // namespace predictor::fci
