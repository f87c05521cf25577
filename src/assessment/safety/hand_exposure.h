// Measures what the hands felt during a run: forces, rates of force, energy and oscillation. The
// measures use only the records, so the person need not be known.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/filters.h"
#include "evaluation/metric.h"
#include "evaluation/port_energy.h"
#include "safety/oscillation.h"

namespace predictor::assessment {

// Collects the records of a run. Forces are evaluated in RUN. Energies are evaluated in RUN and
// while the arms are stopping.
class HandExposure {
 public:
  static constexpr double kCutoff = 20;      // cut-off for the low-passed force and its rate [Hz]
  static constexpr double kHighShare = 0.5;  // share of the stop's threshold above which a force
                                             // counts as "high"

  explicit HandExposure(const Scenario& scenario);
  // Adds the next record, in order.
  void Add(const TickRecord& record);
  // Returns the results for the records so far: first the results of each existing hand, and then
  // the results for both hands together. The meaning of each result states its filter and rate.
  std::vector<Result> results() const;

 private:
  struct Hand {
    bool present = false;
    LowPass<Vector3> low_pass;
    bool started = false;           // whether the filter has a value
    double peak = 0;                // largest force, sampled at each tick [N]
    double smooth_peak = 0;         // largest low-passed force [N]
    double peak_torque = 0;         // [N·m]
    double rate = 0;                // largest |dF/dt| of the low-passed force [N/s]
    double impulse = 0;             // ∫ |F| dt [N·s]
    double high_time = 0;           // time with a force above high_ [s]
    Vector3 sum = Vector3::Zero();  // sum of the forces in the current averaging interval [N]
    std::size_t count = 0;
    std::vector<double> means;  // magnitudes of the mean forces [N]
    OscillationDetector growing;
    int growing_cycles = 0;        // cycles that complete a series of growing cycles
    double growing_amplitude = 0;  // largest amplitude of these cycles [N]
    PortEnergy device, scene;      // energy at the real handle; at the virtual handle
  };

  void AddForce(const HandRecord& record, Hand* hand) const;
  void AppendHand(std::size_t i, std::vector<Result>* results) const;

  double dt_, high_;          // [s], [N]
  std::size_t ticks_a_mean_;  // averaging interval for the percentiles: as long as a sample
  bool ran_ = false;
  std::array<Hand, kHands> hands_;
  std::vector<std::unique_ptr<Metric>> metrics_;  // metrics of the summary
};

}  // namespace predictor::assessment
