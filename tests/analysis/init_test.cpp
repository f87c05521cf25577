// In the scenarios that `init` writes for real robots, the cobot must hold the object freely from
// above.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "models/robot.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

struct Robot {
  std::string name, arguments;
  Vector3 outward;  // where the last link points, in the axes of the end-effector
};

std::ostream& operator<<(std::ostream& out, const Robot& robot) { return out << robot.name; }

class Init : public testing::TestWithParam<Robot> {
 protected:
  // Returns the exit code.
  int Run(const std::string& arguments) const {
    const std::string command = std::string(PREDICTOR_BINARY) + " init " + file_.string() +
                                " --quiet " + arguments + " > /dev/null 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  const test::TemporaryFolder folder_;
  const fs::path file_ = folder_.path() / "own.yaml";
};

// Returns whether a point is in the object's box, enlarged by `margin` [m].
bool IsInside(const Scenario& s, const Pose& X_WO, const Vector3& p_W, double margin) {
  const Vector3 p = X_WO.Inverse() * p_W;
  const PrimitiveSpec& object = *s.object.primitive;
  if (object.shape == Shape::kSphere) return p.norm() < object.size.x() + margin;
  return ((p.cwiseAbs() - object.size / 2).array() < margin).all();
}

// The lines between the joints, except those of the last link, must be outside the object.
void ExpectLinksOutside(const Scenario& s, const WorldState& state) {
  const UrdfModel urdf =
      ReadUrdf(ResolveModelPath(s.cobot.model, s.folder()), s.cobot.remove_links, s.folder());
  const auto model = RobotModel::Build(urdf, s.cobot.base.ToPose());
  RobotData data(*model);
  data.UpdateKinematics(*model, state.q, JointVector::Zero(model->dof()));
  const int hand = model->Frame(s.cobot.end_effector).body;
  for (const UrdfJoint& joint : urdf.joints) {
    const auto frame = [&](int link) {
      return model->Frame(urdf.links[static_cast<std::size_t>(link)].name);
    };
    if (frame(joint.parent).body == hand) continue;
    const Vector3 from = data.FramePose(*model, frame(joint.parent)).p;
    const Vector3 to = data.FramePose(*model, frame(joint.child)).p;
    for (double share = 0; share <= 1; share += 0.05)
      EXPECT_FALSE(IsInside(s, state.object.X_W, from + share * (to - from), 0.01)) << joint.name;
  }
}

TEST_P(Init, LetsTheObjectHangFreelyUnderALastLinkThatPointsDown) {
  ASSERT_EQ(Run(GetParam().arguments), 0);
  const Scenario s = LoadScenario(file_);
  const World world(s);
  const WorldState& state = world.state();
  const Pose& X_WE = state.end_effector.X_W;
  const Pose& X_WO = state.object.X_W;
  const Vector3 outward = X_WE.q * GetParam().outward;
  constexpr double kTilt = 0.15;  // of the last link under load [rad]
  EXPECT_LT(std::acos(std::clamp(-outward.z(), -1.0, 1.0)), kTilt);
  EXPECT_GT((X_WO.p - X_WE.p).dot(outward), 0.05);
  const PrimitiveSpec& object = *s.object.primitive;
  const bool is_ball = object.shape == Shape::kSphere;
  const double half_height = is_ball ? object.size.x() : object.size.z() / 2;
  EXPECT_GT(X_WO.p.z() - half_height, 0.04);
  // The cobot compensates the weight, so it stays in its posture.
  const auto model =
      RobotModel::Load({s.cobot.model, s.folder(), s.cobot.remove_links, s.cobot.base.ToPose()});
  RobotData data(*model);
  data.UpdateKinematics(*model,
                        Eigen::Map<const Eigen::VectorXd>(s.cobot.posture.data(), model->dof()),
                        JointVector::Zero(model->dof()));
  const Vector3 start = data.FramePose(*model, model->Frame(s.cobot.end_effector)).p;
  ASSERT_TRUE(s.cobot.payload);
  EXPECT_EQ(s.cobot.payload->mass, object.mass);
  EXPECT_LT((start - X_WE.p).norm(), 1e-6);
  EXPECT_NEAR(world.SupportAtStart().floor, 0, 1e-9);
  ExpectLinksOutside(s, state);
}

std::vector<Robot> Robots() {
  const std::string robots = "--urdf package://example-robot-data/robots/";
  const std::string ur = robots + "ur_description/urdf/";
  return {
      {"xArm7", robots + "xarm_description/urdf/xarm7.urdf", {0, 0, 1}},
      {"xArm7Ball", robots + "xarm_description/urdf/xarm7.urdf --object ball --arms 1", {0, 0, 1}},
      {"xArm7Bar", robots + "xarm_description/urdf/xarm7.urdf --object bar", {0, 0, 1}},
      {"Baxter",
       robots + "baxter_description/urdf/baxter.urdf --end-effector left_gripper",
       {0, 0, 1}},
      {"Z1", robots + "z1_description/urdf/z1.urdf", {1, 0, 0}},
      {"Kinova", robots + "kinova_description/robots/kinova.urdf", {1, 0, 0}},
      {"UR3", ur + "ur3_robot.urdf", {0, 0, 1}},
      {"UR10", ur + "ur10_robot.urdf", {0, 0, 1}}};
}

INSTANTIATE_TEST_SUITE_P(Robots, Init, testing::ValuesIn(Robots()),
                         [](const auto& robot) { return robot.param.name; });

}  // namespace
}  // namespace predictor
