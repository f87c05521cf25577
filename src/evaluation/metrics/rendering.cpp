// Counts the quadratic programs of haptic rendering.
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class Rendering final : public Metric {
 public:
  explicit Rendering(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    failed_ += record.qp_failed;
    relaxed_ += record.qp_relaxed && !record.qp_failed;
    solved_ += record.rendered && !record.qp_failed;
    if (record.rendered) iterations_.Add(record.qp_iterations);
  }

  void AppendTo(std::vector<Result>* results) const override {
    const auto add = [&](const char* key, const char* label, const char* meaning,
                         std::uint64_t count) {
      results->push_back({.path = std::string("qp.") + key,
                          .group = "Rendering",
                          .label = label,
                          .meaning = meaning,
                          .value = count,
                          .shown = solved_ + failed_ > 0});
    };
    add("solved", "solved", "solved quadratic programs, including the relaxed ones", solved_);
    add("relaxed", "of them relaxed",
        "quadratic programs in which a limit gave way to a more important one", relaxed_);
    add("failed", "failed", "quadratic programs without a solution", failed_);
    results->push_back({.path = "qp.iterations",
                        .group = "Rendering",
                        .label = "quadratic programs",
                        .column = "iterations",
                        .meaning = "iterations of the solver per quadratic program",
                        .value = iterations_,
                        .shown = false});
  }

 private:
  std::uint64_t solved_ = 0, relaxed_ = 0, failed_ = 0;
  Statistics iterations_;
};

}  // namespace

const MetricKind kRendering = {.chapter = Chapter::kRendering, .make = MakeMetric<Rendering>};

}  // namespace predictor::metrics
