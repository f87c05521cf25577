// The latched faults of an arm: the first one, and the most severe one after it.
#pragma once

#include <atomic>

namespace predictor {

// Keeps the first fault, which is the cause of the stop, and the first later fault that forbids
// holding, which determines how the stop ends. Fault() means no fault. bool EndsWithoutPower(Fault)
// noexcept must be declared with the type. The tick writes it, and the reporting code reads it.
template <class Fault>
class FaultLatch {
 public:
  Fault first() const noexcept { return first_.load(std::memory_order_acquire); }
  Fault worse() const noexcept { return worse_.load(std::memory_order_acquire); }
  bool any() const noexcept { return first() != Fault(); }
  // Returns whether the state of the arm is unknown or its own button stopped it, so that it must
  // not remain powered.
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
