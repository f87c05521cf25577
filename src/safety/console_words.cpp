#include "safety/console_words.h"

#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/loaded_hands.h"
#include "core/motion.h"
#include "core/words.h"

namespace predictor {
namespace {

constexpr const char* kDeviceNotHeld =
    "The enabling device does not count as held. Hold it (let go of it first if it was held all "
    "along), then ask again.";

constexpr const char* kAtFault =
    "An arm that had a fault is not moved any more: if a hand is caught, free it by the robot's "
    "own means (free-drive or brake release).";

using Request = ConsoleWords::Request;
constexpr std::array<Request, 4> kRequests = {{
    {RunEvent::kAlignRequested, 'a', "align", {RunState::kAlign, RunState::kAlign}},
    {RunEvent::kStartRequested, 's', "start", {RunState::kRun, RunState::kRun}},
    {RunEvent::kRecoverRequested, 'r', "recover", {RunState::kRecovery, RunState::kRecovery}},
    {RunEvent::kReset, 'z', "reset", {RunState::kIdle, RunState::kSelfTest}},
}};

bool Asks(const TickRecord& record, RunEvent event) {
  return (record.requests >> static_cast<int>(event) & 1U) != 0;
}

// "left handle 12.0 N, 0.10 N·m; right ..."
std::string Loads(const TickRecord& record) {
  std::string text;
  for (std::size_t i = 0; i < kHands; ++i) {
    const auto& F = record.hands[i].wrench;
    if (!record.hands[i].present) continue;
    text += Formatted("%s%s handle %.1f N, %.2f N·m", text.empty() ? "" : "; ", kHandNames[i],
                      std::hypot(F[0], F[1], F[2]), std::hypot(F[3], F[4], F[5]));
  }
  return text;
}

// What is wrong now, as far as it is known; else what the run was stopped for.
std::string WhatRemains(const TickRecord& record, const std::string& trouble) {
  for (const StatusRecord& status : {record.read, record.written})
    if (status.cause != StopCause::kNone && trouble.empty())
      return " Now: " + CauseWords(FromRecord(status)) + ".";
  if (!trouble.empty()) return " Now: " + trouble;
  const std::string cause = StopCauseWords(record);
  return cause.empty() ? "" : " It was: " + cause;
}

}  // namespace

std::vector<std::string> ConsoleWords::See(const TickRecord& record,
                                           const std::function<std::string()>& trouble) {
  // A stop in the same tick says more than why what was asked for is not done.
  if (record.refused != 0 && record.state != RunState::kStopping)
    TellRefusal(record, trouble);
  else
    TellWrongTime(record);
  if (record.state != state_) {
    state_ = record.state;
    TellState(record, trouble);
  } else {
    TellFaults(record, trouble);
  }
  for (std::size_t i = 0; i < kHands; ++i) faults_[i] = ArmAtFault(record.hands[i]);
  return std::exchange(lines_, {});
}

// An arm's fault that comes behind the cause of a stop changes neither state nor cause, but what
// helps. HELD and UNPOWERED tell it as they begin, also of what came with the change to STOPPING.
// In any other state that a run comes to, it begins a stop in its own record.
void ConsoleWords::TellFaults(const TickRecord& record,
                              const std::function<std::string()>& trouble) {
  if (record.state != RunState::kStopping && record.state != RunState::kHeld &&
      record.state != RunState::kUnpowered)
    return;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!ArmAtFault(record.hands[i]) || faults_[i]) continue;
    const std::string more = trouble();
    lines_.push_back(Formatted("The %s arm reports a fault, too. ", kHandNames[i]) + more +
                     (more.empty() ? "" : " ") + kAtFault);
  }
}

// A key that is held asks again and again: told once, until it was let go.
bool ConsoleWords::Again(RunEvent event, std::uint64_t tick) {
  std::uint64_t& told = told_[static_cast<std::size_t>(event)];
  const bool again = told != 0 && tick - told < again_;
  told = tick + 1;
  return again;
}

void ConsoleWords::TellRefusal(const TickRecord& record,
                               const std::function<std::string()>& trouble) {
  const auto event = static_cast<RunEvent>(record.refused - 1);
  const auto why = static_cast<Refusal>(record.why_refused);
  if (Again(event, record.tick)) return;
  const bool device = why == Refusal::kNotEnabled && enabling_device_;
  const bool recover = why == Refusal::kBeyondJoint || why == Refusal::kBeyondLinks ||
                       (why == Refusal::kHandLoaded && !NothingMovesAnyMore(record));
  std::string text =
      std::string("Not done (") + Name(event) + "): " + (device ? kDeviceNotHeld : Sentence(why));
  if (recover) text += " To recover, " + HowToHold('r', enabling_device_) + ".";
  if (why == Refusal::kCauseRemains) text += WhatRemains(record, trouble());
  if (why == Refusal::kHandLoaded || why == Refusal::kNotFree)
    text += " Now: " + Loads(record) + ".";
  lines_.push_back(text);
}

// The table grants nothing there; where the arms follow a task, it stops them.
void ConsoleWords::TellWrongTime(const TickRecord& record) {
  const bool begins = record.state == RunState::kStopping && state_ != RunState::kStopping;
  const bool stops = begins && FollowsTask(state_);
  // What else stops in this tick is told by itself.
  if (begins && (record.cause != StopCause::kOperator || Asks(record, RunEvent::kStopRequested) ||
                 Asks(record, RunEvent::kStopAndPowerOff)))
    return;
  for (const Request& request : kRequests) {
    if (!Asks(record, request.event) || Granted(request, record.state)) continue;
    if (Again(request.event, record.tick)) continue;
    const std::string what = Formatted("%c (%s) has no place in ", request.key, request.name);
    lines_.push_back(stops ? "Stopped: " + what + Name(state_) +
                                 ", so the arms brake, and power off is asked for."
                           : "Not done: " + what + Name(record.state) + ". " + Possible(record));
  }
}

// What is under way may be asked for twice; a reset that changes nothing is none.
bool ConsoleWords::Granted(const Request& request, RunState now) const {
  if (request.event == RunEvent::kReset && now == state_) return false;
  return now == request.granted[0] || now == request.granted[1];
}

std::string ConsoleWords::Possible(const TickRecord& record) const {
  const char* held = enabling_device_ ? "the device" : "the key";
  switch (record.state) {
    case RunState::kInit:
      return "Wait for IDLE: the arms have not answered yet.";
    case RunState::kSelfTest:
      return "Wait for IDLE, hands off: the sensors are being tared.";
    case RunState::kIdle:
      return "Next, hands off: " + HowToHold('a', enabling_device_) + " to align. Or " +
             HowToHold('r', enabling_device_) + " to bring back what is beyond a limit.";
    case RunState::kAlign:
      return std::string("Keep holding ") + held +
             " until ARMED; letting go, or any other key, stops.";
    case RunState::kArmed:
      return "Next: " + HowToHold('s', enabling_device_) + " to start and run.";
    case RunState::kRun:
      return std::string("Keep holding ") + held + " for as long as it is to run; letting go, or " +
             "any other key, stops.";
    case RunState::kStopping:
      return "Wait until the arms rest.";
    case RunState::kHeld:
      if (NothingMovesAnyMore(record)) return std::string("Keys: Ctrl-C ends. ") + kAtFault;
      return (NeedsANewStart(record) ? "Keys: " : "Keys: z resets, hands off; ") +
             HowToHold('r', enabling_device_) +
             " to free a hand that is caught, or bring back what is beyond a limit; Ctrl-C ends.";
    case RunState::kUnpowered:
      return "Keys: z resets, where the arms kept their power; Ctrl-C ends.";
    case RunState::kRecovery:
      return std::string("Letting go of ") + held + " ends it; any other key stops.";
  }
  return "";
}

// Danger first; then the cause, what to do, and by which keys.
void ConsoleWords::TellState(const TickRecord& record,
                             const std::function<std::string()>& trouble) {
  const std::string now = std::string("Now ") + Name(record.state);
  if (record.state == RunState::kSelfTest || record.state == RunState::kIdle ||
      record.state == RunState::kArmed)
    return lines_.push_back(now + ". " + Possible(record));
  if (record.state != RunState::kHeld && record.state != RunState::kUnpowered)
    return lines_.push_back(now + ".");
  for (std::size_t i = 0; i < kHands; ++i) {
    const auto& V = record.hands[i].real.twist;
    if (record.hands[i].present &&
        HandleSpeed(Eigen::Map<const Twist>(V.data())) > kStandstillSpeed)
      lines_.push_back(
          Formatted("THE %s ARM STILL MOVES, though it was told to rest. USE THE EMERGENCY STOP.",
                    i == 0 ? "LEFT" : "RIGHT"));
  }
  if (record.cause == StopCause::kNone) {
    lines_.push_back(now + ". Done.");
  } else {
    lines_.push_back(now + " after the stop '" + Name(record.cause) + "'. " +
                     StopCauseWords(record));
    if (const std::string more = trouble(); !more.empty()) lines_.push_back("  " + more);
    lines_.push_back("  " + StopAdvice(record));
  }
  lines_.push_back("  " + Possible(record));
}

}  // namespace predictor
