// The packets of the Franka Control Interface (FCI). In memory, they are little-endian and packed.
//
// Requests and answers use TCP port 1337 of the robot. Each consists of a Header and a body. An
// answer has the command and ID of its request. States and commands use UDP. The robot sends its
// state every millisecond to the port named in Connect, and receives one robot command in answer to
// each state.
//
// Version and size together determine the layout of a state:
//   version  5: Panda, libfranka up to 0.9          2373 bytes, numbers are double
//   version 10: Franka Research 3, early            1233 bytes, numbers are float
//   version 10: the same, system 5.9 and newer      1377 bytes, and accelerometers
// Sources: frankaemika/libfranka-common and frankarobotics/libfranka-common,
// research_interface/robot/{rbk_types,service_types,error}.h; sizes as accepted by libfranka 0.9.2
// and 0.21.3.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace predictor::fci {

static_assert(std::endian::native == std::endian::little,
              "packets are copied as they lie in memory");

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

// Matrices are stored column by column. Frames: O base, F flange, NE and EE nominal and true
// end-effector, K stiffness frame. Wrenches: force [N], torque [N·m].
template <class Real>
struct Signals {
  std::uint64_t message_id;  // milliseconds counted by the robot
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
  Real O_F_ext_hat_K[6], K_F_ext_hat_K[6];  // wrench of the robot on its surroundings, about K
  Real O_dP_EE_d[6], O_ddP_O[3];
  Real elbow_c[2], delbow_c[2], ddelbow_c[2];
  Real O_T_EE_c[16], O_dP_EE_c[6], O_ddP_EE_c[6];
  Real theta[7], dtheta[7];
};
template <class Real>
struct Modes {
  MotionGeneratorMode motion_generator_mode;
  ControllerMode controller_mode;
  std::uint8_t errors[kErrors];         // current errors, by ErrorName
  std::uint8_t reflex_reason[kErrors];  // errors that aborted the last motion
  RobotMode robot_mode;
  Real control_command_success_rate;  // share of the last 100 commands that arrived, 0 to 1
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
  float accelerometers[36];  // above and below each of six joints [m/s²]
  Modes<float> modes;
};

struct PandaCommand {
  std::uint64_t message_id;  // ID of the answered state
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

// The header that precedes every request and answer.
struct Header {
  std::uint32_t command;  // number of the command in this version
  std::uint32_t id;       // chosen by the client for the request
  std::uint32_t size;     // total size, including this header [bytes]
};

struct ConnectRequest {
  std::uint16_t version;
  std::uint16_t udp_port;  // port at which the client receives states
};
struct ConnectResponse {
  std::uint8_t status;    // 0: success, 1: incompatible version
  std::uint16_t version;  // version of the robot
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
