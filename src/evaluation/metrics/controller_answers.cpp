// Counts the late answers of a controller that runs as a process.
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class ControllerAnswers final : public Metric {
 public:
  explicit ControllerAnswers(const Scenario& s)
      : is_process_(s.cobot.controller.type == "process") {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran || !is_process_) return;
    ++ticks_;
    late_ += record.controller == static_cast<std::uint8_t>(ControllerOutcome::kFellBack);
  }

  void AppendTo(std::vector<Result>* results) const override {
    results->push_back({.path = "controller.late",
                        .group = "Controller",
                        .label = "of " + std::to_string(ticks_) + " answers late",
                        .meaning = "ticks in which gravity compensation and damping acted, because "
                                   "the answer of the controller's process was late",
                        .value = late_,
                        .shown = late_ > 0});
    results->push_back({.path = "controller.ticks",
                        .group = "Controller",
                        .label = "ticks",
                        .meaning = "ticks with a controller that runs as a process",
                        .value = ticks_,
                        .shown = false,
                        .compared = false});
  }

 private:
  bool is_process_;
  std::uint64_t ticks_ = 0, late_ = 0;
};

}  // namespace

const MetricKind kControllerAnswers = {.chapter = Chapter::kTiming,
                                       .make = MakeMetric<ControllerAnswers>};

}  // namespace predictor::metrics
