// Measures simulated time.
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class Duration final : public Metric {
 public:
  explicit Duration(const Scenario& scenario) : dt_(1 / scenario.rate) {}
  void Add(const TickRecord& record) noexcept override { ticks_ += record.ran != 0; }
  void AppendTo(std::vector<Result>* results) const override {
    results->push_back({.path = "duration_s",
                        .group = "Duration",
                        .unit = units::kSecond,
                        .meaning = "simulated time in RUN",
                        .value = static_cast<double>(ticks_) * dt_,
                        .shown = false});
    results->push_back({.path = "ticks",
                        .group = "Ticks",
                        .meaning = "number of ticks in RUN",
                        .value = ticks_,
                        .shown = false,
                        .compared = false});
  }

 private:
  double dt_;  // [s]
  std::uint64_t ticks_ = 0;
};

}  // namespace

const MetricKind kDuration = {.make = MakeMetric<Duration>};

}  // namespace predictor::metrics
