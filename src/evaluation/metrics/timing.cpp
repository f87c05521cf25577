// Measures the computing time of the stages of a tick.
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class Timing final : public Metric {
 public:
  explicit Timing(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    for (std::size_t k = 0; record.ran && k < kStages; ++k) times_[k].Add(record.stage_us[k]);
  }

  void AppendTo(std::vector<Result>* results) const override {
    for (std::size_t k = 0; k < kStages; ++k) {
      const bool whole = static_cast<Stage>(k) == Stage::kTick;
      results->push_back(
          {.path = std::string("timing_us.") + kStageNames[k],
           .group = "Time per tick",
           .label = kStageNames[k],
           .unit = units::kMicrosecond,
           .meaning = whole ? std::string("computing time of a tick")
                            : std::string("computing time of the stage ") + kStageNames[k],
           .value = QuantilesOf(times_[k]),
           .compared = whole});
    }
  }

 private:
  std::array<Histogram, kStages> times_;  // [µs]
};

}  // namespace

const MetricKind kTiming = {.chapter = Chapter::kTiming, .make = MakeMetric<Timing>};

}  // namespace predictor::metrics
