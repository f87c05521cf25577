// Messages about a run for the operator: the problem and the remedy. Their texts are in
// message_catalogue.json. Not for the tick.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/record.h"

namespace predictor {

// True if an arm did not come to rest when it was stopped.
constexpr bool SaysRestless(StopCause cause, Quantity quantity) {
  return cause == StopCause::kDevice &&
         (quantity == Quantity::kSpeed || quantity == Quantity::kTime);
}

// How the operator requests motion with a key: "hold r" or, with an enabling device, "hold the
// enabling device and tap r".
std::string HowToHold(char key, bool enabling_device);

// Text of the cause alone: "the force exceeded its threshold".
std::string StopCauseText(StopCause cause, Quantity quantity = Quantity::kNone);

// The cause, without a full stop ("Left hand: no new sample from the arm arrived in time (12.4 ms,
// limit 5 ms)"), and the advice, as sentences ("Check the arm, its cable and its network.").
// "force", "joint torque": the quantity by which the virtual cobot stopped itself.
std::string CobotStopWords(CobotStop stop);

std::string CauseWords(const Status& status);
std::string CauseAdvice(const Status& status);

// The cause of the record's stop, as sentences, and the advice with the next step ("Check the arm,
// its cable and its network. Then reset."). The next step is not a reset if the power is off, an
// arm had a fault, or a device must be restarted. "" without a cause.
std::string StopCauseWords(const TickRecord& record);
std::string StopAdvice(const TickRecord& record);

// Messages about refused requests: the reason and the remedy. Requests that follow one another
// within 0.6 s cause only one message.
class RefusalWords {
 public:
  explicit RefusalWords(double rate) : again_(static_cast<std::uint64_t>(0.6 * rate)) {}
  // Call once per record, in order; usually returns "". rate: of ticks [Hz].
  std::string See(const TickRecord& record);

 private:
  std::uint64_t again_;     // repetition interval [ticks]
  std::uint64_t tick_ = 0;  // tick of the last refusal
  Refusal why_ = Refusal::kNone;
};

// The later fault that escalated the stop to power-off, as a sentence after a space; "" without
// such a fault. It is part of StopCauseWords.
std::string HarderWords(const StatusRecord& harder);

// True if a reset is not sufficient: after an arm fault or a frozen sensor the program must be
// restarted.
bool NeedsANewStart(const TickRecord& record);

// Message for a warning about this hand's devices; value as in the record.
std::string WarningWords(Warning warning, std::size_t hand, double value);

// One message for each warning of a hand that has become active (bits as in HandRecord).
std::vector<std::string> NewWarnings(std::uint8_t before, const HandRecord& now, std::size_t hand);

}  // namespace predictor
