#include "core/words.h"

#include <array>

#include "core/format.h"
#include "core/loaded_hands.h"

namespace predictor {
namespace {

struct WhatToSay {
  const char *what, *advice;
};

// As the page has them (web/src/words.ts; a test compares them): what was wrong, and what to do
// before the reset.
constexpr std::array<WhatToSay, kStopCauses> kCauses = {{
    {"", ""},
    {"the force was above its threshold", "Guide the handles more gently"},
    {"the torque was above its threshold", "Twist the handles less"},
    {"the force sensor gave a reading that cannot be trusted", "Check the sensor and its cable"},
    {"no fresh sample came in time", "Check network and cables of arm and sensor"},
    {"the real handle was too far from the virtual one",
     "Move more slowly, or place the arms nearer to the task"},
    {"the coupling of the real and the virtual handle pulled too hard",
     "The arms could not follow: move more slowly or stay within their reach"},
    {"two links came nearer than their security distance",
     "Keep the handles further apart, or the arms’ bases"},
    {"a joint was beyond its limit", "Bring the arm back within its limits (recovery)"},
    {"the force oscillated more and more", "Hold the handles less stiffly, or lower the stiffness"},
    {"no motion was found that keeps all limits", "Start from a pose further from the limits"},
    {"the simulation diverged", "Lower the stiffness or check the scenario’s masses"},
    {"ticks came too late", "Close other programs on this computer"},
    {"the device reported a fault", "Look at the robot’s own panel and clear the fault there"},
    {"a person asked to stop", "Make sure that everybody is ready"},
    {"the headset was left or showed no new picture, so its wearer could not see the arms move",
     "Take the headset off or bring its picture back"},
    {"the enabling key or device was let go", "Make sure that everybody is ready"},
    {"the handle ran away against the hand that held it",
     "The sensor may read another way than it is pushed: test the pushes"},
}};

// What is known more closely by what was measured.
constexpr WhatToSay kArmOld = {"no fresh sample of the arm came in time",
                               "Check the arm, its cable and its network"};
constexpr WhatToSay kSensorOld = {"no fresh reading of the force sensor came in time",
                                  "Check the force sensor, its cable and its network"};
constexpr WhatToSay kFrozen = {"the force sensor repeated one and the same reading",
                               "Look at the force sensor, and restart what repeats itself"};
constexpr WhatToSay kJump = {"a joint’s angle jumped",
                             "An encoder’s reading jumped: do not trust this arm until its own "
                             "checks pass"};
constexpr WhatToSay kUnsteady = {
    "the force sensor did not read steadily while it was tared",
    "Keep hands off the handle until IDLE; where nobody touched it, check the sensor and its "
    "cable"};
constexpr WhatToSay kRestless = {"an arm did not come to rest though it was told to",
                                 "Do not trust this arm until its own checks pass"};

const WhatToSay& WordsOf(StopCause cause, Quantity quantity) {
  if (cause == StopCause::kStale && quantity == Quantity::kArmAge) return kArmOld;
  if (cause == StopCause::kStale && quantity == Quantity::kSensorAge) return kSensorOld;
  if (cause == StopCause::kStale && quantity == Quantity::kCount) return kFrozen;
  if (cause == StopCause::kSensor && quantity != Quantity::kNone) return kUnsteady;
  if (cause == StopCause::kDevice && quantity == Quantity::kAngle) return kJump;
  if (SaysRestless(cause, quantity)) return kRestless;
  return kCauses[static_cast<std::size_t>(cause)];
}

constexpr const char* kUnpoweredAdvice =
    "An arm that lost its power is switched on at its own panel, and the program started again; so "
    "it is where an arm or a sensor was restarted, which counts anew. Where none of that was, "
    "reset: the sensors are tared anew, so hands off.";

}  // namespace

std::string HowToHold(char key, bool enabling_device) {
  return Formatted(enabling_device ? "hold the enabling device and touch %c" : "hold %c", key);
}

std::string CauseWords(const Status& status) {
  std::string text = WordsOf(status.cause, status.quantity).what;
  if (status.hand == 0 || status.hand == 1)
    text.insert(0, status.hand == 0 ? "Left hand: " : "Right hand: ");
  else
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  if (status.quantity != Quantity::kNone)
    text += " (" + SeenAndAllowed(status.value, status.limit, status.quantity) + ")";
  return text;
}

std::string CauseAdvice(const Status& status) {
  return WordsOf(status.cause, status.quantity).advice;
}

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

std::string HarderWords(const StatusRecord& harder) {
  if (harder.cause == StopCause::kNone) return "";
  return " Power off was asked for because of this: " + CauseWords(FromRecord(harder)) + ".";
}

std::string StopAdvice(const TickRecord& record) {
  if (record.cause == StopCause::kNone) return "";
  std::string advice = WordsOf(record.cause, record.cause_quantity).advice;
  // An arm's fault may come behind the cause, and not change it.
  for (const WhatToSay& words :
       {WordsOf(record.harder.cause, record.harder.quantity),
        WordsOf(ArmAtFault(record) ? StopCause::kDevice : StopCause::kNone, Quantity::kNone)})
    if (advice.find(words.advice) == std::string::npos) advice += std::string(". ") + words.advice;
  if (record.state == RunState::kUnpowered) return advice + ". " + kUnpoweredAdvice;
  return advice + (NeedsANewStart(record) ? ", then start the program again." : ", then reset.");
}

std::string WarningWords(Warning warning, std::size_t hand, double value) {
  const char* side = kHandNames[hand];
  switch (warning) {
    case Warning::kArmLoss:
      return Formatted(
          "Warning: %.1f %% of the %s arm's samples or commands of the last second were lost. Keep "
          "the network of the arms to themselves; see cable and switch.",
          100 * value, side);
    case Warning::kSensorLoss:
      return Formatted(
          "Warning: %.1f %% of the %s sensor's readings of the last second were lost. Keep the "
          "network of the devices to themselves; see cable and switch.",
          100 * value, side);
    case Warning::kRefused:
      return Formatted(
          "Warning: packets for the %s hand's devices were dropped, %.0f a second: of a wrong "
          "size, "
          "unreadable, or of somebody else. See who sends in this network.",
          side, value);
    case Warning::kBiasDrift:
      return Formatted(
          "Warning: the %s sensor drifts by %.1f N a minute though nothing touches the handle. Let "
          "it warm up; start anew to tare it.",
          side, value);
    case Warning::kNoPowerOff:
      return Formatted(
          "Warning: the %s arm's dashboard has closed its connection: power off cannot be asked "
          "for any more. Start the program again; until then, where its power must be off, use the "
          "emergency stop.",
          side);
    case Warning::kKeepsPower:
      return Formatted(
          "THE %s ARM STILL HAS ITS POWER, though it was to be cut. PRESS THE EMERGENCY STOP.",
          hand == 0 ? "LEFT" : "RIGHT");
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
