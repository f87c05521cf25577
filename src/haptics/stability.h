// Stability of the haptic loop: hand → sensor → virtual world → rendering → arm → hand.
//
// The hand's impedance (mass, spring, damper, reflex, sight) acts on the real handle's motion; what
// the sensor reads drives the virtual handles; the arm follows them with its lag and the
// reference's lead. The loop is linearised about a state of the virtual world for both hands and
// all six directions together, delays as all-pass sections (Padé), and judged by its eigenvalues.
#pragma once

#include <Eigen/Core>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

struct StabilityMargin {
  // By which the hands' impedance may grow before the loop becomes unstable; below 1 it is unstable
  // as it is, 0: however soft and light the hands. At most HapticLoop::kLargestGain.
  double gain = 0;
  double frequency = 0;  // of the oscillation at that gain [Hz]
};

// How close to the simulated loop the linear one is.
enum class LoopModel {
  kWithReserve,  // by which leads are chosen: quick, and 1.5 ticks later than the simulated one,
                 // since a real device may be
  kExact,        // as it is simulated, for oscillations up to about 30 Hz
};
struct LoopDelays;

class HapticLoop {
 public:
  static constexpr double kLargestGain = 8;

  // `world`: linear model with the hands off. dt: tick [s].
  HapticLoop(const LinearModel& world, const Scenario& scenario, double dt,
             LoopModel model = LoopModel::kWithReserve);

  // Largest real part [1/s] of the loop's eigenvalues with the hands' impedance times `gain` and
  // the reference's lead [s]: the rate at which a disturbance grows. `frequency` [Hz] of that mode.
  double GrowthRate(const HandSpec& hand, double lead, double gain,
                    double* frequency = nullptr) const;

  // Margin for a hand and a lead [s], to 2 %.
  StabilityMargin Margin(const HandSpec& hand, double lead) const;

  // Lag of an arm's velocity loop at low frequency [s]: 2ζ/ω plus delay, less the half tick by
  // which the reference is ahead.
  static double Lag(const VelocityLoopSpec& loop, double dt);

 private:
  bool IsStable(const HandSpec& hand, double lead, double gain, StabilityMargin* margin) const;

  LinearModel world_;
  const Scenario& scenario_;
  double dt_;  // [s]
  const LoopDelays& delays_;
};

// The scenario's lead, or what its `auto` stands for: the longest of six steps from the device's
// lag down to none whose margin is at least `margin`; the one of the largest margin if none is.
struct LeadChoice {
  double lead = 0;  // [s]
  StabilityMargin margin;
  double lag = 0;  // of the device [s]
};
LeadChoice ChooseLead(const HapticLoop& loop, const Scenario& scenario, double dt,
                      double margin = 2.0);

}  // namespace predictor
