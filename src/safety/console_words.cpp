#include "safety/console_words.h"

#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/loaded_hands.h"
#include "core/message_catalogue.h"
#include "core/motion.h"
#include "core/words.h"

namespace predictor {
namespace {

bool Asks(const TickRecord& record, RunEvent event) {
  return (record.requests >> static_cast<int>(event) & 1U) != 0;
}

// Returns a text such as "left handle 12.0 N, 0.10 N·m; right ...".
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

// Returns a space and the present fault if it is known, or otherwise a space and the cause of the
// stop.
std::string PresentCause(const TickRecord& record, const std::string& trouble) {
  std::string now = trouble;
  for (const StatusRecord& status : {record.read, record.written})
    if (status.cause != StopCause::kNone && now.empty()) now = CauseWords(FromRecord(status)) + ".";
  if (!now.empty()) return " " + Message("refusal.now", {{"what", now}});
  const std::string cause = StopCauseWords(record);
  return cause.empty() ? "" : " " + Message("refusal.was", {{"cause", cause}});
}

}  // namespace

std::vector<std::string> ConsoleWords::See(const TickRecord& record,
                                           const std::function<std::string()>& trouble) {
  // A stop in the same tick takes precedence over a refused request.
  if (record.refused != 0 && record.state != RunState::kStopping)
    AddRefusal(record, trouble);
  else
    AddWrongTime(record);
  if (record.state != state_) {
    state_ = record.state;
    AddState(record, trouble);
  } else {
    AddFaults(record, trouble);
  }
  for (std::size_t i = 0; i < kHands; ++i) faults_[i] = ArmAtFault(record.hands[i]);
  return std::exchange(lines_, {});
}

// After a stop, a fault of an arm changes neither the state nor the cause of the stop, but it
// changes what the operator can do. The messages at the beginning of HELD and UNPOWERED report a
// fault that already exists. In any state other than HELD and UNPOWERED, such a fault causes a
// stop.
void ConsoleWords::AddFaults(const TickRecord& record,
                             const std::function<std::string()>& trouble) {
  if (record.state != RunState::kStopping && record.state != RunState::kHeld &&
      record.state != RunState::kUnpowered)
    return;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!ArmAtFault(record.hands[i]) || faults_[i]) continue;
    const std::string more = trouble();
    lines_.push_back(Message("console.arm_fault", {{"side", kHandNames[i]}}) + " " + more +
                     (more.empty() ? "" : " ") + Message("console.arm_fault_free"));
  }
}

// While the operator holds a key down, the key repeats its request. Only one message is shown until
// the operator releases the key.
bool ConsoleWords::Again(RunEvent event, std::uint64_t tick) {
  std::uint64_t& reported = reported_[static_cast<std::size_t>(event)];
  const bool again = reported != 0 && tick - reported < again_;
  reported = tick + 1;
  return again;
}

void ConsoleWords::AddRefusal(const TickRecord& record,
                              const std::function<std::string()>& trouble) {
  const auto event = static_cast<RunEvent>(record.refused - 1);
  const auto why = static_cast<Refusal>(record.why_refused);
  if (Again(event, record.tick)) return;
  const bool device = why == Refusal::kNotEnabled && enabling_device_;
  const bool recover = why == Refusal::kBeyondJoint || why == Refusal::kBeyondLinks ||
                       (why == Refusal::kHandLoaded && !NothingMovesAnyMore(record));
  const std::string reason = device ? Message("refusal.device_not_held") : Sentence(why);
  std::string text = Message("refusal.request", {{"request", Name(event)}, {"why", reason}});
  if (recover)
    text += " " + Message("refusal.recover", {{"hold", HowToHold('r', enabling_device_)}});
  if (why == Refusal::kCauseRemains) text += PresentCause(record, trouble());
  if (why == Refusal::kHandLoaded || why == Refusal::kNotFree)
    text += " " + Message("refusal.now", {{"what", Loads(record) + "."}});
  lines_.push_back(text);
}

// Adds the message that the state does not allow the request. While the arms follow a task, such a
// request stops the arms.
void ConsoleWords::AddWrongTime(const TickRecord& record) {
  const bool begins = record.state == RunState::kStopping && state_ != RunState::kStopping;
  const bool stops = begins && FollowsTask(state_);
  // Any other stop in this tick is reported by its own message.
  if (begins && (record.cause != StopCause::kOperator || Asks(record, RunEvent::kStopRequested) ||
                 Asks(record, RunEvent::kStopAndPowerOff)))
    return;
  for (const ConsoleKey& asked : kConsoleKeys) {
    if (!Asks(record, asked.event) || Granted(asked, record.state)) continue;
    if (Again(asked.event, record.tick)) continue;
    const MessageValue key{"key", std::string(1, asked.key)}, name{"name", asked.name};
    lines_.push_back(
        stops
            ? Message("console.key_stops", {key, name, {"state", Name(state_)}})
            : Message("console.key_refused",
                      {key, name, {"state", Name(record.state)}, {"possible", Possible(record)}}));
  }
}

// A request may be repeated while it is being granted, but a reset must change the state.
bool ConsoleWords::Granted(const ConsoleKey& key, RunState now) const {
  if (key.event == RunEvent::kReset && now == state_) return false;
  return now == key.granted[0] || now == key.granted[1];
}

std::string ConsoleWords::Possible(const TickRecord& record) const {
  std::string id = std::string("console.possible.") + Name(record.state);
  const bool fault = record.state == RunState::kHeld && NothingMovesAnyMore(record);
  if (record.state == RunState::kHeld && (fault || NeedsANewStart(record)))
    id += fault ? "_fault" : "_restart";
  const std::string text =
      MessageOf(id, {{"held", enabling_device_ ? Message("held.device") : Message("held.key")},
                     {"hold_align", HowToHold('a', enabling_device_)},
                     {"hold_start", HowToHold('s', enabling_device_)},
                     {"hold_recover", HowToHold('r', enabling_device_)}});
  return fault ? text + " " + Message("console.arm_fault_free") : text;
}

// The message states the danger first, and then the cause, the advice and the keys.
void ConsoleWords::AddState(const TickRecord& record, const std::function<std::string()>& trouble) {
  const MessageValue state{"state", Name(record.state)};
  if (record.state == RunState::kSelfTest || record.state == RunState::kIdle ||
      record.state == RunState::kArmed)
    return lines_.push_back(Message("console.state", {state}) + " " + Possible(record));
  if (record.state != RunState::kHeld && record.state != RunState::kUnpowered)
    return lines_.push_back(Message("console.state", {state}));
  for (std::size_t i = 0; i < kHands; ++i) {
    const auto& V = record.hands[i].real.twist;
    if (record.hands[i].present &&
        HandleSpeed(Eigen::Map<const Twist>(V.data())) > kStandstillSpeed)
      lines_.push_back(Message("danger.still_moves", {{"SIDE", i == 0 ? "LEFT" : "RIGHT"}}));
  }
  if (record.cause == StopCause::kNone) {
    lines_.push_back(Message("console.finished", {state}));
  } else {
    lines_.push_back(
        Message("console.stopped",
                {state, {"name", Name(record.cause)}, {"cause", StopCauseWords(record)}}));
    if (const std::string more = trouble(); !more.empty()) lines_.push_back("  " + more);
    lines_.push_back("  " + StopAdvice(record));
  }
  lines_.push_back("  " + Possible(record));
}

}  // namespace predictor
