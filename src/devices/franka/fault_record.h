// The latched faults of a Franka arm.
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
  kMode,   // a mode in which it cannot move
  kError,  // the robot reports errors
  kMove,   // negative answer to Move
  kNoStart,
  kNoEnd,
};

// `detail` is the mode or the answer of the robot.
struct FaultAndDetail {
  Fault fault = Fault::kNone;
  std::int8_t detail = 0;
  friend bool operator==(const FaultAndDetail&, const FaultAndDetail&) = default;
};
bool EndsWithoutPower(const FaultAndDetail& what) noexcept;

// The tick writes the record, and the code that reports faults reads it.
class FaultRecord {
 public:
  bool any() const noexcept { return latch_.any(); }
  bool ends_without_power() const noexcept { return latch_.ends_without_power(); }
  void Set(Fault fault, int detail = 0) noexcept {
    latch_.Set({fault, static_cast<std::int8_t>(detail)});
  }
  // Names the errors that stopped the robot. The first report may show only that a reflex stopped
  // the robot. A later state contains the errors.
  void Name(const Errors& errors) noexcept {
    if (errors_.load(std::memory_order_relaxed) == 0)
      errors_.store(errors.to_ullong(), std::memory_order_relaxed);
  }

  // Describes the arm, the fault, and the remedy for the user.
  std::string Describe(const Address& who) const;

 private:
  FaultLatch<FaultAndDetail> latch_;
  std::atomic<unsigned long long> errors_{0};
};

}  // namespace predictor::fci
