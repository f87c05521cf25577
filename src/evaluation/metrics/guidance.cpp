// Measures the distance of the object from the guidance path.
#include "evaluation/guidance_distance.h"
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class Guidance final : public Metric {
 public:
  explicit Guidance(const Scenario& scenario) : guidance_(scenario.guidance) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    if (!start_) start_ = record.object.pose.p;
    if (const auto distance = GuidanceDistance(guidance_, record.object.pose.p, *start_))
      distance_.Add(*distance);
  }

  void AppendTo(std::vector<Result>* results) const override {
    results->push_back({.path = "guidance.distance_m",
                        .group = "Guidance",
                        .label = "object",
                        .column = "distance from the path",
                        .unit = units::kMillimetre,
                        .meaning = "distance of the object from the guidance path",
                        .value = distance_});
  }

 private:
  GuidanceSpec guidance_;
  std::optional<std::array<double, 3>> start_;  // position of the object at the start, in W [m]
  Statistics distance_;
};

}  // namespace

const MetricKind kGuidance = {.chapter = Chapter::kTracking, .make = MakeMetric<Guidance>};

}  // namespace predictor::metrics
