// What people and pages may put into a run: fixed in size, typed, bounded.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace predictor {

enum class InputKind : std::uint8_t {
  kNone,
  kStop,       // anybody
  kAlign,      // whoever controls the run
  kStart,      // "
  kReset,      // "
  kParameter,  // ": `parameter`, `value`
  kHand,       // whoever is the operator: `hand`, `grip`, `p`, `q`
  kLatency,    // any page, for the record: `p`
  kScenario,   // whoever controls the run, in IDLE: `value`, a place in the run's list
  kHeadset,    // the run itself: a headset has been silent for `value` [s], which is too long
  kMarker,     // anybody, for the record: something worth finding again happens now
  kPlay,       // replay only: `value` times as fast as it was, 0 pauses
  kSeek,       // replay only: to `value` [s] since the recording's first tick
  kStep,       // replay only: `value` ticks on, or back
  kEnable,     // a person at the rig, real arms: `value` 1 while the enabling key is held, 0 let go
};
inline constexpr int kInputKinds = 15;

// What may be changed while running. Stiffness and damping are factors of the scenario's values,
// thresholds are in their own unit.
enum class Parameter : std::uint8_t {
  kStiffnessTranslation,  // factor
  kStiffnessRotation,     // factor
  kDampingRatio,          // factor
  kForceThreshold,        // [N]
  kTorqueThreshold,       // [N·m]
};
inline constexpr int kParameters = 5;
// "stiffness_translation", "stiffness_rotation", "damping_ratio", "force", "torque"
const char* Name(Parameter parameter);

struct RunInput {
  InputKind kind = InputKind::kNone;
  Parameter parameter = Parameter::kStiffnessTranslation;
  std::uint8_t hand = 0;     // 0 left, 1 right
  std::uint8_t grip = 0;     // the hand is closed
  std::uint32_t client = 0;  // who sent it, as the viewer numbers them
  double value = 0;
  // Where the hand is, in W [m]. Of a latency [ms]: the server's clock minus the page's; from a
  // tick's start to its reception; and to the screen.
  std::array<double, 3> p = {};
  std::array<double, 4> q = {1, 0, 0, 0};  // its orientation, scalar first
};
static_assert(std::is_trivially_copyable_v<RunInput>);

// From one writer to one reader, in shared memory if need be. Neither waits; when it is full the
// newest is refused, and whoever reads takes no word of it on trust.
class InputQueue {
 public:
  static constexpr std::uint32_t kCapacity = 256;

  // Writer. False if the queue is full.
  bool Push(const RunInput& input) noexcept {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) >= kCapacity) return false;
    slots_[head % kCapacity] = input;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  // Reader. False if there is nothing. What a dead or hostile writer left behind cannot make it
  // run longer than the capacity: an impossible count empties the queue.
  bool Pop(RunInput* input) noexcept {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    const std::uint32_t waiting = head_.load(std::memory_order_acquire) - tail;
    if (waiting == 0) return false;
    if (waiting > kCapacity) {
      tail_.store(tail + waiting, std::memory_order_release);
      return false;
    }
    *input = slots_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::atomic<std::uint32_t> head_{0}, tail_{0};
  std::array<RunInput, kCapacity> slots_;
};

}  // namespace predictor
