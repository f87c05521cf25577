#include "evaluation/events.h"

#include <algorithm>

#include "core/norm.h"
#include "scenario/own_parameters.h"

namespace predictor {

EventLog::EventLog(const Scenario& scenario) {
  for (const EventSpec& spec : scenario.events) {
    const ParameterKind* kind = FindKind(Hazards(), spec.event);
    EventSummary event;
    event.event = spec.event;
    event.meaning = kind ? kind->doc : spec.event;
    events_.push_back(std::move(event));
  }
}

void EventLog::Add(const TickRecord& record) {
  if (record.run_time < run_time_) {  // after a reset
    for (EventSummary& event : events_) {
      event.begin.reset(), event.end.reset(), event.until_stop.reset();
      event.force = event.torque = event.speed = {};
      event.missed = false;
    }
    cobot_stop_.reset();
  }
  run_time_ = record.run_time;
  for (std::size_t i = 0; i < events_.size(); ++i) Follow(record, i);
  if (!cobot_stop_ && record.cobot_stop > 0 && record.cobot_stop < kCobotStops)
    cobot_stop_ = {static_cast<CobotStop>(record.cobot_stop), run_time_};
}

void EventLog::Follow(const TickRecord& record, std::size_t i) {
  EventSummary& event = events_[i];
  const bool acts = (record.events >> i & 1U) != 0;
  if (acts && !event.begin) {
    event.begin = run_time_;
    constexpr auto kMissed = static_cast<std::uint8_t>(AttachmentState::kMissed);
    event.missed = (event.event == "grasp_object" && record.attachment == kMissed) ||
                   (event.event == "pick_up" && record.held_grip == kMissed);
  }
  if (!event.begin) return;
  if (!acts && !event.end) event.end = run_time_;
  if (!event.until_stop && record.cause != StopCause::kNone)
    event.until_stop = run_time_ - *event.begin;
  if (!record.ran) return;
  for (std::size_t h = 0; h < kHands; ++h) {
    const HandRecord& hand = record.hands[h];
    if (!hand.present) continue;
    event.force[h] = std::max(event.force[h], Norm(hand.wrench.data()));
    event.torque[h] = std::max(event.torque[h], Norm(hand.wrench.data() + 3));
    event.speed[h] = std::max(event.speed[h], Norm(hand.real.twist.data()));
  }
}

}  // namespace predictor
