// The parts of the Franka Control Interface that all its versions share, independent of their
// packet layouts.
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

// Returns the number of a command in `version`, or no value if that version does not have the
// command.
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

// Describes the robot's reaction, such as "stopped by a reflex".
const char* Words(MoveStatus status);
const char* Words(RobotMode mode);

// Returns the name that libfranka gives to an error ("joint_velocity_violation"). `index` is the
// error's index in the list of a state.
const char* ErrorName(int error);
// Returns the list of errors, such as "joint velocity violation, cartesian reflex", or "" without
// errors.
std::string ErrorWords(const Errors& errors);

// The fields of a robot state that this program uses.
struct RobotState {
  std::uint64_t message_id = 0;
  Joints q{}, dq{};               // measured [rad], [rad/s]
  Joints q_d{}, dq_d{}, ddq_d{};  // last commanded or extrapolated values [rad], [rad/s], [rad/s²]
  Wrench F_K_K = Wrench::Zero();  // wrench of the robot on its surroundings, about K, axes of K
  Pose X_FK;                      // pose of the stiffness frame in the flange
  std::optional<Pose> X_OF;       // pose of the flange in the base; empty if it is not reported
  double compensated_mass = 0;    // mass of end-effector and load, which F_K_K excludes [kg]
  Vector3 compensated_center = Vector3::Zero();  // their centre of mass in the flange [m]
  MotionGeneratorMode generator = MotionGeneratorMode::kIdle;
  ControllerMode controller = ControllerMode::kOther;
  RobotMode mode = RobotMode::kOther;
  Errors errors, reflex_reason;
};

// Returns false and leaves `state` unchanged in three cases: no state of this version has this
// size, a joint value is not finite or is outside the possible range, or a mode is unknown. If a
// matrix is not a pose, the wrench is zero. A wrench that is not finite is passed on.
bool Decode(std::uint16_t version, std::span<const std::byte> bytes, RobotState* state) noexcept;

// Returns whether a robot state of this version may have this size.
bool IsStateSize(std::uint16_t version, std::size_t size) noexcept;

// Encodes a joint velocity command. `buffer` stores the returned bytes.
using CommandBuffer = std::array<std::byte, sizeof(Research3Command)>;
std::span<const std::byte> EncodeVelocity(std::uint16_t version, std::uint64_t message_id,
                                          const Joints& v, bool finished,
                                          CommandBuffer* buffer) noexcept;

// These functions encode requests with their header. `buffer` stores the returned bytes.
using RequestBuffer = std::array<std::byte, sizeof(Header) + sizeof(CollisionRequest)>;
std::span<const std::byte> EncodeConnect(std::uint16_t version, std::uint32_t id,
                                         std::uint16_t udp_port, RequestBuffer* buffer) noexcept;
// Requests joint velocities with joint impedance.
std::span<const std::byte> EncodeMove(std::uint16_t version, std::uint32_t id,
                                      RequestBuffer* buffer) noexcept;
// Sets the same thresholds for contact and collision, with and without acceleration.
std::span<const std::byte> EncodeCollision(std::uint16_t version, std::uint32_t id,
                                           const Joints& torque, const Wrench& force,
                                           RequestBuffer* buffer) noexcept;

// An answer's header and the beginning of its body.
struct Answer {
  Header header{};
  std::array<std::byte, 3> body{};  // the unused rest is zero

  std::uint8_t status() const { return static_cast<std::uint8_t>(body[0]); }
};

// Assembles answers from the pieces of a stream, which may be split anywhere.
class AnswerReader {
 public:
  // Returns the buffer space for the next piece.
  std::span<std::byte> room() noexcept;
  // Reports that `size` bytes were written to the buffer space.
  void Arrived(std::size_t size) noexcept { used_ += size; }
  // Returns the next complete answer. Unused data at the end of an answer is skipped.
  bool Next(Answer* answer) noexcept;
  // Returns whether a header was invalid. The data after an invalid header cannot be interpreted.
  bool broken() const noexcept { return broken_; }

 private:
  void Drop(std::size_t bytes) noexcept;

  std::array<std::byte, 512> bytes_{};
  std::size_t used_ = 0;
  std::size_t skip_ = 0;  // remaining bytes of the last answer to be skipped
  bool broken_ = false;
};

}  // namespace predictor::fci
