// Measures the oscillation of the hands' forces from 3 to 10 Hz.
#include <algorithm>
#include <cmath>

#include "evaluation/metrics/registry.h"
#include "evaluation/oscillation_index.h"

namespace predictor::metrics {
namespace {

class Oscillation final : public Metric {
 public:
  explicit Oscillation(const Scenario& scenario)
      : hands_{Hand(1 / scenario.rate), Hand(1 / scenario.rate)} {}

  void Add(const TickRecord& record) noexcept override {
    const bool follows = record.tick == tick_ + 1;
    tick_ = record.tick;
    for (std::size_t i = 0; i < kHands; ++i) {
      if (!follows) hands_[i].force.Break();
      if (record.hands[i].present) hands_[i].Add(record, record.hands[i]);
    }
  }

  void AppendTo(std::vector<Result>* results) const override {
    for (std::size_t i = 0; i < kHands; ++i) {
      const std::string hand = kHandNames[i];
      const auto add = [&](const char* key, const std::string& label, const Unit& unit,
                           const std::string& meaning, double value, bool compared) {
        results->push_back(
            {.path = "oscillation." + hand + "." + key,
             .group = "Oscillation",
             .label = std::string(label).append(" of the ").append(hand).append(" hand"),
             .unit = unit,
             .meaning = meaning,
             .value = value,
             .shown = false,
             .compared = compared});
      };
      const Hand& of = hands_[i];
      add("index", "largest index", kIndex,
          "largest share of the power from 3 to 10 Hz in the force's power up to 10 Hz, in windows "
          "of 4 s in which the force varied by more than 1 N rms",
          of.index, true);
      add("strong_index", "largest index above 3 N", kIndex,
          "largest index in windows in which the force varied by more than 3 N rms",
          of.strong_index, false);
      add("rms_n", "largest rms from 3 to 10 Hz", units::kNewton,
          "largest rms of the force from 3 to 10 Hz, in windows of 4 s", of.rms, true);
    }
  }

 private:
  static constexpr Unit kIndex = {"", "", 1, 2};

  struct Hand {
    explicit Hand(double dt) : force(dt) {}
    void Add(const TickRecord& record, const HandRecord& hand) noexcept {
      if (!record.ran) return force.Break();
      const auto* window =
          force.Add(record.run_time, Vector3(hand.wrench[0], hand.wrench[1], hand.wrench[2]));
      if (!window) return;
      rms = std::fmax(rms, window->rms);
      if (window->IsMeaningful()) index = std::fmax(index, window->index);
      if (window->IsStrong()) strong_index = std::fmax(strong_index, window->index);
    }
    OscillationIndex force;
    double index = NAN, strong_index = NAN, rms = NAN;  // rms: [N]
  };

  std::array<Hand, kHands> hands_;
  std::uint64_t tick_ = 0;  // tick of the last record
};

}  // namespace

const MetricKind kOscillation = {.chapter = Chapter::kForces, .make = MakeMetric<Oscillation>};

}  // namespace predictor::metrics
