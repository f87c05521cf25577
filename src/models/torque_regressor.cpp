#include "models/torque_regressor.h"

#include "models/robot_impl.h"

namespace predictor {

TorqueRegressor::TorqueRegressor(const RobotModel& model, double gravity)
    : engine_(MakeEngineRegressor(*model.impl().engine, gravity)),
      parameters_(InertialParametersOf(*model.impl().engine)) {}

const Eigen::MatrixXd& TorqueRegressor::Compute(const JointVector& q, const JointVector& v,
                                                const JointVector& a) {
  return ComputeTorqueRegressor(q, v, a, engine_.get());
}

InertialParameters InertialParametersOf(double mass, const Vector3& com, const Matrix3& inertia) {
  const Matrix3 I = inertia - mass * Skew(com) * Skew(com);
  InertialParameters parameters;
  parameters << mass, mass * com, I(0, 0), I(0, 1), I(1, 1), I(0, 2), I(1, 2), I(2, 2);
  return parameters;
}

}  // namespace predictor
