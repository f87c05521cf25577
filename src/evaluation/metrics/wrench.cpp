// Measures the forces and torques of the hands.
#include "evaluation/metrics/registry.h"

namespace predictor::metrics {
namespace {

class Wrench final : public Metric {
 public:
  explicit Wrench(const Scenario&) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    for (std::size_t i = 0; i < kHands; ++i) {
      const HandRecord& hand = record.hands[i];
      if (!hand.present) continue;
      force_[i].Add(Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]).norm());
      torque_[i].Add(Vector3(hand.wrench[3], hand.wrench[4], hand.wrench[5]).norm());
    }
  }

  void AppendTo(std::vector<Result>* results) const override {
    const auto add = [&](std::size_t i, const std::string& quantity, const char* key,
                         const Unit& unit, const Statistics& values) {
      const std::string hand = kHandNames[i];
      results->push_back({.path = "wrench." + hand + "." + key,
                          .group = "Hands, whole run",
                          .label = hand + " hand",
                          .column = quantity,
                          .unit = unit,
                          .meaning = quantity + " of the hand on its handle",
                          .value = values});
    };
    for (std::size_t i = 0; i < kHands; ++i) {
      add(i, "force", "force_n", units::kNewton, force_[i]);
      add(i, "torque", "torque_nm", units::kNewtonMetre, torque_[i]);
    }
  }

 private:
  std::array<Statistics, kHands> force_, torque_;
};

}  // namespace

const MetricKind kWrench = {.chapter = Chapter::kForces, .make = MakeMetric<Wrench>};

}  // namespace predictor::metrics
