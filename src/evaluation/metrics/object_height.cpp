// Measures the height of the object.
#include <algorithm>
#include <cmath>

#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class ObjectHeight final : public Metric {
 public:
  explicit ObjectHeight(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    final_ = record.object.pose.p[2];
    if (std::isnan(initial_)) initial_ = min_ = max_ = final_;
    min_ = std::min(min_, final_);
    max_ = std::max(max_, final_);
  }

  void AppendTo(std::vector<Result>* results) const override {
    const auto add = [&](const char* key, const char* label, double value) {
      results->push_back({.path = std::string("object.height_m.") + key,
                          .group = "Height of the object",
                          .label = label,
                          .unit = units::kMetre,
                          .meaning = std::string("height of the object's origin in W: ") + label,
                          .value = value,
                          .compared = false});
    };
    add("initial", "at the start", initial_);
    add("min", "lowest", min_);
    add("max", "highest", max_);
    add("final", "at the end", final_);
    results->push_back({.path = "object.lift_m",
                        .group = "Object lifted by",
                        .unit = units::kMillimetre,
                        .meaning = "largest height of the object above its start",
                        .value = max_ - initial_,
                        .shown = false});
  }

 private:
  double initial_ = NAN, min_ = NAN, max_ = NAN, final_ = NAN;  // [m]
};

}  // namespace

const MetricKind kObjectHeight = {.make = MakeMetric<ObjectHeight>};

}  // namespace predictor::metrics
