#include <gtest/gtest.h>

#include "models/robots.h"

namespace predictor::test {
namespace {

class InverseKinematics : public RobotTest {
 protected:
  Pose PoseAt(const JointVector& at) {
    data.UpdateKinematics(*model, at, JointVector::Zero(n));
    return data.FramePose(*model, frame);
  }
  bool IsWithinLimits(const JointVector& x) const {
    return (x.array() >= model->position_lower().array()).all() &&
           (x.array() <= model->position_upper().array()).all();
  }
  // Returns the middle of the joints' ranges.
  JointVector Middle() const {
    JointVector middle = (model->position_lower() + model->position_upper()) / 2;
    return middle.array().isNaN().select(0, middle);
  }
};

std::vector<RobotCase> Arms() {  // the tree has too few joints to reach a given pose
  std::vector<RobotCase> arms = RobotCases();
  arms.pop_back();
  return arms;
}

INSTANTIATE_TEST_SUITE_P(Robots, InverseKinematics, testing::ValuesIn(Arms()), NameOf);

TEST_P(InverseKinematics, ReachesReachablePoses) {
  for (int i = 0; i < 50; ++i, Shake()) {
    const Pose goal = PoseAt(q);
    JointVector solution;
    EXPECT_TRUE(SolveInverseKinematics(*model, frame, goal, Middle(), 50, &solution));
    const Vector6 error = PoseError(goal, PoseAt(solution));
    EXPECT_LT(error.head<3>().norm(), 1e-6);
    EXPECT_LT(error.tail<3>().norm(), 1e-6);
    EXPECT_TRUE(IsWithinLimits(solution));
  }
}

TEST_P(InverseKinematics, StaysNearTheStart) {
  for (int i = 0; i < 50; ++i, Shake()) {
    JointVector solution;
    const JointVector start = (q + RandomVector(0.01))
                                  .cwiseMax(model->position_lower())
                                  .cwiseMin(model->position_upper());
    EXPECT_TRUE(SolveInverseKinematics(*model, frame, PoseAt(q), start, 50, &solution));
    EXPECT_LT((solution - start).norm(), 0.5);
  }
}

TEST_P(InverseKinematics, ReportsUnreachablePoses) {
  Pose goal = SlantedBase();
  goal.p += Vector3(3, 0, 0);
  JointVector solution;
  EXPECT_FALSE(SolveInverseKinematics(*model, frame, goal, Middle(), 5, &solution));
  EXPECT_TRUE(IsWithinLimits(solution));
  // The best solution found must stretch the arm towards the goal.
  const double reach = (PoseAt(Middle()).p - goal.p).norm();
  EXPECT_LT((PoseAt(solution).p - goal.p).norm(), reach);
}

TEST_P(InverseKinematics, RepeatsItself) {
  const Pose goal = PoseAt(q);
  JointVector first, second;
  SolveInverseKinematics(*model, frame, goal, Middle(), 50, &first);
  SolveInverseKinematics(*model, frame, goal, Middle(), 50, &second);
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace predictor::test
