// The safety monitor: looks at one tick, once, after haptics, and says what is wrong.
#pragma once

#include <array>
#include <cstdint>

#include "core/messages.h"
#include "safety/oscillation.h"
#include "scenario/scenario.h"

namespace predictor {

// Everything the monitor judges. Written by the emulator.
struct MonitorInput {
  std::array<bool, kHands> present = {};
  const DeviceSample* sample = nullptr;  // null in direct mode
  std::array<HandWrench, kHands> wrench;
  std::array<FrameMotion, kHands> real, virtual_;   // handles H and D
  const WorldState* world = nullptr;
  const RenderResult* render = nullptr;             // null in direct mode
  std::array<JointVector, kHands> lower, upper;     // joint limits of the arms [rad]
  Status device, sensing, simulation, haptics;      // what the stages reported
  bool running = false;    // RUN: thresholds on tracking, coupling and oscillation count
  int missed_deadlines = 0;  // in a row
};

class Monitor {
 public:
  Monitor(const SafetySpec& safety, const RenderingSpec& rendering,
          const std::array<bool, kHands>& sensor_has_noise, double dt);

  // The first thing wrong in this tick, in the order of StopCause; ok if none. No heap, no throw.
  Status Check(const MonitorInput& input) noexcept;
  void Reset() noexcept;

 private:
  SafetySpec safety_;
  double security_distance_;
  std::array<bool, kHands> sensor_has_noise_;
  std::array<OscillationDetector, kHands> oscillation_;
  std::array<Wrench, kHands> last_raw_;
  std::array<std::uint64_t, kHands> last_sequence_ = {};
  std::array<int, kHands> same_ = {};
};

}  // namespace predictor
