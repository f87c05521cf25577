#include "core/words.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/loaded_hands.h"
#include "core/message_catalogue.h"

namespace predictor {
namespace {

// Returns the name of the stop in the catalogue, which may depend on the cause and the quantity.
std::string StopId(StopCause cause, Quantity quantity) {
  if (cause == StopCause::kStale && quantity == Quantity::kArmAge) return "stop.arm_stale";
  if (cause == StopCause::kStale && quantity == Quantity::kSensorAge) return "stop.sensor_stale";
  if (cause == StopCause::kStale && quantity == Quantity::kCount) return "stop.sensor_frozen";
  if (cause == StopCause::kOscillation && quantity == Quantity::kVibration) return "stop.vibration";
  if (cause == StopCause::kSensor && quantity != Quantity::kNone) return "stop.taring";
  if (cause == StopCause::kDevice && quantity == Quantity::kAngle) return "stop.angle_jump";
  if (cause == StopCause::kDeadline && quantity == Quantity::kTime) return "stop.suspended";
  if (cause == StopCause::kPhysics && quantity == Quantity::kCount) return "stop.controller";
  if (cause == StopCause::kPhysics && quantity == Quantity::kTime) return "stop.controller_late";
  if (cause == StopCause::kPhysics && quantity == Quantity::kAllocations)
    return "stop.controller_allocates";
  if (SaysRestless(cause, quantity)) return "stop.no_rest";
  return std::string("stop.") + Name(cause);
}

std::string Advice(StopCause cause, Quantity quantity) {
  return cause == StopCause::kNone ? "" : MessageOf(StopId(cause, quantity) + ".advice");
}

std::string Capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

constexpr std::array<MessageId, kRefusals - 1> kRefusalTexts = {
    "refusal.not_enabled", "refusal.beyond_joint", "refusal.beyond_links", "refusal.cause_remains",
    "refusal.hand_loaded", "refusal.not_free",     "refusal.moves",        "refusal.not_aligned"};

}  // namespace

const char* Sentence(Refusal refusal) {
  // The texts in the table are string literals, so they end with a null character.
  return refusal == Refusal::kNone
             ? ""
             : kRefusalTexts[static_cast<std::size_t>(refusal) - 1].text().data();
}

std::string HowToHold(char key, bool enabling_device) {
  const MessageValue value{"key", std::string(1, key)};
  return enabling_device ? Message("hold.device", {value}) : Message("hold.key", {value});
}

std::string StopCauseText(StopCause cause, Quantity quantity) {
  return MessageOf(StopId(cause, quantity) + ".cause");
}

std::string CobotStopWords(CobotStop stop) {
  return stop == CobotStop::kJointTorque ? "joint torque" : Name(stop);
}

std::string MeasuredWords(const Status& status) {
  if (status.quantity == Quantity::kNone) return "";
  if (status.quantity == Quantity::kNotFinite) return Message("value.not_finite");
  const std::string measured = SeenAndAllowed(status.value, status.limit, status.quantity);
  if (status.cause != StopCause::kPhysics) return measured;
  switch (status.quantity) {
    case Quantity::kCount:
      return Message("value.torques", {{"count", Formatted("%.0f", status.value)}});
    case Quantity::kAllocations:
      return Message("value.allocations", {{"count", Formatted("%.0f", status.value)}});
    case Quantity::kTime:
      return Message("value.silence", {{"value", measured}});
    case Quantity::kAcceleration:
    case Quantity::kAngularAcceleration:
      return Message("value.acceleration", {{"value", measured}});
    default:
      return Message("value.speed", {{"value", measured}});
  }
}

std::string CauseWords(const Status& status) {
  std::string text = StopCauseText(status.cause, status.quantity);
  if (status.hand == 0)
    text = Message("hand.left", {{"text", text}});
  else if (status.hand == 1)
    text = Message("hand.right", {{"text", text}});
  if (const std::string measured = MeasuredWords(status); !measured.empty())
    text += " (" + measured + ")";
  return Capitalised(text);
}

std::string CauseAdvice(const Status& status) { return Advice(status.cause, status.quantity); }

bool NeedsANewStart(const TickRecord& record) {
  const auto needs = [](StopCause cause, Quantity quantity) {
    return cause == StopCause::kDevice ||
           (cause == StopCause::kStale && quantity == Quantity::kCount);
  };
  return needs(record.cause, record.cause_quantity) ||
         needs(record.harder.cause, record.harder.quantity) || ArmAtFault(record);
}

std::string StopCauseWords(const TickRecord& record) {
  if (record.cause == StopCause::kNone) return "";
  return CauseWords({record.cause, record.cause_hand, record.cause_value, record.cause_limit,
                     record.cause_quantity}) +
         "." + HarderWords(record.harder);
}

std::string RefusalWords::See(const TickRecord& record) {
  // If a stop was decided in the same tick, only the stop is reported, because the stop is more
  // informative.
  if (record.refused == 0 || record.state == RunState::kStopping) return "";
  const auto why = static_cast<Refusal>(record.why_refused);
  const bool again = std::exchange(why_, why) == why && record.tick - tick_ < again_;
  tick_ = record.tick;
  if (again) return "";
  const std::string cause = why == Refusal::kCauseRemains ? StopCauseWords(record) : "";
  return Message("refusal.done", {{"why", Sentence(why)}}) +
         (cause.empty() ? "" : " " + Message("refusal.was", {{"cause", cause}}));
}

std::string HarderWords(const StatusRecord& harder) {
  if (harder.cause == StopCause::kNone) return "";
  return " " + Message("stop.power_off_because", {{"cause", CauseWords(FromRecord(harder)) + "."}});
}

std::string StopAdvice(const TickRecord& record) {
  if (record.cause == StopCause::kNone) return "";
  std::string advice = Advice(record.cause, record.cause_quantity);
  // A device fault may follow the cause without replacing the cause.
  for (const std::string& more :
       {Advice(record.harder.cause, record.harder.quantity),
        ArmAtFault(record) ? Advice(StopCause::kDevice, Quantity::kNone) : std::string()})
    if (advice.find(more) == std::string::npos) advice += " " + more;
  if (record.state == RunState::kUnpowered) return advice + " " + Message("next.unpowered");
  return advice + " " + (NeedsANewStart(record) ? Message("next.restart") : Message("next.reset"));
}

std::string WarningWords(Warning warning, std::size_t hand, double value) {
  const MessageValue side{"side", kHandNames[hand]};
  const MessageValue percent{"percent", Formatted("%.1f", 100 * value)};
  switch (warning) {
    case Warning::kArmLoss:
      return Message("warning.arm_loss", {percent, side});
    case Warning::kSensorLoss:
      return Message("warning.sensor_loss", {percent, side});
    case Warning::kRefused:
      return Message("warning.refused", {{"count", Formatted("%.0f", value)}, side});
    case Warning::kBiasDrift:
      return Message("warning.bias_drift", {{"drift", Formatted("%.1f", value)}, side});
    case Warning::kNoPowerOff:
      return Message("warning.no_power_off", {side});
    case Warning::kKeepsPower:
      return Message("danger.keeps_power", {{"SIDE", hand == 0 ? "LEFT" : "RIGHT"}});
  }
  return "";
}

std::vector<std::string> NewWarnings(std::uint8_t before, const HandRecord& now, std::size_t hand) {
  std::vector<std::string> words;
  const unsigned fresh = now.warnings & ~unsigned{before};
  for (std::size_t w = 0; w < kWarnings; ++w)
    if ((fresh >> w & 1U) != 0)
      words.push_back(WarningWords(static_cast<Warning>(w), hand,
                                   w < kWarningValues ? now.warning_values[w] : 0));
  return words;
}

}  // namespace predictor
