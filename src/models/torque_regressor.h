// Computes the joint torques of an arm as a linear function of its links' inertial parameters.
#pragma once

#include <memory>

#include "core/types.h"
#include "models/robot.h"

namespace predictor {

struct EngineRegressor;

// The ten inertial parameters of a body are the mass m [kg], m c [kg·m], and the inertia about the
// body's frame, xx xy yy xz yz zz [kg·m²], all in the axes of that frame.
using InertialParameters = Eigen::Matrix<double, 10, 1>;

class TorqueRegressor {
 public:
  // `model` must outlive this object. `gravity` [m/s²] acts along −z of W.
  TorqueRegressor(const RobotModel& model, double gravity);

  // Returns the matrix Y(q, v, a) in τ = Y π, with dof rows and 10 dof columns. The torques τ [N·m]
  // move the arm without friction and with nothing at its end-effector. The vector π contains the
  // parameters of the arm's moving bodies (Atkeson, An & Hollerbach 1986). The result is valid
  // until the next call.
  const Eigen::MatrixXd& Compute(const JointVector& q, const JointVector& v, const JointVector& a);

  // Returns the parameters π of the model. Fixed links are included in the bodies that carry them.
  const Eigen::VectorXd& parameters() const { return parameters_; }

 private:
  std::shared_ptr<EngineRegressor> engine_;
  Eigen::VectorXd parameters_;
};

// Returns the parameters of a body from its mass [kg], centre of mass [m] and inertia about the
// centre of mass [kg·m²].
InertialParameters InertialParametersOf(double mass, const Vector3& com, const Matrix3& inertia);

}  // namespace predictor
