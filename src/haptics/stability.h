// Stability of the haptic loop: hand → sensor → virtual world → rendering → arm → hand.
//
// The hand's impedance (mass, spring, damper, reflex, sight) acts on the real handle's motion; what
// the sensor reads drives the virtual handles through their admittance; the arm follows them with
// its lag and the reference's lead. The loop is linearised about a state of the virtual world for
// both hands and all six directions together, and judged by its eigenvalue loci (generalised
// Nyquist criterion; MacFarlane & Postlethwaite 1977).
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

struct StabilityMargin {
  double gain = 0;       // by which the hands' impedance may grow before the loop becomes unstable
  double frequency = 0;  // of the oscillation that would then begin [Hz]; 0 if none was found
};

class HapticLoop {
 public:
  // `world`: linear model with the hands off. dt: tick [s].
  HapticLoop(const LinearModel& world, const Scenario& scenario, double dt);

  // Margin for a hand and a lead of the reference [s]. "gain" is capped at 1000.
  StabilityMargin Margin(const HandSpec& hand, double lead) const;

  // Lag of an arm's velocity loop at low frequency [s]: 2ζ/ω plus delay, less the half tick by which
  // the reference is ahead.
  static double Lag(const VelocityLoopSpec& loop, double dt);

 private:
  using Complex = std::complex<double>;
  std::array<Complex, 12> HandAndDevice(const HandSpec& hand, double lead, double omega) const;

  const Scenario& scenario_;
  double dt_;
  std::vector<double> omega_;                // [rad/s]
  std::vector<Eigen::MatrixXcd> admittance_;  // 12 × 12 of the virtual handles at each frequency
};

// The lead that `auto` stands for: the longest of six steps from the device's lag down to none whose
// margin is at least `margin`; the best of them if none is.
struct LeadChoice {
  double lead = 0;  // [s]
  StabilityMargin margin;
  double lag = 0;   // of the device [s]
};
LeadChoice ChooseLead(const HapticLoop& loop, const Scenario& scenario, double dt, double margin = 2.0);

}  // namespace predictor
