// The Franka Control Interface without its layouts: what versions have in common.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/types.h"
#include "devices/franka/packets.h"

namespace predictor::fci {

using Joints = std::array<double, kJoints>;
using Errors = std::bitset<kErrors>;

enum class Command {
  kConnect,
  kMove,
  kStopMove,
  kSetCollisionBehavior,
  kAutomaticErrorRecovery,
  kGetRobotModel,
};

// The number by which `version` knows it; none of a command that it does not have.
std::optional<std::uint32_t> Number(Command command, std::uint16_t version);

enum class MoveStatus {
  kSuccess,
  kMotionStarted,
  kPreempted,
  kPreemptedBySafetyFunction,
  kRejectedBySafetyFunction,
  kNotPossible,
  kStartAtSingularPose,
  kInvalidArgument,
  kReflexAborted,
  kEmergencyAborted,
  kInputErrorAborted,
  kAborted,
  kUnknown,
};

MoveStatus MoveStatusOf(std::uint8_t byte, std::uint16_t version) noexcept;

// "aborted by a reflex", ...: what the robot did.
const char* Words(MoveStatus status);
const char* Words(RobotMode mode);

// Names of what is wrong as libfranka has them ("joint_velocity_violation"), by the place in a
// state's list.
const char* ErrorName(int error);
// "joint velocity violation, cartesian reflex"; "" if none.
std::string ErrorWords(const Errors& errors);

// What is used of a robot state.
struct RobotState {
  std::uint64_t message_id = 0;
  Joints q{}, dq{};               // measured [rad], [rad/s]
  Joints q_d{}, dq_d{}, ddq_d{};  // as last commanded, or extrapolated [rad], [rad/s], [rad/s²]
  Wrench F_K_K = Wrench::Zero();  // by the robot on what it touches, about K, axes of K
  Pose X_FK;                      // of the stiffness frame in the flange
  std::optional<Pose> X_OF;       // of the flange in the base; none: it tells no pose
  double compensated_mass = 0;    // end-effector and load, which F_K_K leaves out [kg]
  Vector3 compensated_center = Vector3::Zero();  // their centre of mass in the flange [m]
  MotionGeneratorMode generator = MotionGeneratorMode::kIdle;
  ControllerMode controller = ControllerMode::kOther;
  RobotMode mode = RobotMode::kOther;
  Errors errors, reflex_reason;
  double success_rate = 0;
};

// False: no state of this version has this size, or a joint's number is not finite or beyond what
// any joint does, or a mode is unknown. `state` is then as it was. A matrix that is not a pose
// gives a wrench of zero; a wrench that is not finite stays so.
bool Decode(std::uint16_t version, std::span<const std::byte> bytes, RobotState* state) noexcept;

// Sizes that states of this version may have.
bool IsStateSize(std::uint16_t version, std::size_t size) noexcept;

// A joint velocity command; `buffer` holds what is returned.
using CommandBuffer = std::array<std::byte, sizeof(Research3Command)>;
std::span<const std::byte> EncodeVelocity(std::uint16_t version, std::uint64_t message_id,
                                          const Joints& v, bool finished,
                                          CommandBuffer* buffer) noexcept;

// Requests, header included; `buffer` holds what is returned.
using RequestBuffer = std::array<std::byte, sizeof(Header) + sizeof(CollisionRequest)>;
std::span<const std::byte> EncodeConnect(std::uint16_t version, std::uint32_t id,
                                         std::uint16_t udp_port, RequestBuffer* buffer) noexcept;
// Joint velocities, joint impedance.
std::span<const std::byte> EncodeMove(std::uint16_t version, std::uint32_t id,
                                      RequestBuffer* buffer) noexcept;
// The same thresholds for contact and collision, with and without acceleration.
std::span<const std::byte> EncodeCollision(std::uint16_t version, std::uint32_t id,
                                           const Joints& torque, const Wrench& force,
                                           RequestBuffer* buffer) noexcept;

// An answer's header and the beginning of what follows.
struct Answer {
  Header header{};
  std::array<std::byte, 3> body{};  // of a shorter one the rest is zero

  std::uint8_t status() const { return static_cast<std::uint8_t>(body[0]); }
};

// Puts answers together out of pieces of a stream, cut anywhere.
class AnswerReader {
 public:
  // Room for the next piece.
  std::span<std::byte> room() noexcept;
  // `size` bytes lie in the room.
  void Arrived(std::size_t size) noexcept { used_ += size; }
  // The next whole answer. An answer's tail that is of no use is passed over.
  bool Next(Answer* answer) noexcept;
  // A header was nonsense: nothing after it can be understood.
  bool broken() const noexcept { return broken_; }

 private:
  void Drop(std::size_t bytes) noexcept;

  std::array<std::byte, 512> bytes_{};
  std::size_t used_ = 0;
  std::size_t skip_ = 0;  // of the last answer's tail, still to come
  bool broken_ = false;
};

}  // namespace predictor::fci
