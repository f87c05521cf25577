#include "recording/run_events.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/format.h"
#include "core/words.h"

namespace predictor::recording {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;  // [ns]
constexpr int kMaxParameters = 20;                // maximum number of parameter events per second

std::string CauseText(const Status& s) {
  std::string text = Name(s.cause);
  if (s.hand >= 0 && s.hand < kHands) text += std::string(", ") + HandName(s.hand) + " hand";
  if (const std::string measured = MeasuredWords(s); !measured.empty()) text += ": " + measured;
  return text;
}

std::string StopText(const TickRecord& r) {
  return "stop: " +
         CauseText({r.cause, r.cause_hand, r.cause_value, r.cause_limit, r.cause_quantity});
}

}  // namespace

std::vector<RecordingEvent> RunEvents::Follow(const TickRecord& record, std::uint64_t unix_ns) {
  events_.clear();
  if (!began_) {
    began_ = true;
    state_ = record.state;
    hazards_ = record.events;
    cobot_stop_ = record.cobot_stop;
    attachment_ = record.attachment;
    second_ns_ = unix_ns;
  }
  if (unix_ns - second_ns_ >= kSecond) NewSecond(record, unix_ns);
  FollowRun(record);
  FollowWarnings(record);
  FollowHazards(record);
  FollowParameters(record);
  return std::exchange(events_, {});
}

void RunEvents::NewSecond(const TickRecord& record, std::uint64_t unix_ns) {
  second_ns_ = unix_ns;
  logged_ = 0;
  if (left_out_ == 0) return;
  const std::string count = std::to_string(std::exchange(left_out_, 0));
  Log(record, "omitted", count + " events before this one were omitted", kMaxPerSecond);
}

// The event that describes a cause precedes the event that describes the resulting state.
void RunEvents::FollowRun(const TickRecord& record) {
  if (record.cause != cause_) {
    if (record.cause != StopCause::kNone)
      Log(record, "stop", StopText(record), kMaxPerSecond);
    else
      Log(record, "reset", "reset", kMaxPerSecond);
  }
  if (record.harder.cause != StopCause::kNone && harder_ == StopCause::kNone)
    Log(record, "stop", "power off: " + CauseText(FromRecord(record.harder)), kMaxPerSecond);
  harder_ = record.harder.cause;
  if (record.state != state_)
    Log(record, "state", std::string("state ") + Name(record.state), kMaxPerSecond);
  cause_ = record.cause;
  state_ = record.state;
}

void RunEvents::FollowWarnings(const TickRecord& record) {
  const auto warn = [&](std::string words) {
    Log(record, "warning", std::move(words), kMaxPerSecond);
  };
  const bool late = record.controller == static_cast<std::uint8_t>(ControllerOutcome::kFellBack);
  if (late && !controller_late_)
    warn("The cobot's controller missed its deadline: gravity compensation and damping act");
  controller_late_ = late;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    const HandRecord& now = record.hands[hand];
    for (std::string& words : NewWarnings(warnings_[hand], now, hand)) warn(std::move(words));
    warnings_[hand] = now.warnings;
  }
}

void RunEvents::FollowHazards(const TickRecord& record) {
  const unsigned changed = record.events ^ std::exchange(hazards_, record.events);
  for (unsigned i = 0; i < kMaxEvents; ++i)
    if ((changed >> i & 1U) != 0)
      Log(record, "hazard",
          "events." + std::to_string(i) + ((record.events >> i & 1U) != 0 ? " begins" : " ends"),
          kMaxPerSecond);
  constexpr auto kMissed = static_cast<std::uint8_t>(AttachmentState::kMissed);
  if (std::exchange(attachment_, record.attachment) != kMissed && record.attachment == kMissed)
    Log(record, "hazard", "the cobot's gripper stays open: the object is too far away",
        kMaxPerSecond);
  const std::uint8_t before = std::exchange(cobot_stop_, record.cobot_stop);
  if (record.cobot_stop != before && record.cobot_stop > 0 && record.cobot_stop < kCobotStops)
    Log(record, "hazard",
        "the cobot stops itself: " + CobotStopWords(static_cast<CobotStop>(record.cobot_stop)),
        kMaxPerSecond);
}

void RunEvents::FollowParameters(const TickRecord& record) {
  const int count = std::min<int>(record.input_count, kInputsPerTick);
  for (int k = 0; k < count; ++k) {
    const RunInput& input = record.inputs[static_cast<std::size_t>(k)];
    if (input.kind != InputKind::kParameter || static_cast<int>(input.parameter) >= kParameters)
      continue;
    Log(record, "parameter", Formatted("%s set to %.4g", Name(input.parameter), input.value),
        kMaxParameters);
  }
}

void RunEvents::Log(const TickRecord& record, const char* kind, std::string text, int most) {
  if (logged_ >= most) {
    ++left_out_;
    return;
  }
  ++logged_;
  events_.push_back({record.tick, 0, kind, std::move(text), 0});
}

}  // namespace predictor::recording
