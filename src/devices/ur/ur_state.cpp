#include "devices/ur/ur_state.h"

#include <algorithm>
#include <cmath>

#include "devices/ur/ur_script.h"

namespace predictor {
namespace {

// Values of robot_mode. The motors have power in the modes from power-on through idle (brakes
// closed) to running. Higher values of the mode mean that the firmware is being updated.
constexpr std::int32_t kPowerOn = 4;
constexpr std::int32_t kRunning = 7;                 // powered, brakes released
constexpr std::uint32_t kFreedriveButton = 1U << 2;  // bit of robot_status_bits
// In safety_status_bits.
constexpr std::uint32_t kProtectiveStopBit = 1U << 2;
constexpr std::uint32_t kSafeguardStopBit = 1U << 4;
constexpr std::uint32_t kEmergencyStopBits = 1U << 5 | 1U << 6 | 1U << 7;
constexpr std::uint32_t kSafetyFaultBits = 1U << 3 | 1U << 8 | 1U << 9;
// This bit is set for each of the stops above, but also for other reasons.
constexpr std::uint32_t kStoppedBySafetyBit = 1U << 10;

constexpr double kWholeSpeed = 0.995;  // setting of the speed slider

// The largest accepted time since the controller's start [s], which is 30 years. With a larger
// value, the age of a packet could not be computed.
constexpr double kMaxTime = 1e9;
constexpr double kMaxAngle = 100;  // limit of an angle, also for an endless joint [rad]
constexpr double kMaxSpeed = 20;   // five times the speed of an arm [rad/s]

bool Within(const UrVector& values, double bound) noexcept {
  return std::all_of(values.begin(), values.end(),
                     [bound](double x) { return std::abs(x) <= bound; });  // false for NaN
}

std::string Register(const char* kind, int number) {
  return std::string(kind) + "_register_" + std::to_string(number);
}

}  // namespace

std::vector<rtde::Field> UrOutputs(int first_register, const UrExtras& extras) {
  std::vector<rtde::Field> fields = {{"timestamp", "DOUBLE"},
                                     {"actual_q", "VECTOR6D"},
                                     {"actual_qd", "VECTOR6D"},
                                     {"robot_mode", "INT32"},
                                     {"robot_status_bits", "UINT32"},
                                     {"safety_status_bits", "UINT32"},
                                     {"runtime_state", "UINT32"},
                                     {"target_speed_fraction", "DOUBLE"},
                                     {"actual_digital_input_bits", "UINT64"},
                                     {"actual_TCP_pose", "VECTOR6D"},
                                     {Register("output_int", first_register), "INT32"},
                                     {Register("output_int", first_register + 1), "INT32"}};
  if (extras.tool_offset) fields.push_back({"tcp_offset", "VECTOR6D"});
  if (extras.wrench) fields.push_back({"ft_raw_wrench", "VECTOR6D"});
  if (extras.payload) fields.push_back({"payload", "DOUBLE"});
  if (extras.payload) fields.push_back({"payload_cog", "VECTOR3D"});
  return fields;
}

std::vector<rtde::Field> UrInputs(int first_register) {
  std::vector<rtde::Field> fields;
  for (int joint = 0; joint < kUrJoints; ++joint)
    fields.push_back({Register("input_double", first_register + joint), "DOUBLE"});
  fields.push_back({Register("input_int", first_register), "INT32"});
  fields.push_back({Register("input_int", first_register + 1), "INT32"});
  return fields;
}

bool Decode(std::span<const std::byte> payload, int recipe, const UrExtras& extras,
            UrState* state) noexcept {
  BigEndianReader reader(payload);
  const int id = reader.Get<std::uint8_t>();
  reader.Get(&state->timestamp);
  for (double& q : state->q) reader.Get(&q);
  for (double& v : state->v) reader.Get(&v);
  reader.Get(&state->robot_mode);
  reader.Get(&state->robot_bits);
  reader.Get(&state->safety_bits);
  reader.Get(&state->runtime);
  reader.Get(&state->slider);
  reader.Get(&state->inputs);
  for (double& x : state->tool) reader.Get(&x);
  reader.Get(&state->echo);
  reader.Get(&state->script);
  if (extras.tool_offset)
    for (double& x : state->tool_offset) reader.Get(&x);
  if (extras.wrench)
    for (double& f : state->wrench) reader.Get(&f);
  if (extras.payload) reader.Get(&state->payload);
  if (extras.payload)
    for (double& x : state->payload_cog) reader.Get(&x);
  return reader.exactly() && id == recipe;
}

const char* Sentence(UrFault fault) {
  switch (fault) {
    case UrFault::kNone:
      return "";
    case UrFault::kClosed:
      return "has closed the connection. Check the robot and its cable, then start again.";
    case UrFault::kMalformed:
      return "sends data that is not RTDE, so the connection was closed. Check which program "
             "answers at this address.";
    case UrFault::kNumbers:
      return "sends impossible joint angles or times. Restart the robot.";
    case UrFault::kEmergencyStop:
      return "is in emergency stop. Find the cause, release the button, power the arm on at the "
             "pendant, then start again.";
    case UrFault::kProtectiveStop:
      return "is in protective stop. Find the cause, enable the robot at the pendant, then start "
             "again.";
    case UrFault::kSafeguardStop:
      return "is in safeguard stop. Close the robot's safeguard, then start again.";
    case UrFault::kSafetyFault:
      return "reports a safety violation or fault. Read the message on the pendant.";
    case UrFault::kUnpowered:
      return "is not powered, or its brakes are not released. Power the arm on and release its "
             "brakes at the pendant.";
    case UrFault::kFreedrive:
      return "is in free-drive. Release the free-drive button.";
    case UrFault::kSpeedSlider:
      return "would move more slowly than commanded. Set the pendant's speed slider to 100 %.";
    case UrFault::kScriptSilent:
      return "received no command from this program for too long and braked by itself. Check that "
             "the computer and the network are fast enough, then start again.";
    case UrFault::kScriptEnded:
      return "no longer runs the program that receives our commands. Someone stopped or paused "
             "this program, or the pendant shows an error.";
    case UrFault::kDeaf:
      return "sends its state but accepts no commands. Restart the robot's controller.";
    case UrFault::kCommand:
      return "was about to receive velocities that are not six finite numbers. This is an error in "
             "this program.";
  }
  return "";
}

UrFault ArmFault(const UrState& state) noexcept {
  if ((state.safety_bits & kEmergencyStopBits) != 0) return UrFault::kEmergencyStop;
  if ((state.safety_bits & kSafetyFaultBits) != 0) return UrFault::kSafetyFault;
  if ((state.safety_bits & kProtectiveStopBit) != 0) return UrFault::kProtectiveStop;
  if ((state.safety_bits & kSafeguardStopBit) != 0) return UrFault::kSafeguardStop;
  if ((state.safety_bits & kStoppedBySafetyBit) != 0) return UrFault::kSafetyFault;
  if (state.robot_mode != kRunning) return UrFault::kUnpowered;
  if ((state.robot_bits & kFreedriveButton) != 0) return UrFault::kFreedrive;
  return UrFault::kNone;
}

bool Powered(const UrState& state) noexcept {
  return state.robot_mode >= kPowerOn && state.robot_mode <= kRunning;
}

bool SlowedDown(const UrState& state) noexcept { return !(state.slider >= kWholeSpeed); }

UrFault RunFault(const UrState& state) noexcept {
  if (const UrFault fault = ArmFault(state); fault != UrFault::kNone) return fault;
  if (state.script == static_cast<std::int32_t>(UrScriptState::kEnded))
    return UrFault::kScriptSilent;
  if (state.runtime != kUrPlaying) return UrFault::kScriptEnded;
  return SlowedDown(state) ? UrFault::kSpeedSlider : UrFault::kNone;
}

bool Plausible(const UrState& state) noexcept {
  return std::abs(state.timestamp) <= kMaxTime && Within(state.q, kMaxAngle) &&
         Within(state.v, kMaxSpeed);
}

}  // namespace predictor
