// The simplest world that the stability of a hand's loop can be computed of by hand.
#pragma once

#include "core/messages.h"

namespace predictor {

// One handle on a mass [kg] with a damper [N·s/m], free along x only.
inline LinearModel Mass(double mass, double damper) {
  LinearModel world;
  world.A = Eigen::MatrixXd::Zero(2, 2);
  world.A(0, 1) = 1;
  world.A(1, 1) = -damper / mass;
  world.B = Eigen::MatrixXd::Zero(2, 12);
  world.B(1, 0) = 1 / mass;
  world.C = Eigen::MatrixXd::Zero(12, 2);
  world.C(0, 1) = 1;
  return world;
}

}  // namespace predictor
