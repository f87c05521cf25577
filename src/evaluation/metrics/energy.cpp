// Measures the energy that the hands exchange with the real handles in RUN and STOPPING.
#include <cstdint>

#include "evaluation/metrics/registry.h"
#include "evaluation/port_energy.h"

namespace predictor::metrics {
namespace {

class Energy final : public Metric {
 public:
  explicit Energy(const Scenario& scenario) : dt_(1 / scenario.rate) {}

  void Add(const TickRecord& record) noexcept override {
    ran_ = ran_ || record.ran;
    if (!ran_ || !(record.ran || record.state == RunState::kStopping)) return;
    double power = 0;  // [W]
    for (const HandRecord& hand : record.hands)
      if (hand.present) power += Power(hand.wrench, hand.real.twist);
    hands_.Add(power, dt_);
  }

  void AppendTo(std::vector<Result>* results) const override {
    const auto add = [&](const char* key, const char* label, const Unit& unit, const char* meaning,
                         const ResultValue& value, bool compared) {
      results->push_back({.path = std::string("energy.") + key,
                          .group = "Energy of the hands",
                          .label = label,
                          .unit = unit,
                          .meaning = meaning,
                          .value = value,
                          .shown = false,
                          .compared = compared});
    };
    add("supplied_j", "supplied", kJoule,
        "energy that the hands supplied to the real handles in RUN and while stopping, minus what "
        "they received",
        hands_.sum, true);
    add("lowest_j", "lowest balance", kJoule, "lowest value of the supplied energy during the run",
        hands_.lowest, false);
    add("episodes", "times below −0.05 J", units::kNone,
        "how often the supplied energy fell below −0.05 J",
        static_cast<std::uint64_t>(hands_.episodes), false);
    add("returned_j", "returned", kJoule, "energy that the hands received", hands_.returned, true);
    add("peak_return_w", "largest power received", kWatt, "largest power that the hands received",
        hands_.peak_return, false);
  }

 private:
  static constexpr Unit kJoule = {"J", "J", 1, 3}, kWatt = {"W", "W", 1, 3};

  double dt_;  // [s]
  bool ran_ = false;
  PortEnergy hands_;
};

}  // namespace

const MetricKind kEnergy = {.make = MakeMetric<Energy>};

}  // namespace predictor::metrics
