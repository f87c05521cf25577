// Measures the distance between the links of the arms that the program keeps apart.
#include <algorithm>
#include <limits>

#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class LinkDistance final : public Metric {
 public:
  explicit LinkDistance(const Scenario&) {}
  void Add(const TickRecord& record) noexcept override {
    if (record.ran) min_ = std::min(min_, record.link_distance);
  }
  void AppendTo(std::vector<Result>* results) const override {
    results->push_back({.path = "link_distance_m.min",
                        .group = "Nearest link pair",
                        .unit = units::kMetre,
                        .meaning = "smallest distance of the nearest link pair",
                        .value = min_});
  }

 private:
  double min_ = std::numeric_limits<double>::infinity();  // [m]
};

}  // namespace

const MetricKind kLinkDistance = {.chapter = Chapter::kForces, .make = MakeMetric<LinkDistance>};

}  // namespace predictor::metrics
