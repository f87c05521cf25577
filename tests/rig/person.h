// A simulated operator whose handles the test moves.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "rig/operator.h"

namespace predictor {

// Returns a person without noise, tremor or drift, with one handle at O or two handles 0.6 m apart
// along y.
inline Scenario QuietScenario(int handles) {
  Scenario scenario;
  HandleSpec left, right;
  if (handles == 2) {
    left.pose.xyz = {0, 0.3, -0.1};
    right.pose.xyz = {0, -0.3, -0.1};
    scenario.right_handle = right;
  }
  scenario.left_handle = left;
  HandSpec& hand = scenario.operator_.hand;
  hand.tremor_force = hand.force_noise = hand.force_noise_floor = hand.speed_drift = 0;
  return scenario;
}

// Returns a person who consists only of a spring to the reference.
inline Scenario SpringScenario(int handles) {
  Scenario scenario = QuietScenario(handles);
  HandSpec& hand = scenario.operator_.hand;
  hand.damping_ratio = hand.rotation_damping = hand.reflex_gain = 0;
  hand.visual_stiffness.setZero();
  hand.max_force = hand.max_torque = 1e9;
  return scenario;
}

class Person {
 public:
  explicit Person(const Scenario& scenario, HandInertia inertia = HandInertia::kInWrench)
      : operator_(MakeVirtualOperator(scenario, inertia)) {
    input.present = scenario.hands();
    for (const int hand : input.present)
      input.handle[hand].X_W = X_WO * scenario.handle(hand).pose.ToPose();
    input.running = true;
  }

  void Step() {
    operator_->Step(input, &output);
    if (input.running) input.run_time += input.dt;
  }
  void Run(double seconds, const std::function<void()>& each = {}) {
    const int steps = static_cast<int>(std::lround(seconds / input.dt));
    for (int i = 0; i < steps; ++i) {
      Step();
      if (each) each();
    }
  }
  Vector3 Force(int hand = 0) const {
    return output.F_H_W[static_cast<std::size_t>(hand)].head<3>();
  }
  Vector3 Torque(int hand = 0) const {
    return output.F_H_W[static_cast<std::size_t>(hand)].tail<3>();
  }
  Operator& self() { return *operator_; }

  Pose X_WO = {{0.5, 0.1, 0.9}, RotationFromVector({0.1, -0.2, 0.3})};
  OperatorInput input;
  OperatorOutput output;

 private:
  std::unique_ptr<Operator> operator_;
};

}  // namespace predictor
