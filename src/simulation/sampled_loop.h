// Judges the stability of the loop that the cobot's controller and the scene form in the
// simulation, that is, in steps and with the controller's period and delay. Linearise describes the
// same loop in continuous time, in which every damper is stable, even a strong one at a light
// joint.
#pragma once

namespace predictor {

class ControlledScene;
class Engine;

struct SampledLoop {
  // Only oscillations above this frequency are considered [Hz]. Slower oscillations are swings of
  // the load, which depend on the hands (haptics/stability.h).
  static constexpr double kSlowest = 4;
  static constexpr double kGrowing = 0.1;  // faster growth counts as unstable [1/s]

  // The oscillation of the loop without hands that grows fastest.
  double growth = 0;     // its rate [1/s]; negative: it decays
  double frequency = 0;  // [Hz]
  int joint = 0;         // of the cobot, with the largest share of the kinetic energy
  // The stiffness and the damping with which the controller's torque at this joint depends on the
  // joint's own position and velocity.
  double stiffness = 0;  // [N·m/rad], [N/m]
  double damping = 0;    // [N·m·s/rad], [N·s/m]
  // If the loop is unstable, these are the largest shares of all damping, of all stiffness, and of
  // both together with which the loop is stable, to within 20 %. A value is 0 if the loop is
  // unstable with any share.
  double stable_damping = 0, stable_stiffness = 0, stable_both = 0;

  bool is_stable() const { return growth <= kGrowing; }
};

// Judges the loop about the posture of `engine`, as Linearise does. Coulomb friction and effort
// limits are ignored. Changes the state of `engine` and `scene`. Allocates memory.
SampledLoop JudgeSampledLoop(ControlledScene* scene, Engine* engine, double t);

}  // namespace predictor
