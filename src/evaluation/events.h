// Finds the events of a scenario in the records of a run, and measures what the hands felt after
// each event.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

struct EventSummary {
  std::string event;            // name of the hazard
  std::string meaning;          // description of the hazard
  std::optional<double> begin;  // run time at which it began [s]; empty: it did not begin
  std::optional<double> end;    // run time at which it ended [s]
  // The largest values of a hand from the beginning of the event to the end of RUN.
  std::array<double, kHands> force = {}, torque = {}, speed = {};  // [N], [N·m], [m/s]
  bool missed = false;               // the object was too far away to be grasped
  std::optional<double> until_stop;  // time from the beginning of the event to the emulator's next
                                     // stop [s]
};

struct CobotStopSummary {
  CobotStop reason;
  double time;  // run time [s]
};

// Collects the events of the run since its last reset. The function Add does not use the heap.
class EventLog {
 public:
  explicit EventLog(const Scenario& scenario);
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns the events in the order of the scenario.
  const std::vector<EventSummary>& events() const { return events_; }
  // Returns the first protective stop of the virtual cobot itself.
  const std::optional<CobotStopSummary>& cobot_stop() const { return cobot_stop_; }

 private:
  void Follow(const TickRecord& record, std::size_t i);

  std::vector<EventSummary> events_;
  std::optional<CobotStopSummary> cobot_stop_;
  double run_time_ = 0;  // run time of the last record [s]
};

}  // namespace predictor
