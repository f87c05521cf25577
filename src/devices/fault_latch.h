// What is wrong with an arm, for good: the first fault, and what came after it.
#pragma once

#include <atomic>

namespace predictor {

// Keeps the first fault, and the first after it after which the arm must not be left holding: so
// the most severe decides how a stop ends, and the first is the cause. Fault() means none;
// bool EndsWithoutPower(Fault) noexcept is found beside the type. Written by the tick, read by
// whoever tells a person.
template <class Fault>
class FaultLatch {
 public:
  Fault first() const noexcept { return first_.load(std::memory_order_acquire); }
  Fault worse() const noexcept { return worse_.load(std::memory_order_acquire); }
  bool any() const noexcept { return first() != Fault(); }
  // Nobody can say any more what the arm does, or somebody has stopped it at its own button: it
  // must not be left holding.
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
