// What a fake controller of Universal Robots holds: registers, modes, motion.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/types.h"
#include "devices/ur/ur_state.h"

namespace predictor {

// Denavit and Hartenberg's parameters as Universal Robots publishes them; α is 90, 0, 0, 90, −90,
// 0° [m].
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
// Of the flange in the base.
Pose FlangeOf(const UrGeometry& arm, const UrVector& q);

struct UrController {
  static constexpr std::size_t kRegisters = 48;

  // Numbers of the RTDE guide.
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
  double time = 0;       // since it was started [s]
  std::array<double, kRegisters> input_double{}, output_double{};
  std::array<std::int32_t, kRegisters> input_int{}, output_int{};
  std::int32_t robot_mode = kRunning;
  std::uint32_t safety_bits = kNormal;
  Runtime runtime = kStoppedProgram;
  bool freedrive = false;
  double slider = 1;         // of the speed
  std::uint64_t inputs = 0;  // digital ones, a bit each
  // As the pendant was told; none: a controller that does not tell [kg], [m].
  std::optional<double> payload;
  std::array<double, 3> payload_cog{};
  UrVector q{}, v{}, wrench{};  // as measured
  UrGeometry geometry = kUr5;
  UrVector tool_offset{};  // of the tool on the flange: position [m], rotation vector [rad]
  UrVector tool() const;   // the same of the tool in the base, as q stands

  // Towards qd by the leading joint's acceleration, all joints in proportion, as URScript's manual
  // says of speedj; and on, until something else is asked for.
  void Speedj(const UrVector& qd, double a) {
    target_ = qd;
    acceleration_ = a;
  }
  void Stopj(double a) { Speedj({}, a); }
  bool Standing() const { return set_point_ == UrVector{}; }
  // One cycle.
  void Advance();
  const UrVector& set_point() const { return set_point_; }  // [rad/s]

 private:
  UrVector target_{}, set_point_{};
  double acceleration_ = 1;
};

// What the controller runs. Others than URScript are recognised, and played natively.
class UrProgram {
 public:
  virtual ~UrProgram() = default;
  virtual const std::string& name() const = 0;
  // One cycle. False: ended. Throws std::runtime_error: an error that stops the program.
  virtual bool Cycle() = 0;
};

}  // namespace predictor
