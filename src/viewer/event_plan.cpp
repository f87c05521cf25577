#include "viewer/event_plan.h"

#include "scenario/event_words.h"
#include "viewer/protocol.h"

namespace predictor::viewer {
namespace {

Json TimeOrNull(const std::optional<double>& time) { return time ? Json(*time) : Json(nullptr); }

}  // namespace

EventPlan::EventPlan(const Scenario& scenario) : log_(scenario) {
  for (const EventSpec& event : scenario.events) triggers_.push_back(TriggerWords(event.trigger));
}

void EventPlan::See(const TickRecord& record) {
  if (!seen_) complete_ = record.run_time == 0;
  if (record.run_time < run_time_) complete_ = true;  // after a reset
  seen_ = true;
  run_time_ = record.run_time;
  log_.Add(record);
}

std::string EventPlan::Text() const {
  Json events = Json::array();
  for (std::size_t i = 0; i < triggers_.size(); ++i) {
    const EventSummary& event = log_.events()[i];
    events.push_back({{"event", event.event},
                      {"meaning", event.meaning},
                      {"trigger", triggers_[i]},
                      {"begin", TimeOrNull(event.begin)},
                      {"end", TimeOrNull(event.end)}});
  }
  return Json{{"type", "events"}, {"complete", complete_}, {"events", events}}.dump();
}

}  // namespace predictor::viewer
