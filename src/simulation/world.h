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
  // Composes the scene and moves it to its static equilibrium without hands. Throws InputError.
  explicit World(const Scenario& scenario);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // Advances by dt [s] (a whole number of 1 ms sub-steps) under the hands' wrenches and the
  // coupling, both updated in each sub-step. If a step is non-finite or diverges, keeps the
  // previous state and returns kPhysics. Uses no heap or lock; does not throw.
  Status Step(const WorldInput& input, double dt) noexcept;

  // Changes the controller's stiffness and damping until Reset, without a jump of its force. Uses
  // no heap or lock; does not throw.
  void Tune(const ControllerTuning& tuning) noexcept;

  // Only a controller outside the program does something here. SetRealTime: whether it has a
  // deadline. Play: what it answered in the tick that follows, in a replay without it. Tape: what
  // it answered while this world was set up; empty for another controller.
  void SetRealTime(bool real_time) noexcept;
  void Play(const ControllerAnswer& answer) noexcept;
  std::vector<double> ControllerTape() const;

  // State after the last Step: poses and twists at state().time; accelerations (A_W), torque and
  // coupling of the last sub-step. A_W is the change of the twist over that sub-step. `energy` is
  // the sum of the kinetic energy, the object's potential energy, and the energy of the
  // controller's springs. It excludes the cobot's weight, which its controllers compensate.
  const WorldState& state() const;

  // Returns to the initial equilibrium at time 0.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // Linear model about the present posture, at rest. Includes the controller, joint friction and
  // contacts, but not the coupling, hands and Coulomb friction. x: tangent-space change of the
  // coordinates (nv), then their rates (nv). Allocates memory.
  LinearModel Linearise() const;

  double object_mass() const;                    // [kg]
  std::vector<std::string> joint_names() const;  // of the cobot's joints
  const JointVector& effort_limit() const;       // of the cobot's joints [N·m]
  std::string SceneXml() const;  // text of the composed scene (MJCF), for inspection

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
