// The regressor must agree with the mass matrix and the bias.
#include "models/torque_regressor.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "models/robot.h"

namespace predictor {
namespace {

constexpr double kGravity = 9.7;  // differs from the engine's own value [m/s²]

std::shared_ptr<const RobotModel> Load() {
  RobotSource source;
  source.model =
      std::string("package://example-robot-data/robots/panda_description/urdf/panda.urdf");
  source.remove_links = {"panda_hand"};
  source.X_WB = PoseFromXyzRpy({0.1, -0.2, 0.3}, {0.2, -0.4, 0.6});
  return RobotModel::Load(source);
}

TEST(TorqueRegressor, TimesParametersIsTheTorque) {
  const auto robot = Load();
  RobotData data(*robot);
  TorqueRegressor regressor(*robot, kGravity);
  RandomStream random(1, "regressor");
  for (int i = 0; i < 20; ++i) {
    JointVector q(robot->dof()), v(robot->dof()), a(robot->dof());
    for (int j = 0; j < robot->dof(); ++j)
      q[j] = random.Normal(), v[j] = random.Normal(), a[j] = random.Normal();
    data.UpdateDynamics(*robot, q, v, kGravity);
    const JointVector expected = data.M() * a + data.bias();
    const JointVector torque = regressor.Compute(q, v, a) * regressor.parameters();
    EXPECT_LT((torque - expected).norm(), 1e-9 * (1 + expected.norm()));
  }
}

TEST(TorqueRegressor, ParametersOfABody) {
  Matrix3 inertia = Matrix3::Zero();
  inertia.diagonal() << 0.1, 0.2, 0.25;
  const InertialParameters p = InertialParametersOf(2, {0.1, 0, 0.3}, inertia);
  EXPECT_DOUBLE_EQ(p[0], 2);
  EXPECT_DOUBLE_EQ(p[1], 0.2);
  EXPECT_DOUBLE_EQ(p[3], 0.6);
  EXPECT_DOUBLE_EQ(p[4], 0.1 + 2 * 0.09);           // xx
  EXPECT_DOUBLE_EQ(p[5], 0);                        // xy
  EXPECT_DOUBLE_EQ(p[6], 0.2 + 2 * (0.01 + 0.09));  // yy
  EXPECT_DOUBLE_EQ(p[7], -2 * 0.1 * 0.3);           // xz
  EXPECT_DOUBLE_EQ(p[9], 0.25 + 2 * 0.01);          // zz
}

}  // namespace
}  // namespace predictor
