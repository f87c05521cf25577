// Measures how far the movable objects were moved.
#include <algorithm>
#include <array>
#include <cmath>

#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class MovableObjects final : public Metric {
 public:
  explicit MovableObjects(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    const std::size_t count = std::min<std::size_t>(record.movable_count, kMaxMovables);
    for (std::size_t i = count_; i < count; ++i) start_[i] = record.movables[i].p;
    for (std::size_t i = 0; i < count; ++i) end_[i] = record.movables[i].p;
    count_ = std::max(count_, count);
  }

  void AppendTo(std::vector<Result>* results) const override {
    double farthest = NAN;
    for (std::size_t i = 0; i < count_; ++i)
      farthest =
          std::fmax(farthest, std::hypot(end_[i][0] - start_[i][0], end_[i][1] - start_[i][1],
                                         end_[i][2] - start_[i][2]));
    results->push_back({.path = "movables.moved_m",
                        .group = "Movable object moved",
                        .unit = units::kMetre,
                        .meaning = "distance between the start and the end of the movable object "
                                   "that was moved farthest; null: there are no movable objects",
                        .value = farthest,
                        .compared = false});
  }

 private:
  std::array<std::array<double, 3>, kMaxMovables> start_ = {}, end_ = {};  // in W [m]
  std::size_t count_ = 0;
};

}  // namespace

const MetricKind kMovableObjects = {.make = MakeMetric<MovableObjects>};

}  // namespace predictor::metrics
