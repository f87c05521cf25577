// Detects hands on which the arms still press after a stop. Not for use in the tick.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// Returns whether this hand's arm or, without a hand, any arm reports a fault. Only a restart of
// the program clears the fault, and nothing moves the arm until then.
bool ArmAtFault(const HandRecord& hand);
bool ArmAtFault(const TickRecord& record);

// Returns whether RECOVERY cannot move the arms after a stop, because the power is off or an arm
// had a fault.
bool NothingMovesAnyMore(const TickRecord& record);

// A stopped arm with power is stiff, and an arm without power is heavy. A hand may therefore be
// trapped at any time after a stop. The message appears once when a force has acted on a hand for
// kPatience. The message appears again only after the handle has been free for kPatience or after
// the arms have moved.
class LoadedHands {
 public:
  static constexpr double kPatience = 0.5;  // [s]

  // A hand is loaded above `force` [N]. `rate` is the tick rate [Hz]. With an `enabling_device`,
  // the person holds this device instead of a key.
  LoadedHands(double force, double rate, bool enabling_device = false)
      : force_(force), patience_(kPatience * rate), enabling_device_(enabling_device) {}
  // Call this with each record, in order. Returns a list of sentences for the operator. The list is
  // usually empty.
  std::vector<std::string> See(const TickRecord& record);

 private:
  struct Hand {
    std::uint64_t since = 0;  // tick of the last change of state
    bool loaded = false, reported = false;
  };

  double force_, patience_;  // [N], [ticks]
  bool enabling_device_;
  std::array<Hand, kHands> hands_;
};

}  // namespace predictor
