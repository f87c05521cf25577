// Compares the motion of the exported SDF in ign-physics (dartsim, Gazebo's engine) with that in
// our DART world.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "core/text.h"
#include "export/scene_package.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario_io.h"
#include "simulation/dart/dart_process.h"
#include "simulation/dart/dart_scene.h"
#include "support/temporary_folder.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;

constexpr int kGazeboSteps = 5000;             // of 1 ms
constexpr double kMaxGazeboDifference = 1e-9;  // [m]
constexpr double kBallDamping = 0.5;           // of the damped ball joint [N·m·s/rad]
constexpr double kIgnoredDamping = 1e-4;       // least effect of this damping, well above 1e-9 [m]

// Returns the path of the program that is built from tests/export/gazebo. The program is in the
// folder of the tests.
fs::path Mover() { return fs::path(PREDICTOR_BINARY).parent_path() / "predictor-ign-mover"; }

std::string OutputOf(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "";
  std::string output;
  std::array<char, 4096> text;
  for (std::size_t n; (n = fread(text.data(), 1, text.size(), pipe)) > 0;)
    output.append(text.data(), n);
  pclose(pipe);
  return output;
}

// Applies the same control law as the program in tests/export/gazebo. The law consists of springs
// and dampers in the joints, and a force on the object's centre.
std::vector<Vector3> MoveInDart(const Scenario& scenario) {
  const auto robot = RobotModel::Load({scenario.cobot.model, scenario.folder(),
                                       scenario.cobot.remove_links, scenario.cobot.base.ToPose()});
  const ObjectModel object = LoadObject(scenario.object, scenario.folder());
  DartProcess dart(DartScene(scenario, *robot, object, 0.001));
  dart_engine::Memory& memory = dart.memory();
  std::copy(scenario.cobot.posture.begin(), scenario.cobot.posture.end(), memory.state.q);
  memory.state.q[robot->dof()] = 1;  // the ball's quaternion
  constexpr std::array<double, 7> kStiffness = {600, 600, 600, 600, 100, 100, 20};
  constexpr std::array<double, 7> kDamping = {30, 30, 30, 30, 3, 3, 0.5};
  std::vector<Vector3> path;
  for (int step = 0; step < kGazeboSteps; ++step) {
    for (std::size_t j = 0; j < kStiffness.size(); ++j)
      memory.forces.joint[j] = -kStiffness[j] * (memory.state.q[j] - scenario.cobot.posture[j]) -
                               kDamping[j] * memory.state.v[j];
    const double t = 0.001 * step;
    memory.forces.object[0] = 10 * std::sin(t);
    memory.forces.object[1] = 5 * std::sin(2 * t);
    if (!dart.Ask(dart_engine::Request::kAdvance)) break;
    path.push_back(Eigen::Map<const Vector3>(memory.motion.body[1].pose.p));
  }
  return path;
}

struct Compared {
  double difference = 0;  // largest distance of the object's places in both programs [m]
  double distance = 0;    // that the object moved [m]
};

// Moves the object of box_9kg in both programs. `damping` is that of the ball joint [N·m·s/rad].
Compared Compare(double damping) {
  Scenario scenario = LoadScenario(fs::path(PREDICTOR_SOURCE_DIR) / "scenarios" / "box_9kg.yaml");
  scenario.simulation.joint_limits = JointLimits::kNone;
  scenario.environment.floor = false;
  scenario.cobot.effort_limit = {1000};  // only ign-physics enforces the limit
  scenario.object.attachment.damping = damping;
  const test::TemporaryFolder folder;
  WriteScenePackage(MakeScenePackage(scenario, SceneFormat::kSdf), folder.path() / "to", false);
  std::string command = Mover().string() + " " + (folder.path() / "to" / kSceneSdf).string() +
                        " /usr/lib/x86_64-linux-gnu/ign-physics-5/engine-plugins/"
                        "libignition-physics-dartsim-plugin.so";
  for (const double q : scenario.cobot.posture) command += " " + FormatNumber(q);
  std::istringstream said(OutputOf(command + " 2>/dev/null"));
  const std::vector<Vector3> ours = MoveInDart(scenario);
  EXPECT_EQ(ours.size(), static_cast<std::size_t>(kGazeboSteps));
  Compared compared;
  for (const Vector3& p : ours) {
    Vector3 other;
    EXPECT_TRUE(said >> other.x() >> other.y() >> other.z());
    if (testing::Test::HasFailure()) break;
    compared.difference = std::max(compared.difference, (other - p).norm());
    compared.distance = std::max(compared.distance, (p - ours.front()).norm());
  }
  std::printf("ball damping %.1f N·m·s/rad: %.2g m, over %.2f m\n", damping, compared.difference,
              compared.distance);
  return compared;
}

class Gazebo : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasDart()) GTEST_SKIP() << "This build has no DART.";
    if (!fs::exists(Mover())) GTEST_SKIP() << "ign-physics is missing: see deps/apt-dart.txt.";
  }
};

TEST_F(Gazebo, MovesTheExportedSceneAsOurWorldOfDartDoes) {
  const Compared compared = Compare(0);
  EXPECT_LE(compared.difference, kMaxGazeboDifference);
  EXPECT_GT(compared.distance, 0.02);
}

// If Gazebo used the damping of ball joints, both programs would agree as without damping, and
// docs/how-to/engines.md would be wrong.
TEST_F(Gazebo, IgnoresTheDampingOfABallJoint) {
  EXPECT_GT(Compare(kBallDamping).difference, kIgnoredDamping);
}

}  // namespace
}  // namespace predictor::scene_export
