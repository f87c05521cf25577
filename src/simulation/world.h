// The virtual world: cobot, object, handles, floor and table, simulated by MuJoCo behind this
// class.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

class World {
 public:
  // Composes the scene, finds the static equilibrium (no hands) and stands there. Throws
  // InputError.
  explicit World(const Scenario& scenario);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // Advances by dt [s] (a whole number of 1 ms sub-steps) under the hands' wrenches and the
  // coupling, both felt anew in each sub-step. On a non-finite or diverged step the state before
  // it is kept and kPhysics returned. No heap, lock or exception.
  Status Step(const WorldInput& input, double dt) noexcept;

  // Changes the controller's stiffness and damping from here on, without a jump of its force. Until
  // Reset. No heap, lock or exception.
  void Tune(const ControllerTuning& tuning) noexcept;

  // After the last Step: poses and twists at state().time; accelerations (A_W), torque and coupling
  // of the last sub-step. A_W is the change of the twist over that sub-step. `energy` is the
  // kinetic energy, the object's potential energy and that of the controller's springs; the
  // cobot's weight, which its controllers carry, is not in it.
  const WorldState& state() const;

  // Back to the equilibrium at the start, time 0.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // Linear model about the present posture, at rest (controller, friction and contacts in it;
  // coupling, hands and Coulomb friction not). x: tangent-space change of the coordinates (nv),
  // then their rates (nv). Allocates.
  LinearModel Linearise() const;

  double object_mass() const;                    // [kg]
  std::vector<std::string> joint_names() const;  // of the cobot
  const JointVector& effort_limit() const;       // of the cobot's joints [N·m]
  std::string SceneXml() const;  // text of the composed scene (MJCF), for inspection

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
