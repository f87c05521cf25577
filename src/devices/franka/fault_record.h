// What is wrong with a Franka arm, for good.
#pragma once

#include <atomic>
#include <string>

#include "devices/fault_latch.h"
#include "devices/franka/fci.h"
#include "devices/wire/network.h"

namespace predictor::fci {

enum class Fault : std::uint8_t {
  kNone,
  kClosed,
  kNonsense,
  kSilent,
  kMode,   // not one in which it can move
  kError,  // it names errors
  kMove,   // its answer to Move
  kNoStart,
  kNoEnd,
};

// detail: of its mode or its answer.
struct FaultAndDetail {
  Fault fault = Fault::kNone;
  std::int8_t detail = 0;
  friend bool operator==(const FaultAndDetail&, const FaultAndDetail&) = default;
};
bool EndsWithoutPower(const FaultAndDetail& what) noexcept;

// Written by the tick, read by whoever tells a person.
class FaultRecord {
 public:
  bool any() const noexcept { return latch_.any(); }
  bool ends_without_power() const noexcept { return latch_.ends_without_power(); }
  void Set(Fault fault, int detail = 0) noexcept {
    latch_.Set({fault, static_cast<std::int8_t>(detail)});
  }
  // Whatever comes first says that it was a reflex, and a later state which.
  void Name(const Errors& errors) noexcept {
    if (errors_.load(std::memory_order_relaxed) == 0)
      errors_.store(errors.to_ullong(), std::memory_order_relaxed);
  }

  // For a person: who, what, and what to do.
  std::string Tell(const Address& who) const;

 private:
  FaultLatch<FaultAndDetail> latch_;
  std::atomic<unsigned long long> errors_{0};
};

}  // namespace predictor::fci
