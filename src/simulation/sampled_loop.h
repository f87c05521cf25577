// Judges the loop of the cobot's controller and the scene as it is simulated: in steps, with the
// controller's period and delay. Linearise describes the same loop in continuous time, where a
// damper is stable however strong it is and however light its joint.
#pragma once

namespace predictor {

class ControlledScene;
class Engine;

struct SampledLoop {
  // Only oscillations above this frequency count [Hz]. Slower ones are swings of the load, which
  // depend on the hands (haptics/stability.h).
  static constexpr double kSlowest = 4;
  static constexpr double kGrowing = 0.1;  // faster growth counts as unstable [1/s]

  // The oscillation that grows fastest, without hands.
  double growth = 0;     // its rate [1/s]; negative: it decays
  double frequency = 0;  // [Hz]
  int joint = 0;         // of the cobot, with the largest share of the kinetic energy
  // What the controller's torque at this joint takes from its own position and velocity.
  double stiffness = 0;  // [N·m/rad], [N/m]
  double damping = 0;    // [N·m·s/rad], [N·s/m]
  // If it is unstable: the largest share of all damping, of all stiffness, or of both, with which
  // the loop is stable, to 20 %. 0: no share suffices.
  double stable_damping = 0, stable_stiffness = 0, stable_both = 0;

  bool is_stable() const { return growth <= kGrowing; }
};

// Judges the loop about the posture of `engine`, as Linearise does. Coulomb friction and effort
// limits are ignored. Changes the state of `engine` and `scene`. Allocates memory.
SampledLoop JudgeSampledLoop(ControlledScene* scene, Engine* engine, double t);

}  // namespace predictor
