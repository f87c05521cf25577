// Tests changes of stiffness and damping while the cobot holds a load. The torque must not jump,
// and after the change the new stiffness must act.
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.h"

namespace predictor {
namespace {

JointVector Torque(ControlledRobot* robot) {
  JointVector torque;
  robot->controller->Compute(robot->Input(), &torque);
  return torque;
}

// Displaces the arm from the set-point in every direction, at rest.
void Displace(ControlledRobot* robot, double by) {
  JointVector q = robot->posture;
  for (int j = 0; j < q.size(); ++j) q[j] += by * std::cos(1.0 + j);
  robot->Update(q, JointVector::Zero(q.size()));
}

// The controller has no spring towards the posture.
ControllerSpec ControllerWith(const std::string& type, const std::string& translation,
                              const std::string& rotation, const std::string& joints) {
  ControllerSpec spec = {type, {}};
  if (type == "joint_impedance") {
    spec.Set("joint_stiffness=" + joints);
  } else {
    spec.Set("stiffness.translation=" + translation);
    spec.Set("stiffness.rotation=" + rotation);
    spec.Set("posture_stiffness=0");
  }
  return spec;
}

class Tuning : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Controllers, Tuning,
                         testing::Values("cartesian_impedance", "joint_impedance"),
                         [](const auto& type) { return std::string(type.param); });

TEST_P(Tuning, LeavesTheTorqueAsItIsAndTheSpringAsAskedFor) {
  Scenario s = EmptyScene();
  s.cobot.controller = ControllerWith(GetParam(), "[300, 400, 500]", "[100, 100, 100]", "100");
  ControlledRobot tuned(s), plain(s);
  // This scenario requests the stiffness from the beginning.
  Scenario softer = s;
  softer.cobot.controller = ControllerWith(GetParam(), "[150, 200, 250]", "[50, 50, 50]", "50");
  ControlledRobot soft(softer);

  Displace(&tuned, 0.05);
  Displace(&plain, 0.05);
  const JointVector before = Torque(&tuned);
  // The stiffness changes in many small steps, like a ramp.
  for (int k = 1; k <= 100; ++k) {
    const double factor = 1 - 0.005 * k;
    tuned.controller->Tune({factor, factor, 1}, tuned.Input(), true);
    EXPECT_LT((Torque(&tuned) - before).lpNorm<Eigen::Infinity>(), 1e-9);
  }

  // From this position on, the new stiffness must resist small motions.
  Displace(&tuned, 0.0501);
  const JointVector change =
      Torque(&tuned) - before - (tuned.data.gravity() - plain.data.gravity());
  Displace(&soft, 0.05);
  const JointVector soft_before = Torque(&soft) - soft.data.gravity();
  Displace(&soft, 0.0501);
  const JointVector expected = Torque(&soft) - soft.data.gravity() - soft_before;
  // The offset rotates with the end-effector, which is a second-order effect of the displacement.
  EXPECT_LT((change - expected).norm(), 0.1 * expected.norm());
  EXPECT_GT(expected.norm(), 1e-4);

  tuned.controller->ResetTuning();
  Displace(&tuned, 0.05);
  EXPECT_EQ(Torque(&tuned), before);
}

TEST_P(Tuning, OfDampingActsOnMotionOnly) {
  Scenario s = EmptyScene();
  s.cobot.controller = ControllerWith(GetParam(), "[500, 500, 500]", "[100, 100, 100]", "100");
  ControlledRobot robot(s);
  const auto damping = [&](double factor) {
    robot.controller->Tune({1, 1, factor}, robot.Input(), true);
    robot.Update(robot.posture, JointVector::Constant(robot.model->dof(), 0.3));
    const JointVector moving = Torque(&robot);
    robot.Update(robot.posture, JointVector::Zero(robot.model->dof()));
    const JointVector resting = Torque(&robot);
    return JointVector(moving - resting);
  };
  const JointVector once = damping(1), twice = damping(2);
  EXPECT_LT((twice - 2 * once).norm(), 1e-9 * once.norm());
  EXPECT_GT(once.norm(), 1);
}

}  // namespace
}  // namespace predictor
