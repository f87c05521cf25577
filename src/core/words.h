// What a person is told of a run, in plain words: what is wrong, and what to do. Not for the tick.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// An arm did not come to rest though it was told to.
constexpr bool SaysRestless(StopCause cause, Quantity quantity) {
  return cause == StopCause::kDevice &&
         (quantity == Quantity::kSpeed || quantity == Quantity::kTime);
}

// How a person asks by a key for what moves arms: "hold r", or, with an enabling device, "hold the
// enabling device and touch r".
std::string HowToHold(char key, bool enabling_device);

// What is wrong, without a full stop: "Left hand: no fresh sample of the arm came in time (12.4 ms
// seen, 5 ms allowed)"; and what to look at: "Check the arm, its cable and its network".
std::string CauseWords(const Status& status);
std::string CauseAdvice(const Status& status);

// Of the stop that the record tells, the same as sentences; and what to do: "Check the arm, its
// cable and its network, then reset." Where power is off, an arm had a fault, or a device has to be
// restarted, a reset alone does not do, and what does is told. "" without a cause.
std::string StopCauseWords(const TickRecord& record);
std::string StopAdvice(const TickRecord& record);

// What took the power off at the end of a stop that would have held, as a sentence after a space;
// "" where nothing did. It is part of StopCauseWords.
std::string HarderWords(const StatusRecord& harder);

// A reset alone does not do: an arm that had a fault is taken up by a new start alone, and a sensor
// that was restarted counts anew.
bool NeedsANewStart(const TickRecord& record);

// Of a warning about this hand's devices, with its value as the record has it.
std::string WarningWords(Warning warning, std::size_t hand, double value);

// Of the warnings of a hand that are in force now and were not before (bits as in HandRecord),
// each: none, or sentences.
std::vector<std::string> NewWarnings(std::uint8_t before, const HandRecord& now, std::size_t hand);

}  // namespace predictor
