#include "devices/franka/fci.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

namespace predictor::fci {
namespace {

// The names of the errors, in the order of the bytes in a state's `errors`.
constexpr std::array<const char*, kErrors> kErrorNames = {
    "joint_position_limits_violation",
    "cartesian_position_limits_violation",
    "self_collision_avoidance_violation",
    "joint_velocity_violation",
    "cartesian_velocity_violation",
    "force_control_safety_violation",
    "joint_reflex",
    "cartesian_reflex",
    "max_goal_pose_deviation_violation",
    "max_path_pose_deviation_violation",
    "cartesian_velocity_profile_safety_violation",
    "joint_position_motion_generator_start_pose_invalid",
    "joint_motion_generator_position_limits_violation",
    "joint_motion_generator_velocity_limits_violation",
    "joint_motion_generator_velocity_discontinuity",
    "joint_motion_generator_acceleration_discontinuity",
    "cartesian_position_motion_generator_start_pose_invalid",
    "cartesian_motion_generator_elbow_limit_violation",
    "cartesian_motion_generator_velocity_limits_violation",
    "cartesian_motion_generator_velocity_discontinuity",
    "cartesian_motion_generator_acceleration_discontinuity",
    "cartesian_motion_generator_elbow_sign_inconsistent",
    "cartesian_motion_generator_start_elbow_invalid",
    "force_controller_desired_force_tolerance_violation",
    "start_elbow_sign_inconsistent",
    "communication_constraints_violation",
    "power_limit_violation",
    "cartesian_motion_generator_joint_position_limits_violation",
    "cartesian_motion_generator_joint_velocity_limits_violation",
    "cartesian_motion_generator_joint_velocity_discontinuity",
    "cartesian_motion_generator_joint_acceleration_discontinuity",
    "cartesian_position_motion_generator_invalid_frame_flag",
    "controller_torque_discontinuity",
    "joint_p2p_insufficient_torque_for_planning",
    "tau_J_range_violation",
    "instability_detected",
    "joint_move_in_wrong_direction",
    "cartesian_spline_motion_generator_violation",
    "joint_via_motion_generator_planning_joint_limit_violation",
    "base_acceleration_initialization_timeout",
    "base_acceleration_invalid_reading",
};

// Upper bounds of the values that are possible. The bounds are far beyond the range of these arms'
// joints, which is 5.26 rad/s, 20 rad/s² and two turns.
constexpr double kMaxAngle = 7;           // [rad]
constexpr double kMaxSpeed = 30;          // [rad/s]
constexpr double kMaxAcceleration = 300;  // [rad/s²]
// Tolerance for a rotation matrix that the robot has rounded to floats.
constexpr double kRotationTolerance = 1e-3;

// Copies the joint values. Returns false if a number is not finite or if its magnitude exceeds
// `most`.
template <class Real>
bool TakeJoints(const Real (&from)[kJoints], double most, Joints* to) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i) {
    (*to)[i] = static_cast<double>(from[i]);
    if (!(std::abs((*to)[i]) <= most)) return false;
  }
  return true;
}

template <class Real>
bool TakePose(const Real (&from)[16], Pose* X) noexcept {
  Eigen::Matrix4d T;
  for (int i = 0; i < 16; ++i) T(i % 4, i / 4) = static_cast<double>(from[i]);
  const Matrix3 R = T.topLeftCorner<3, 3>();
  const double error = (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!T.allFinite() || !(error < kRotationTolerance) || !(R.determinant() > 0)) return false;
  *X = {T.topRightCorner<3, 1>(), Quaternion(R).normalized()};
  return true;
}

Errors TakeErrors(const std::uint8_t (&from)[kErrors]) noexcept {
  Errors errors;
  for (std::size_t i = 0; i < kErrors; ++i) errors[i] = from[i] != 0;
  return errors;
}

// The estimated wrench. If there is no estimate, the robot itself reports zero. A wrench that is
// not finite is passed on, so that the code that uses the wrench detects the error immediately.
template <class Real>
void TakeWrench(const Signals<Real>& packet, RobotState* state) noexcept {
  state->F_K_K.setZero();
  Pose X_FE, X_EK;
  if (!TakePose(packet.F_T_EE, &X_FE) || !TakePose(packet.EE_T_K, &X_EK)) return;
  Wrench F;
  for (int i = 0; i < 6; ++i) F[i] = static_cast<double>(packet.K_F_ext_hat_K[i]);
  state->F_K_K = F;
  state->X_FK = X_FE * X_EK;
}

template <class Real>
void TakeFlange(const Signals<Real>& packet, RobotState* state) noexcept {
  Pose X_OE, X_FE;
  state->X_OF.reset();
  if (TakePose(packet.O_T_EE, &X_OE) && TakePose(packet.F_T_EE, &X_FE))
    state->X_OF = X_OE * X_FE.Inverse();
}

// Combines the masses and the centres of mass of end-effector and load.
template <class Real>
void TakePayload(const Signals<Real>& packet, RobotState* state) noexcept {
  state->compensated_mass = 0;
  state->compensated_center.setZero();
  const double ee = static_cast<double>(packet.m_ee), load = static_cast<double>(packet.m_load);
  Vector3 moment;
  for (int i = 0; i < 3; ++i)
    moment[i] = ee * static_cast<double>(packet.F_x_Cee[i]) +
                load * static_cast<double>(packet.F_x_Cload[i]);
  if (!std::isfinite(ee + load) || !moment.allFinite() || !(ee + load > 0)) return;
  state->compensated_mass = ee + load;
  state->compensated_center = moment / (ee + load);
}

template <class Real>
bool TakeSignals(const Signals<Real>& packet, RobotState* state) noexcept {
  state->message_id = packet.message_id;
  if (!TakeJoints(packet.q, kMaxAngle, &state->q) ||
      !TakeJoints(packet.dq, kMaxSpeed, &state->dq) ||
      !TakeJoints(packet.q_d, kMaxAngle, &state->q_d) ||
      !TakeJoints(packet.dq_d, kMaxSpeed, &state->dq_d) ||
      !TakeJoints(packet.ddq_d, kMaxAcceleration, &state->ddq_d))
    return false;
  TakeWrench(packet, state);
  TakePayload(packet, state);
  TakeFlange(packet, state);
  return true;
}

template <class Real>
bool TakeModes(const Modes<Real>& packet, RobotState* state) noexcept {
  state->generator = packet.motion_generator_mode;
  state->controller = packet.controller_mode;
  state->mode = packet.robot_mode;
  state->errors = TakeErrors(packet.errors);
  state->reflex_reason = TakeErrors(packet.reflex_reason);
  return state->generator <= MotionGeneratorMode::kNone &&
         state->controller <= ControllerMode::kOther &&
         state->mode <= RobotMode::kAutomaticErrorRecovery;
}

template <class Packet>
bool Take(std::span<const std::byte> bytes, RobotState* to) noexcept {
  alignas(8) Packet packet;  // aligned for the numbers of its signals
  std::memcpy(&packet, bytes.data(), sizeof packet);
  RobotState state;
  if (!TakeSignals(packet.signals, &state) || !TakeModes(packet.modes, &state)) return false;
  *to = std::move(state);
  return true;
}

// Writes a request's header and body to the buffer.
template <class Body>
std::span<const std::byte> Request(Command command, std::uint16_t version, std::uint32_t id,
                                   const Body& body, RequestBuffer* buffer) noexcept {
  constexpr std::size_t kSize = sizeof(Header) + sizeof(Body);
  static_assert(kSize <= std::tuple_size_v<RequestBuffer>);
  const Header header{Number(command, version).value_or(0), id, kSize};
  std::memcpy(buffer->data(), &header, sizeof header);
  std::memcpy(buffer->data() + sizeof header, &body, sizeof body);
  return std::span<const std::byte>(*buffer).first(kSize);
}

}  // namespace

std::optional<std::uint32_t> Number(Command command, std::uint16_t version) {
  const bool panda = version == kPandaVersion;
  switch (command) {
    case Command::kConnect:
      return 0;
    case Command::kMove:
      return 1;
    case Command::kStopMove:
      return 2;
    case Command::kSetCollisionBehavior:
      return panda ? 4 : 3;
    case Command::kAutomaticErrorRecovery:
      return panda ? 12 : 10;
    case Command::kGetRobotModel:
      if (panda) return std::nullopt;
      return 11;
  }
  return std::nullopt;
}

MoveStatus MoveStatusOf(std::uint8_t byte, std::uint16_t version) noexcept {
  int status = byte;
  // Version 5 of the interface has no safety functions.
  if (version == kPandaVersion && status > static_cast<int>(MoveStatus::kPreempted)) status += 2;
  return static_cast<MoveStatus>(std::min(status, static_cast<int>(MoveStatus::kUnknown)));
}

const char* Words(MoveStatus status) {
  switch (status) {
    case MoveStatus::kSuccess:
      return "has ended the motion";
    case MoveStatus::kMotionStarted:
      return "has started a motion";
    case MoveStatus::kPreempted:
      return "abandoned the motion because of another command";
    case MoveStatus::kPreemptedBySafetyFunction:
      return "abandoned the motion because of a safety function";
    case MoveStatus::kRejectedBySafetyFunction:
      return "refuses to move: a safety function is active";
    case MoveStatus::kNotPossible:
      return "refuses to move in its current mode";
    case MoveStatus::kStartAtSingularPose:
      return "refuses to move: its pose is singular";
    case MoveStatus::kInvalidArgument:
      return "refuses to move: an argument is out of range";
    case MoveStatus::kReflexAborted:
      return "stopped by a reflex";
    case MoveStatus::kEmergencyAborted:
      return "was stopped by the user stop or an emergency stop";
    case MoveStatus::kInputErrorAborted:
      return "stopped because it could not read a command";
    case MoveStatus::kAborted:
      return "aborted the motion";
    case MoveStatus::kUnknown:
      break;
  }
  return "sent an unknown answer";
}

const char* Words(RobotMode mode) {
  switch (mode) {
    case RobotMode::kOther:
      return "is in another mode (brakes closed, or another program moves it)";
    case RobotMode::kIdle:
      return "is ready";
    case RobotMode::kMove:
      return "moves";
    case RobotMode::kGuiding:
      return "is being guided by hand";
    case RobotMode::kReflex:
      return "is stopped by a reflex";
    case RobotMode::kUserStopped:
      return "is stopped by the user stop";
    case RobotMode::kAutomaticErrorRecovery:
      return "is recovering from an error";
  }
  return "is in an unknown mode";
}

const char* ErrorName(int error) { return kErrorNames.at(static_cast<std::size_t>(error)); }

std::string ErrorWords(const Errors& errors) {
  std::string words;
  for (std::size_t i = 0; i < kErrors; ++i) {
    if (!errors[i]) continue;
    if (!words.empty()) words += ", ";
    words += kErrorNames[i];
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

bool IsStateSize(std::uint16_t version, std::size_t size) noexcept {
  if (version == kPandaVersion) return size == sizeof(PandaState);
  return version == kResearch3Version &&
         (size == sizeof(Research3State) || size == sizeof(EarlyResearch3State));
}

bool Decode(std::uint16_t version, std::span<const std::byte> bytes, RobotState* state) noexcept {
  if (!IsStateSize(version, bytes.size())) return false;
  if (bytes.size() == sizeof(PandaState)) return Take<PandaState>(bytes, state);
  if (bytes.size() == sizeof(Research3State)) return Take<Research3State>(bytes, state);
  return Take<EarlyResearch3State>(bytes, state);
}

std::span<const std::byte> EncodeVelocity(std::uint16_t version, std::uint64_t message_id,
                                          const Joints& v, bool finished,
                                          CommandBuffer* buffer) noexcept {
  Research3Command command{};
  command.message_id = message_id;
  for (std::size_t i = 0; i < kJoints; ++i) command.dq_c[i] = v[i];
  command.motion_generation_finished = finished ? 1 : 0;
  std::memcpy(buffer->data(), &command, sizeof command);
  const bool panda = version == kPandaVersion;
  return std::span<const std::byte>(*buffer).first(panda ? sizeof(PandaCommand) : sizeof command);
}

std::span<const std::byte> EncodeConnect(std::uint16_t version, std::uint32_t id,
                                         std::uint16_t udp_port, RequestBuffer* buffer) noexcept {
  return Request(Command::kConnect, version, id, ConnectRequest{version, udp_port}, buffer);
}

std::span<const std::byte> EncodeMove(std::uint16_t version, std::uint32_t id,
                                      RequestBuffer* buffer) noexcept {
  // The deviations matter only in Cartesian motions. The values of the deviations are the same as
  // in libfranka.
  constexpr Deviation kAny{10, 3.12, 2 * std::numbers::pi};
  Research3Move move{};
  move.controller = MoveController::kJointImpedance;
  move.generator = MoveGenerator::kJointVelocity;
  move.path = move.goal = kAny;
  if (version == kPandaVersion)
    return Request(Command::kMove, version, id, static_cast<PandaMove>(move), buffer);
  return Request(Command::kMove, version, id, move, buffer);
}

std::span<const std::byte> EncodeCollision(std::uint16_t version, std::uint32_t id,
                                           const Joints& torque, const Wrench& force,
                                           RequestBuffer* buffer) noexcept {
  CollisionRequest request{};
  for (std::size_t i = 0; i < kJoints; ++i)
    request.lower_torque_acceleration[i] = request.upper_torque_acceleration[i] =
        request.lower_torque_nominal[i] = request.upper_torque_nominal[i] = torque[i];
  for (int i = 0; i < 6; ++i)
    request.lower_force_acceleration[i] = request.upper_force_acceleration[i] =
        request.lower_force_nominal[i] = request.upper_force_nominal[i] = force[i];
  return Request(Command::kSetCollisionBehavior, version, id, request, buffer);
}

std::span<std::byte> AnswerReader::room() noexcept {
  return std::span<std::byte>(bytes_).subspan(used_);
}

void AnswerReader::Drop(std::size_t bytes) noexcept {
  std::memmove(bytes_.data(), bytes_.data() + bytes, used_ - bytes);
  used_ -= bytes;
}

bool AnswerReader::Next(Answer* answer) noexcept {
  // An answer that contains a model is long.
  constexpr std::size_t kMaxSize = 1U << 24;
  const std::size_t skipped = std::min(skip_, used_);
  Drop(skipped);
  skip_ -= skipped;
  if (broken_ || skip_ > 0 || used_ < sizeof(Header)) return false;
  *answer = {};
  std::memcpy(&answer->header, bytes_.data(), sizeof(Header));
  const std::size_t size = answer->header.size;
  if (size <= sizeof(Header) || size > kMaxSize) {
    broken_ = true;
    return false;
  }
  const std::size_t body = std::min(size - sizeof(Header), answer->body.size());
  if (used_ < sizeof(Header) + body) return false;
  std::memcpy(answer->body.data(), bytes_.data() + sizeof(Header), body);
  const std::size_t here = std::min(used_, size);
  skip_ = size - here;
  Drop(here);
  return true;
}

}  // namespace predictor::fci
