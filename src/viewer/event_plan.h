// The scenario's events with their triggers, as the experimenter's page shows them. No other page
// may receive an event before it begins.
#pragma once

#include <string>
#include <vector>

#include "evaluation/events.h"
#include "scenario/scenario.h"

namespace predictor::viewer {

class EventPlan {
 public:
  explicit EventPlan(const Scenario& scenario);
  // Follows the next record. If the first record is not from the start of a run, events that have
  // already ended are not known, and the plan is incomplete until the next reset.
  void See(const TickRecord& record);
  // Returns the message `events` (docs/reference/viewer-protocol.md).
  std::string Text() const;

 private:
  std::vector<std::string> triggers_;
  EventLog log_;
  bool seen_ = false, complete_ = true;
  double run_time_ = 0;  // of the last record [s]
};

}  // namespace predictor::viewer
