// The person at the handles, simulated: hands as delayed impedances that follow a script.
#pragma once

#include <array>
#include <memory>

#include "core/archive.h"
#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// What a person feels and sees: the handles' motion now, and whether the run is on. Nothing of the
// simulation: the object's pose is derived from the handles (it is rigid with them).
struct OperatorInput {
  double dt = 0.001;    // since the last call [s]
  double run_time = 0;  // [s]; stands still unless running
  bool running = false;
  std::array<bool, kHands> present = {};
  std::array<FrameMotion, kHands> handle;  // A_W filled in: as the arm moves it
  std::array<HandInput, kHands> hands;     // of a person at a page

  template <class A>
  void Archive(A& a) {
    a(dt, run_time, running, handle, hands);
  }
};

struct OperatorOutput {
  std::array<Wrench, kHands> F_H_W = {Wrench::Zero(), Wrench::Zero()};  // on the handle, inertia in
  std::array<double, kHands> grip = {0, 0};                             // s(t) in [0, 1]
  std::array<double, kHands> hand_mass = {0, 0};  // effective mass holding the handle: s · M_h [kg]
  int action = -1;                                // index of the script's current action

  template <class A>
  void Archive(A& a) {
    a(F_H_W, grip, hand_mass, action);
  }
};

class Operator {
 public:
  virtual ~Operator() = default;
  // No heap, lock or exception.
  virtual void Step(const OperatorInput& input, OperatorOutput* output) noexcept = 0;
  virtual void Reset() noexcept = 0;
  virtual void Archive(StateArchive& a) noexcept = 0;
};

// Where the operator's hands act. In emulation the hand's inertia −M_h·a is part of the wrench; in
// direct mode the hand's mass is in the scene instead, and the wrench is without it.
enum class HandInertia { kInWrench, kInScene };

// The operator that the scenario names: one that follows its script, or a person at a page. Throws
// InputError.
std::unique_ptr<Operator> MakeOperator(const Scenario& scenario, HandInertia inertia);

std::unique_ptr<Operator> MakeVirtualOperator(const Scenario& scenario, HandInertia inertia);
std::unique_ptr<Operator> MakeBrowserOperator(const Scenario& scenario, HandInertia inertia);

}  // namespace predictor
