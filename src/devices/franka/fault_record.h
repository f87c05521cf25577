// What is wrong with a Franka arm, for good.
#pragma once

#include <atomic>
#include <string>

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

// Written by the tick, read by whoever tells a person.
class FaultRecord {
 public:
  bool any() const noexcept { return told().fault != Fault::kNone; }

  // Nobody can say any more what the arm does, or somebody has stopped it at its own button: it
  // must not be left holding.
  bool ends_without_power() const noexcept {
    return EndsWithoutPower(told()) || worse().fault != Fault::kNone;
  }

  // The first one counts, and the first after it after which the arm must not be left holding.
  // detail: of its mode or its answer.
  void Set(Fault fault, int detail = 0) noexcept {
    const Told next{fault, static_cast<std::int8_t>(detail)};
    if (!any())
      told_.store(next, std::memory_order_release);
    else if (EndsWithoutPower(next) && !ends_without_power())
      worse_.store(next, std::memory_order_release);
  }
  // Whatever comes first says that it was a reflex, and a later state which.
  void Name(const Errors& errors) noexcept {
    if (errors_.load(std::memory_order_relaxed) == 0)
      errors_.store(errors.to_ullong(), std::memory_order_relaxed);
  }

  // For a person: who, what, and what to do.
  std::string Tell(const Address& who) const;

 private:
  struct Told {
    Fault fault = Fault::kNone;
    std::int8_t detail = 0;
  };
  static bool EndsWithoutPower(const Told& told) noexcept;
  Told told() const noexcept { return told_.load(std::memory_order_acquire); }
  Told worse() const noexcept { return worse_.load(std::memory_order_acquire); }

  std::atomic<Told> told_{Told()}, worse_{Told()};
  std::atomic<unsigned long long> errors_{0};
};

}  // namespace predictor::fci
