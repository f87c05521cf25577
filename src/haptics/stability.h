// Computes the stability of the haptic loop: hand → sensor → virtual world → rendering → arm →
// hand.
//
// The hand's impedance (mass, spring, damper, reflex, sight) acts on the motion of the real handle.
// The sensor's reading drives the virtual handles. The arm follows the virtual handles with its lag
// and with the lead of the reference. The loop is linearised about a state of the virtual world.
// The linear model includes both hands and all six directions. Delays are modelled as all-pass
// sections (Padé). The eigenvalues decide stability.
#pragma once

#include <Eigen/Core>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

struct StabilityMargin {
  // The factor by which the hands' impedance may grow before the loop becomes unstable. If the
  // factor is below 1, the loop is unstable with the nominal impedance. If the factor is 0, the
  // loop is unstable even if the hands are soft and light. The factor is at most
  // HapticLoop::kLargestGain.
  double gain = 0;
  double frequency = 0;  // frequency of the oscillation at that gain [Hz]
};

// The delays of the linear model.
enum class LoopModel {
  kWithReserve,  // used to choose leads: quick, with 1.5 ticks more delay than the simulation,
                 // because a real device may be later
  kExact,        // same delays as the simulation, valid for oscillations up to about 30 Hz
};
struct LoopDelays;

class HapticLoop {
 public:
  static constexpr double kLargestGain = 8;
  static constexpr double kGrowing = 1e-4;  // a mode that grows faster counts as unstable [1/s]

  // `world` is the linear model of the virtual world without hands. `dt` is the duration of a tick
  // [s].
  HapticLoop(const LinearModel& world, const Scenario& scenario, double dt,
             LoopModel model = LoopModel::kWithReserve);

  // Returns the largest real part [1/s] of the loop's eigenvalues. The hands' impedance is
  // multiplied by `gain`, and the reference has the given lead [s]. This value is the growth rate
  // of a disturbance. `frequency` is the frequency of the fastest growing mode [Hz].
  double GrowthRate(const HandSpec& hand, double lead, double gain,
                    double* frequency = nullptr) const;

  // Returns the stability margin for a hand and a lead [s], with a precision of 2 %.
  StabilityMargin Margin(const HandSpec& hand, double lead) const;

  // Returns the lag of an arm's velocity loop at low frequency [s]. The lag is 2ζ/ω plus the delay
  // minus half a tick, because the reference is half a tick ahead.
  static double Lag(const VelocityLoopSpec& loop, double dt);

  // Returns the cutoff of the filter of the lead's acceleration [rad/s]. Without a filter, the
  // acceleration is computed from the change over one tick and is therefore delayed by half a tick.
  static double LeadCutoff(const RenderingSpec& rendering, double dt);

 private:
  bool IsStable(const HandSpec& hand, double lead, double gain, StabilityMargin* margin) const;

  LinearModel world_;
  const Scenario& scenario_;
  double dt_;  // [s]
  const LoopDelays& delays_;
};

// The scenario's lead. For `auto`, six values of the lead are tried, from the device's lag down to
// zero. The lead is the longest value for which the stability margin is at least `margin`. If no
// value has this margin, the lead is the value with the largest margin.
struct LeadChoice {
  double lead = 0;  // [s]
  StabilityMargin margin;
  double lag = 0;  // lag of the device [s]
};
LeadChoice ChooseLead(const HapticLoop& loop, const Scenario& scenario, double dt,
                      double margin = 2.0);

}  // namespace predictor
