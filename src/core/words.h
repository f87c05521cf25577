// Messages about a run for the operator. They state the problem and the remedy. The texts of these
// messages are in message_catalogue.json. Not for use in the tick.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// Returns whether an arm did not come to rest when it was stopped.
constexpr bool SaysRestless(StopCause cause, Quantity quantity) {
  return cause == StopCause::kDevice &&
         (quantity == Quantity::kSpeed || quantity == Quantity::kTime);
}

// Returns the instruction for requesting motion with a key, such as "hold r" or, with an enabling
// device, "hold the enabling device and tap r".
std::string HowToHold(char key, bool enabling_device);

// Returns the text of the cause alone, for example "the force exceeded its threshold".
std::string StopCauseText(StopCause cause, Quantity quantity = Quantity::kNone);

// Returns the cause, without a full stop ("Left hand: no new sample from the arm arrived in time
// (12.4 ms, limit 5 ms)"), and the advice, in sentences ("Check the arm, its cable and its
// network."). Returns the quantity whose value made the virtual cobot stop itself: "force" or
// "joint torque".
std::string CobotStopWords(CobotStop stop);

// Returns the measured value and its limit: "12.4 ms, limit 5 ms". Returns "" if there is no
// quantity, except for a stop by the simulation: with a limit, its value is then an acceleration,
// and without a limit, a number was not finite.
std::string MeasuredWords(const Status& status);
std::string CauseWords(const Status& status);
std::string CauseAdvice(const Status& status);

// Returns, as sentences, the cause of the record's stop and the advice with the next step ("Check
// the arm, its cable and its network. Then reset."), or "" without a cause. The next step is not a
// reset if the power is off, an arm had a fault, or a device must be restarted.
std::string StopCauseWords(const TickRecord& record);
std::string StopAdvice(const TickRecord& record);

// Messages about refused requests. They state the reason and the remedy. Requests that follow one
// another within 0.6 s cause only one message.
class RefusalWords {
 public:
  explicit RefusalWords(double rate) : again_(static_cast<std::uint64_t>(0.6 * rate)) {}
  // Call this once per record, in order. It usually returns "". `rate` is the tick rate [Hz].
  std::string See(const TickRecord& record);

 private:
  std::uint64_t again_;     // repetition interval [ticks]
  std::uint64_t tick_ = 0;  // tick of the last refusal
  Refusal why_ = Refusal::kNone;
};

// Returns a sentence about the later fault that escalated the stop to power-off, or "" without such
// a fault. A space precedes the sentence. StopCauseWords contains this sentence.
std::string HarderWords(const StatusRecord& harder);

// Returns whether a reset is insufficient because an arm had a fault or a sensor froze, so that the
// program must be restarted.
bool NeedsANewStart(const TickRecord& record);

// Returns the message for a warning about this hand's devices, with the value from the record.
std::string WarningWords(Warning warning, std::size_t hand, double value);

// Returns one message for each warning of a hand that has become active (bits of HandRecord).
std::vector<std::string> NewWarnings(std::uint8_t before, const HandRecord& now, std::size_t hand);

}  // namespace predictor
