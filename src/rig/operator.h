// The simulated person at the handles: hands as delayed impedances that follow a script.
#pragma once

#include <array>
#include <memory>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// The quantities that a person perceives: the present motion of the handles, and whether the run is
// active. The state of the simulation is not included. The object's pose is derived from the
// handles, which are rigidly attached to the object.
struct OperatorInput {
  double dt = 0.001;    // time since the last call [s]
  double run_time = 0;  // time of the run [s]; advances only while running
  bool running = false;
  Hands present;
  std::array<FrameMotion, kHands> handle;  // A_W is the arm's actual acceleration
  std::array<HandInput, kHands> hands;     // input of a person at a page

  template <class A>
  void Archive(A& a) {
    a(dt, run_time, running, handle, hands);
  }
};

struct OperatorOutput {
  // The wrench of each hand on its handle, including the hand's inertia.
  std::array<Wrench, kHands> F_H_W = {Wrench::Zero(), Wrench::Zero()};
  std::array<double, kHands> grip = {0, 0};  // s(t) in [0, 1]
  // Effective mass that holds the handle: s · M_h [kg]
  std::array<double, kHands> hand_mass = {0, 0};
  int action = -1;  // index of the script's current action

  template <class A>
  void Archive(A& a) {
    a(F_H_W, grip, hand_mass, action);
  }
};

class Operator {
 public:
  virtual ~Operator() = default;
  // Does not use the heap or a lock, and does not throw.
  virtual void Step(const OperatorInput& input, OperatorOutput* output) noexcept = 0;
  virtual void Reset() noexcept = 0;
  virtual void Archive(StateArchive& a) noexcept = 0;
};

// The treatment of the hand's inertia. In emulation, the inertial force −M_h·a of the hand is part
// of the wrench. In direct mode, the hand's mass is part of the scene, and the wrench excludes it.
enum class HandInertia { kInWrench, kInScene };

// Makes the operator of the scenario. The operator is either simulated and follows the script, or
// is a person who uses a page. Throws InputError.
std::unique_ptr<Operator> MakeOperator(const Scenario& scenario, HandInertia inertia);

std::unique_ptr<Operator> MakeVirtualOperator(const Scenario& scenario, HandInertia inertia);
std::unique_ptr<Operator> MakeBrowserOperator(const Scenario& scenario, HandInertia inertia);

}  // namespace predictor
