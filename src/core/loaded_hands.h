// Whose hand the arms still press on after a stop. Not for the tick.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// This hand's arm, or any, reports a fault: it is taken up by a new start of the program only, and
// nothing moves it until then.
bool ArmAtFault(const HandRecord& hand);
bool ArmAtFault(const TickRecord& record);

// After a stop: without power, or where an arm has had a fault, RECOVERY moves nothing.
bool NothingMovesAnyMore(const TickRecord& record);

// A stop holds stiffly, and a robot whose power is off is heavy: a hand may be caught at any time
// then. Told once for each time that something presses for kPatience, and again when the handle was
// free for as long, or the arms have moved in between.
class LoadedHands {
 public:
  static constexpr double kPatience = 0.5;  // [s]

  // force: from which on a hand is loaded [N]. rate: of ticks [Hz]. enabling_device: what a person
  // holds is not a key.
  LoadedHands(double force, double rate, bool enabling_device = false)
      : force_(force), patience_(kPatience * rate), enabling_device_(enabling_device) {}
  // Of each record, in order: what a person is to be told now, sentences; mostly none.
  std::vector<std::string> See(const TickRecord& record);

 private:
  struct Hand {
    std::uint64_t since = 0;  // tick since which it is as it is
    bool loaded = false, told = false;
  };

  double force_, patience_;  // [N], [ticks]
  bool enabling_device_;
  std::array<Hand, kHands> hands_;
};

}  // namespace predictor
