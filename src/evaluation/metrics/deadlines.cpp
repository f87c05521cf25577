// Counts the deadlines that the control loop missed.
#include <algorithm>

#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class Deadlines final : public Metric {
 public:
  explicit Deadlines(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    late_ += record.missed > 0;
    most_ = std::max<std::uint64_t>(most_, record.missed);
  }

  void AppendTo(std::vector<Result>* results) const override {
    results->push_back({.path = "deadlines.late_ticks",
                        .group = "Ticks after a missed deadline",
                        .meaning = "recorded ticks before which a deadline was missed",
                        .value = late_,
                        .shown = false});
    results->push_back({.path = "deadlines.most_in_a_row",
                        .group = "Deadlines missed in a row",
                        .meaning = "largest number of deadlines missed in a row",
                        .value = most_,
                        .shown = false,
                        .compared = false});
  }

 private:
  std::uint64_t late_ = 0, most_ = 0;
};

}  // namespace

const MetricKind kDeadlines = {.chapter = Chapter::kTiming, .make = MakeMetric<Deadlines>};

}  // namespace predictor::metrics
