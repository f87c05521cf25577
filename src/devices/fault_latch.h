// The latched faults of an arm: the first fault and, if there was one, a more severe later fault.
#pragma once

#include <atomic>

namespace predictor {

// Keeps two faults. The first fault is the cause of the stop. The first later fault that forbids
// holding determines how the stop ends. Fault() means no fault. A function `bool
// EndsWithoutPower(Fault) noexcept` must be declared next to the type of the faults. The tick
// writes this object, and the code that reports faults reads it.
template <class Fault>
class FaultLatch {
 public:
  Fault first() const noexcept { return first_.load(std::memory_order_acquire); }
  Fault worse() const noexcept { return worse_.load(std::memory_order_acquire); }
  bool any() const noexcept { return first() != Fault(); }
  // Returns whether the arm must not remain powered, because its state is unknown or because its
  // own stop button was pressed.
  bool ends_without_power() const noexcept {
    return EndsWithoutPower(first()) || worse() != Fault();
  }
  void Set(Fault fault) noexcept {
    if (!any())
      first_.store(fault, std::memory_order_release);
    else if (EndsWithoutPower(fault) && !ends_without_power())
      worse_.store(fault, std::memory_order_release);
  }

 private:
  static_assert(std::atomic<Fault>::is_always_lock_free);

  std::atomic<Fault> first_{Fault()}, worse_{Fault()};
};

}  // namespace predictor
