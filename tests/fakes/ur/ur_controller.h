// The state of a fake controller of Universal Robots: registers, modes and motion.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/types.h"
#include "devices/ur/ur_state.h"

namespace predictor {

// The Denavit-Hartenberg parameters that Universal Robots publishes [m]. The angles α are 90, 0, 0,
// 90, −90 and 0°.
struct UrGeometry {
  const char* model;
  double d1, a2, a3, d4, d5, d6;
};
inline constexpr UrGeometry kUr5 = {"ur5", 0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823};
inline constexpr std::array<UrGeometry, 7> kUrGeometries = {{
    {"ur3", 0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819},
    kUr5,
    {"ur10", 0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922},
    {"ur3e", 0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921},
    {"ur5e", 0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996},
    {"ur10e", 0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655},
    {"ur16e", 0.1807, -0.4784, -0.36, 0.17415, 0.11985, 0.11655},
}};
// Returns the pose of the flange in the base.
Pose FlangeOf(const UrGeometry& arm, const UrVector& q);

struct UrController {
  static constexpr std::size_t kRegisters = 48;

  // The numbers are those of the RTDE guide.
  enum RobotMode : std::int32_t { kPowerOff = 3, kIdle = 5, kRunning = 7 };
  enum SafetyBit : std::uint32_t {
    kNormal = 1U << 0,
    kProtectiveStop = 1U << 2,
    kSafeguardStop = 1U << 4,
    kRobotEmergencyStop = 1U << 6,
    kEmergencyStop = 1U << 7,
    kStopped = 1U << 10
  };
  enum Runtime : std::uint32_t { kStoppedProgram = 1, kPlaying = 2, kPaused = 4 };

  double cycle = 0.002;  // [s]
  double time = 0;       // since its start [s]
  std::array<double, kRegisters> input_double{}, output_double{};
  std::array<std::int32_t, kRegisters> input_int{}, output_int{};
  std::int32_t robot_mode = kRunning;
  std::uint32_t safety_bits = kNormal;
  Runtime runtime = kStoppedProgram;
  bool freedrive = false;
  double slider = 1;         // of the speed slider
  std::uint64_t inputs = 0;  // digital inputs, one bit each
  // The mass [kg] and centre of gravity [m] of the payload, as set at the pendant. If this value is
  // empty, the controller does not report it.
  std::optional<double> payload;
  std::array<double, 3> payload_cog{};
  UrVector q{}, v{}, wrench{};  // measured values
  UrGeometry geometry = kUr5;
  UrVector tool_offset{};  // of the tool in the flange: position [m], rotation vector [rad]
  UrVector tool() const;   // pose of the tool in the base at q, in the same form

  // Accelerates towards qd as URScript's manual describes speedj. The leading joint has
  // acceleration a, and all joints move in proportion. The motion continues until the next command.
  void Speedj(const UrVector& qd, double a) {
    target_ = qd;
    acceleration_ = a;
  }
  void Stopj(double a) { Speedj({}, a); }
  bool Standing() const { return set_point_ == UrVector{}; }
  // Performs one cycle.
  void Advance();
  const UrVector& set_point() const { return set_point_; }  // [rad/s]

 private:
  UrVector target_{}, set_point_{};
  double acceleration_ = 1;
};

// A program on the controller. A program that is not interpreted as URScript is recognised and
// implemented natively.
class UrProgram {
 public:
  virtual ~UrProgram() = default;
  virtual const std::string& name() const = 0;
  // Performs one cycle. Returns false at the end of the program. Throws std::runtime_error for an
  // error that stops the program.
  virtual bool Cycle() = 0;
};

}  // namespace predictor
