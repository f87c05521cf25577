// Defines the simplest hand and the simplest world. The stability of their loop has a closed form.
#pragma once

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns one handle on a mass [kg] with a damper [N·s/m] that can move along x only.
inline LinearModel Mass(double mass, double damper) {
  LinearModel world;
  world.dof = 1;
  world.A = Eigen::MatrixXd::Zero(2, 2);
  world.A(0, 1) = 1;
  world.A(1, 1) = -damper / mass;
  world.B = Eigen::MatrixXd::Zero(2, 12);
  world.B(1, 0) = 1 / mass;
  world.C = Eigen::MatrixXd::Zero(12, 2);
  world.C(0, 1) = 1;
  return world;
}

// Returns one arm whose only dynamics are a delay [s] from the virtual to the real handle and back.
inline Scenario PureDelay(double delay) {
  Scenario s;
  s.left_handle.emplace();
  s.device.left.emplace();
  s.device.left->loop = {20000, 1, delay};
  s.device.left->sensor.cutoff_frequency = 0;
  s.device.left->sensor.delay = 0;
  s.rendering.kp = s.rendering.ko = 0;
  return s;
}

// Returns a hand that consists only of a spring along x.
inline HandSpec Spring(double stiffness) {
  HandSpec hand;
  hand.stiffness = {stiffness, 0, 0};
  hand.rotation_stiffness = hand.rotation_damping = hand.damping_ratio = 0;
  hand.mass = hand.reflex_gain = 0;
  hand.visual_stiffness.setZero();
  return hand;
}

}  // namespace predictor
