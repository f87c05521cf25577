// The summary of a run contains the results of its metrics and its stops. The summary is computed
// only from the TickRecords of the run.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/predicted_loop.h"
#include "core/record.h"
#include "evaluation/events.h"
#include "evaluation/metric.h"
#include "evaluation/stops.h"
#include "scenario/scenario.h"

namespace predictor {

struct Summary {
  std::string scenario;
  std::uint64_t seed = 0;
  std::vector<Result> results;  // results of all metrics
  std::vector<StopSummary> stops;
  std::uint64_t stop_count = 0;      // may exceed the number of kept stops
  std::vector<EventSummary> events;  // events in the order of the scenario
  std::optional<CobotStopSummary> cobot_stop;

  // The caller must set the following values.
  double real_time_factor = 0;
  bool by_the_clock = false;  // the run was paced by the clock, so its real-time factor does not
                              // show the computer's speed
  std::optional<PredictedLoop> loop;  // empty in mode `direct` or if the recording does not contain
                                      // it
  std::uint64_t overruns = 0, records_dropped = 0;

  // Returns the result with this path. The result must exist.
  const Result& At(std::string_view path) const;
  template <class T>
  const T& Get(std::string_view path) const {
    return std::get<T>(At(path).value);
  }
  double duration() const { return Get<double>("duration_s"); }        // simulated [s]
  std::uint64_t ticks() const { return Get<std::uint64_t>("ticks"); }  // number of ticks in RUN
};

// Builds a summary from records, in order. The statistics include every tick in which simulated
// time passed. They also include the tick in which a stop was decided, and the value that caused
// the stop.
class SummaryBuilder {
 public:
  explicit SummaryBuilder(const Scenario& scenario);
  void Add(const TickRecord& record);
  Summary summary() const;  // summary of the records added so far
  const StopLog& stops() const { return stops_; }

 private:
  std::string scenario_;
  std::uint64_t seed_;
  std::vector<std::unique_ptr<Metric>> metrics_;  // metrics in the order of Metrics()
  StopLog stops_;
  EventLog events_;
};

// Returns the summary as JSON for scripts. Scripts depend on this format. `timing` states whether
// to include the values that depend on the computer's speed.
std::string SummaryJson(const Summary& summary, bool timing = true);

// Returns the JSON Schema of SummaryJson.
std::string SummarySchema();

// Returns the summary as text for the user, with tables in mm, degrees and N.
std::string SummaryTable(const Summary& summary);

// Describes the lead, the stability margin and the predicted loop in a sentence.
std::string LoopWords(const PredictedLoop& loop);

}  // namespace predictor
