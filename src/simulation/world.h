// The virtual world: cobot, object, handles, floor and table, simulated by MuJoCo behind this class.
#pragma once

#include <memory>
#include <string>

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

class World {
 public:
  // Composes the scene, finds the static equilibrium (no hands) and stands there. Throws InputError.
  explicit World(const Scenario& scenario);
  ~World();

  // Advances by dt [s] (a whole number of 1 ms sub-steps) under the hands' wrenches and the
  // coupling. On a non-finite or diverged step the state before it is kept and kPhysics returned.
  // No heap, lock or exception.
  Status Step(const WorldInput& input, double dt) noexcept;

  const WorldState& state() const;

  // Back to the equilibrium at the start, time 0.
  void Reset() noexcept;

  // Linear model about the present state (controller, friction and damping in it; coupling, hands
  // and Coulomb friction not). Allocates.
  LinearModel Linearise() const;

  // Nearest distance between any two contact-enabled bodies that touch, for reports; mass of the
  // object [kg]; text of the composed scene (MJCF) for inspection.
  double object_mass() const;
  std::string SceneXml() const;

  // May change while running, ramped by the caller: stiffness and damping ratio of the controller.
  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
