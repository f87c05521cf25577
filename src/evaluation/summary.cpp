#include "evaluation/summary.h"

#include <algorithm>
#include <stdexcept>

namespace predictor {

const Result& Summary::At(std::string_view path) const {
  const auto found = std::find_if(results.begin(), results.end(),
                                  [&](const Result& result) { return result.path == path; });
  if (found == results.end()) throw std::out_of_range("no metric has " + std::string(path));
  return *found;
}

SummaryBuilder::SummaryBuilder(const Scenario& scenario)
    : scenario_(scenario.name), seed_(scenario.seed), stops_(scenario), events_(scenario) {
  for (const MetricKind* kind : Metrics()) metrics_.push_back(kind->make(scenario));
}

void SummaryBuilder::Add(const TickRecord& record) {
  stops_.Add(record);
  events_.Add(record);
  for (const auto& metric : metrics_) metric->Add(record);
}

Summary SummaryBuilder::summary() const {
  Summary summary;
  summary.scenario = scenario_;
  summary.seed = seed_;
  summary.stops = stops_.stops();
  summary.stop_count = stops_.count();
  summary.events = events_.events();
  summary.cobot_stop = events_.cobot_stop();
  for (std::size_t k = 0; k < metrics_.size(); ++k) {
    const std::size_t first = summary.results.size();
    metrics_[k]->AppendTo(&summary.results);
    for (std::size_t r = first; r < summary.results.size(); ++r)
      summary.results[r].chapter = Metrics()[k]->chapter;
  }
  return summary;
}

}  // namespace predictor
