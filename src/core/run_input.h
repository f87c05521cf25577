// Inputs that people and pages may submit to a run. Every input has a type, a fixed size and
// bounded values.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace predictor {

enum class InputKind : std::uint8_t {
  kNone,
  kStop,  // from anyone; `value` kEndAsPlanned: the run's controller ends a run with simulated arms
  kAlign,      // from the run's controller
  kStart,      // "
  kReset,      // "
  kParameter,  // from the run's controller: `parameter`, `value`
  kHand,       // from the operator: `hand`, `grip`, `p`, `q`
  kLatency,    // from any page, only recorded: `p`
  kScenario,   // from the run's controller, at rest: `value` is an index into the run's list
  kHeadset,    // from the run itself: a headset has been silent for too long, `value` [s]
  kMarker,     // from anyone, only recorded: marks this moment so that it can be found later
  kPlay,       // replay only: `value` is the speed relative to the recording; 0 pauses
  kSeek,       // replay only: moves to `value` [s] after the recording's first tick
  kStep,       // replay only: moves by `value` ticks; negative values move backwards
  kEnable,    // from a person at the rig, real arms: `value` is 1 while the enabling key is held, 0
              // once released
  kWatchdog,  // from the run itself: the watchdog has been silent for too long, `value` [s]
  kSuspended,  // from the run itself: the computer was suspended for `value` [s]
};
inline constexpr int kInputKinds = 17;

// Parameters that can be changed during a run. Stiffness and damping are factors by which the
// scenario's values are multiplied. Thresholds have their own units.
enum class Parameter : std::uint8_t {
  kStiffnessTranslation,  // factor
  kStiffnessRotation,     // factor
  kDampingRatio,          // factor
  kForceThreshold,        // [N]
  kTorqueThreshold,       // [N·m]
};
inline constexpr int kParameters = 5;
// Returns "stiffness_translation", "stiffness_rotation", "damping_ratio", "force" or "torque".
const char* Name(Parameter parameter);

struct RunInput {
  InputKind kind = InputKind::kNone;
  Parameter parameter = Parameter::kStiffnessTranslation;
  std::uint8_t hand = 0;     // 0 left, 1 right
  std::uint8_t grip = 0;     // the hand is closed
  std::uint32_t client = 0;  // the sender, as numbered by the viewer
  double value = 0;
  // Position of the hand in W [m]. A kLatency input contains three times [ms] instead. They are the
  // server's clock minus the page's clock, the time from the start of a tick to its reception by
  // the page, and the time from the start of the tick to its display.
  std::array<double, 3> p = {};
  std::array<double, 4> q = {1, 0, 0, 0};  // orientation of the hand, scalar first
};
static_assert(std::is_trivially_copyable_v<RunInput>);

// A queue from one writer to one reader, which may be in shared memory. Neither waits. If the queue
// is full, the newest input is refused. The reader must validate every input.
class InputQueue {
 public:
  static constexpr std::uint32_t kCapacity = 256;

  // Only the writer may call this function. It returns false if the queue is full.
  bool Push(const RunInput& input) noexcept {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) >= kCapacity) return false;
    slots_[head % kCapacity] = input;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  // Only the reader may call this function. It returns false if the queue is empty. A dead or
  // malicious writer cannot block this function: if the writer's count is impossible, the queue is
  // emptied.
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
