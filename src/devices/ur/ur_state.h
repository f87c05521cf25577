// What a Universal Robots controller says of its arm in each package, and what may be wrong.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "devices/ur/rtde.h"

namespace predictor {

inline constexpr int kUrJoints = 6;
using UrVector = std::array<double, kUrJoints>;

// Values as the RTDE guide defines them.
struct UrState {
  double timestamp = 0;  // since the controller was started [s]
  UrVector q{}, v{};     // [rad], [rad/s]
  UrVector wrench{};     // ft_raw_wrench [N, N·m]; zero where there is none
  std::int32_t robot_mode = 0;
  std::uint32_t robot_bits = 0;   // robot_status_bits
  std::uint32_t safety_bits = 0;  // safety_status_bits
  std::uint32_t runtime = 0;      // runtime_state
  double slider = 1;              // target_speed_fraction: where the speed slider stands
  std::uint64_t inputs = 0;       // actual_digital_input_bits
  std::int32_t echo = 0;          // registers that our program writes (ur_script.h)
  std::int32_t script = 0;
  double payload = 0;                   // as the pendant was told; zero where it is not known [kg]
  std::array<double, 3> payload_cog{};  // in the flange [m]
  // Position [m] and rotation vector [rad]: of the tool in the base, and on the flange. The latter
  // is zero where it is not known.
  UrVector tool{}, tool_offset{};
};

// What not every controller tells.
struct UrExtras {
  bool wrench = false;       // ft_raw_wrench
  bool payload = false;      // payload, payload_cog
  bool tool_offset = false;  // tcp_offset
};

// What is asked for; in this order it arrives.
std::vector<rtde::Field> UrOutputs(int first_register, const UrExtras& extras);
// What is sent: six velocities, the counter, the command (ur_script.h).
std::vector<rtde::Field> UrInputs(int first_register);

// The payload of a package of data. False: of another size, or of another recipe.
bool Decode(std::span<const std::byte> payload, int recipe, const UrExtras& extras,
            UrState* state) noexcept;

enum class UrFault : std::uint8_t {
  kNone,
  kClosed,          // the connection
  kMalformed,       // bytes that are no RTDE
  kNumbers,         // not finite, or beyond any arm
  kEmergencyStop,   // red button of the robot or of its surroundings
  kProtectiveStop,  //
  kSafeguardStop,   // an input of the robot's: door, light curtain
  kSafetyFault,     // violation, fault, recovery mode
  kUnpowered,       // off, or brakes not released
  kFreedrive,       // its button is pressed
  kSpeedSlider,     // below its end: the arm goes slower than it is told
  kScriptSilent,    // our program ended because it heard nothing of us
  kScriptEnded,     // our program was stopped or paused by someone else
  kDeaf,            // our program does not hear us, though it runs
  kCommand,         // velocities to be sent are not six finite numbers
};

// For a person: what happened, and what to do. "" for kNone.
const char* Sentence(UrFault fault);

// Nobody can say any more what the arm does: it must not be left holding.
constexpr bool EndsWithoutPower(UrFault fault) noexcept {
  return fault == UrFault::kClosed || fault == UrFault::kMalformed || fault == UrFault::kDeaf ||
         fault == UrFault::kEmergencyStop || fault == UrFault::kSafetyFault;
}

// What keeps the arm from moving, whatever program runs. kNone: nothing.
UrFault ArmFault(const UrState& state) noexcept;
// The same, while our program is meant to run, at full speed.
UrFault RunFault(const UrState& state) noexcept;
// Its motors have power, whether its brakes are released or not.
bool Powered(const UrState& state) noexcept;
// The speed slider stands below its end.
bool SlowedDown(const UrState& state) noexcept;
// All numbers are finite and of an arm.
bool Plausible(const UrState& state) noexcept;

// runtime_state
inline constexpr std::uint32_t kUrStopped = 1;
inline constexpr std::uint32_t kUrPlaying = 2;

}  // namespace predictor
