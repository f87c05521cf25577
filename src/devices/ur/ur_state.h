// The state that a Universal Robots controller reports in each packet, and the faults that this
// state can show.
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

// The values are those of the RTDE guide.
struct UrState {
  double timestamp = 0;  // time since the controller was started [s]
  UrVector q{}, v{};     // [rad], [rad/s]
  UrVector wrench{};     // ft_raw_wrench [N, N·m]; zero if not available
  std::int32_t robot_mode = 0;
  std::uint32_t robot_bits = 0;   // robot_status_bits
  std::uint32_t safety_bits = 0;  // safety_status_bits
  std::uint32_t runtime = 0;      // runtime_state
  double slider = 1;              // target_speed_fraction: setting of the speed slider
  std::uint64_t inputs = 0;       // actual_digital_input_bits
  std::int32_t echo = 0;          // registers that our program writes (ur_script.h)
  std::int32_t script = 0;
  double payload = 0;                   // configured at the pendant; zero if unknown [kg]
  std::array<double, 3> payload_cog{};  // centre of mass in the flange [m]
  // The position [m] and rotation vector [rad] of the tool in the base, and on the flange. If the
  // pose of the tool on the flange is unknown, it is zero.
  UrVector tool{}, tool_offset{};
};

// Fields that not every controller provides.
struct UrExtras {
  bool wrench = false;       // ft_raw_wrench
  bool payload = false;      // payload, payload_cog
  bool tool_offset = false;  // tcp_offset
};

// Returns the names of the fields to request, in the order in which they arrive.
std::vector<rtde::Field> UrOutputs(int first_register, const UrExtras& extras);
// Returns the names of the fields that are sent: six velocities, the counter, and the command
// (ur_script.h).
std::vector<rtde::Field> UrInputs(int first_register);

// Decodes the payload of a data packet. Returns false if the size or the recipe is different.
bool Decode(std::span<const std::byte> payload, int recipe, const UrExtras& extras,
            UrState* state) noexcept;

enum class UrFault : std::uint8_t {
  kNone,
  kClosed,          // the connection is closed
  kMalformed,       // bytes that are not RTDE
  kNumbers,         // values that are not finite or impossible for any arm
  kEmergencyStop,   // red button of the robot or of its surroundings
  kProtectiveStop,  //
  kSafeguardStop,   // a safeguard input of the robot: door, light curtain
  kSafetyFault,     // violation, fault, recovery mode
  kUnpowered,       // power off, or brakes not released
  kFreedrive,       // the free-drive button is pressed
  kSpeedSlider,     // the speed slider is below 100 %: the arm is slower than commanded
  kScriptSilent,    // our program ended because it received no data from us
  kScriptEnded,     // our program was stopped or paused by someone else
  kDeaf,            // our program runs but does not receive our commands
  kCommand,         // the velocities to be sent are not six finite numbers
};

// Describes the fault and the remedy for the user, or returns "" for kNone.
const char* Sentence(UrFault fault);

// Returns whether the arm must not hold its position with power, because its state is unknown.
constexpr bool EndsWithoutPower(UrFault fault) noexcept {
  return fault == UrFault::kClosed || fault == UrFault::kMalformed || fault == UrFault::kDeaf ||
         fault == UrFault::kEmergencyStop || fault == UrFault::kSafetyFault;
}

// Returns the fault that prevents the arm from moving with any program, or kNone if there is no
// fault.
UrFault ArmFault(const UrState& state) noexcept;
// Returns the fault that prevents the arm from moving at a time when our program should run at full
// speed.
UrFault RunFault(const UrState& state) noexcept;
// Returns whether the motors have power, whether or not the brakes are released.
bool Powered(const UrState& state) noexcept;
// Returns whether the speed slider is below 100 %.
bool SlowedDown(const UrState& state) noexcept;
// Returns whether all numbers are finite and within the range that is possible for an arm.
bool Plausible(const UrState& state) noexcept;

// runtime_state
inline constexpr std::uint32_t kUrStopped = 1;
inline constexpr std::uint32_t kUrPlaying = 2;

}  // namespace predictor
