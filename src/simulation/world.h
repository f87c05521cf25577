// The virtual world, with the cobot, the object, the handles, the floor and the table. The physics
// engine behind this class simulates it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"
#include "simulation/contact_pair.h"
#include "simulation/sampled_loop.h"

namespace predictor {

// The upward forces that carry the object at rest in addition to the cobot's force [N], and the
// bodies that the object touches.
struct ObjectSupport {
  double floor = 0;  // of the virtual floor
  double other = 0;  // of the table and of fixtures
  bool touches_floor = false, touches_table = false;
  std::uint64_t fixtures = 0;  // that the object touches: bit = number
};

class World {
 public:
  // Composes the scene and moves the scene to its static equilibrium without hands. Throws
  // InputError.
  explicit World(const Scenario& scenario);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // Advances by dt [s] (a whole number of 1 ms sub-steps) under the hands' wrenches and the
  // coupling, which are updated in each sub-step. If the result of a step is not finite or
  // diverges, keeps the previous state and returns kPhysics. Does not use the heap or a lock, and
  // does not throw.
  Status Step(const WorldInput& input, double dt) noexcept;

  // Changes the controller's stiffness and damping until Reset, without a jump of the controller's
  // force. Does not use the heap or a lock, and does not throw.
  void Tune(const ControllerTuning& tuning) noexcept;

  // The following functions have an effect only for a controller outside the program. SetRealTime
  // determines whether the controller has a deadline. In a replay without the controller, Play
  // supplies the controller's answer for the next tick. Tape returns the answers that the
  // controller gave while this world was set up, or nothing for a controller inside the program.
  // PrioritiseProcess calls the function with the same name of Controller, and must not be called
  // in a tick.
  void SetRealTime(bool real_time) noexcept;
  std::string PrioritiseProcess(bool on);
  void Play(const ControllerAnswer& answer) noexcept;
  std::vector<double> ControllerTape() const;

  // Returns the state after the last Step. The poses and twists are those at state().time. The
  // accelerations (A_W), the torque and the coupling are those of the last sub-step. A_W is the
  // change of the twist over that sub-step. `energy` is the sum of the kinetic energy, the
  // potential energy of the object and of the movable objects, and the energy of the controller's
  // springs. This sum excludes the potential energy of the cobot, because its controllers
  // compensate its weight.
  const WorldState& state() const;

  // Returns to the initial equilibrium at time 0.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept;

  // Returns a linear model about the present posture at rest. The model includes the controller,
  // joint friction and contacts. The model excludes the coupling, the hands, Coulomb friction, the
  // movable objects and the contacts of cobot.touches. At the start, no movable object touches the
  // object or the cobot, and none of these contacts is closed. Therefore the motion of the movable
  // objects neither affects the handles nor follows from a force on the handles. The state x
  // contains the tangent-space change of the coordinates (nv) and then their rates (nv). Allocates
  // memory.
  LinearModel Linearise() const;
  // Returns the same model without the contacts that exist at this posture. To this model, a
  // prediction can add one contact at a time.
  LinearModel LineariseWithoutContacts() const;

  // Judges the stability of the loop that the sampled controller and this scene form. Allocates
  // memory.
  SampledLoop JudgeController() const;
  // Returns the forces that carry the object at the start. This function must be called before the
  // first Step or directly after Reset. Allocates memory.
  ObjectSupport SupportAtStart() const;

  // Returns the pairs that cobot.touches concerns, with their distances. Call this before the first
  // Step or directly after Reset. Empty without cobot.touches. Allocates memory.
  std::vector<ContactPair> contact_pairs() const;

  double object_mass() const;                    // [kg]
  std::vector<std::string> joint_names() const;  // of the cobot's joints
  const JointVector& effort_limit() const;       // of the cobot's joints [N·m]
  // Returns a sentence that states why the engine no longer computes, or "" if it does.
  std::string EngineFailure() const;
  std::string SceneXml() const;  // text of the composed scene (MJCF), for inspection

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
