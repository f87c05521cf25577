// Computes a linear model of the controlled scene, for stability margins and for tests.
#pragma once

#include <array>

#include "simulation/controlled_scene.h"

namespace predictor {

// Linearises at rest about the posture of `engine`, which is in a state of the present scene, with
// the set-point of time t [s]. The state contains changes of the coordinates (nv, tangent space)
// and their rates (nv), and then the states of the wrist sensor and the controller. LinearModel
// defines the inputs and outputs, which are those of the handles D at X_OD. The inputs and outputs
// of sides that are not `present` are zero. Coulomb friction is ignored. `contacts` states whether
// the contacts at this posture act. Changes the state of `engine` and `scene`. Allocates memory.
LinearModel Linearise(ControlledScene* scene, Engine* engine, double t, const Hands& hands,
                      const std::array<Pose, kHands>& X_OD, bool contacts = true);

// The derivatives of the scene without hands, in which the controller has no period and no delay.
// The states are those of Linearise, with n velocities and m states of sensor and memory.
struct SceneSlopes {
  Eigen::MatrixXd rates;      // of velocities and inner states, by the states (n + m x 2n + m)
  Eigen::MatrixXd by_torque;  // of the same, by the joints' torques (n + m x joints)
  Eigen::MatrixXd torque;     // of the controller, by the states (joints x 2n + m)
  int sensed = 0;             // number of the inner states that belong to the wrist sensor: 0 or 6
  double wrist_rate = 0;      // with which `rates` lets the sensor follow the wrench [rad/s]
};
SceneSlopes SlopesOf(ControlledScene* scene, Engine* engine, double t);

}  // namespace predictor
