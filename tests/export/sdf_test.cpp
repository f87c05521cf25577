// Tests the scene as SDF. The tests compare the poses of the links with our kinematics, and they
// run Gazebo's checker.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <tinyxml2.h>

#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "export/files.h"
#include "export/scene_package.h"
#include "export/scenes.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "scenario/scenario_io.h"

namespace predictor::scene_export {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

Scenario SceneNamed(const std::string& name, const fs::path& folder) {
  const std::map<std::string, JointType> odd = {{"odd_spherical", JointType::kSpherical},
                                                {"odd_fixed", JointType::kFixed},
                                                {"odd_revolute", JointType::kRevolute},
                                                {"odd_prismatic", JointType::kPrismatic}};
  const auto found = odd.find(name);
  if (found != odd.end()) return OddScene(folder, found->second);
  return LoadScenario(fs::path(PREDICTOR_SOURCE_DIR) / "scenarios" / (name + ".yaml"));
}

Pose PoseIn(const XMLElement& element) {
  std::istringstream numbers(element.FirstChildElement("pose")->GetText());
  Vector3 xyz, rpy;
  numbers >> xyz.x() >> xyz.y() >> xyz.z() >> rpy.x() >> rpy.y() >> rpy.z();
  return PoseFromXyzRpy(xyz, rpy);
}

class SdfScene : public testing::TestWithParam<const char*> {
 protected:
  SdfScene() : scenario(SceneNamed(GetParam(), folder.path() / "source")) {
    WriteScenePackage(MakeScenePackage(scenario, SceneFormat::kSdf), folder.path() / "to", false);
    doc.LoadFile(File().c_str());
    world = doc.FirstChildElement("sdf")->FirstChildElement("world");
    model = world->FirstChildElement("model");
    for (const char* kind : {"link", "frame", "joint"})
      for (const XMLElement* e = model->FirstChildElement(kind); e; e = e->NextSiblingElement(kind))
        parts[e->Attribute("name")] = e;
  }

  fs::path File() const { return folder.path() / "to" / kSceneSdf; }

  // Returns the pose of a link or frame with all joints at zero.
  Pose PlaceOf(const std::string& name) const {
    const XMLElement& part = *parts.at(name);
    const char* base = part.FirstChildElement("pose")->Attribute("relative_to");
    return base ? PlaceOf(base) * PoseIn(part) : PoseIn(part);
  }

  test::TemporaryFolder folder;
  Scenario scenario;
  tinyxml2::XMLDocument doc;
  const XMLElement *world = nullptr, *model = nullptr;
  std::map<std::string, const XMLElement*> parts;
};

TEST_P(SdfScene, PutsLinksWhereOurKinematicsDoes) {
  const auto robot = RobotModel::Load({scenario.cobot.model, scenario.folder(),
                                       scenario.cobot.remove_links, scenario.cobot.base.ToPose()});
  RobotData data(*robot);
  const JointVector zero = JointVector::Zero(robot->dof());
  data.UpdateKinematics(*robot, zero, zero);
  const auto expect_at = [&](const std::string& name, const Pose& expected) {
    const Pose place = PlaceOf(name);
    EXPECT_LT((place.p - expected.p).norm(), 1e-12) << name;
    EXPECT_LT(RotationError(place.q, expected.q).norm(), 1e-7) << name;
  };
  int compared = 0;
  for (const std::string& link : robot->link_names()) {
    // In the odd scenes, links of the cobot have names that the scene itself uses.
    if (!parts.contains(link) || link == "object") continue;
    expect_at(link, data.FramePose(*robot, robot->Frame(link)));
    ++compared;
  }
  EXPECT_GE(compared, 2);
  const AttachmentSpec& attachment = scenario.object.attachment;
  const Pose X_WE = data.FramePose(*robot, robot->Frame(scenario.cobot.end_effector));
  expect_at("object",
            X_WE * attachment.on_end_effector.ToPose() * attachment.on_object.ToPose().Inverse());
}

TEST_P(SdfScene, HasALinkForEachMassAndTheScenariosJoint) {
  double mass = 0;
  for (const XMLElement* e = model->FirstChildElement("link"); e; e = e->NextSiblingElement("link"))
    mass += std::stod(e->FirstChildElement("inertial")->FirstChildElement("mass")->GetText());
  const auto robot =
      RobotModel::Load({scenario.cobot.model, scenario.folder(), scenario.cobot.remove_links, {}});
  const double expected = robot->mass() + LoadObject(scenario.object, scenario.folder()).mass;
  EXPECT_NEAR(mass, expected, 1e-8);
  int balls = 0, movable = 0;
  for (const XMLElement* e = model->FirstChildElement("joint"); e;
       e = e->NextSiblingElement("joint")) {
    const std::string type = e->Attribute("type");
    EXPECT_TRUE(parts.contains(e->FirstChildElement("child")->GetText()));
    if (type == "ball") {
      ++balls;
      const std::string damping = e->FirstChildElement("axis")
                                      ->FirstChildElement("dynamics")
                                      ->FirstChildElement("damping")
                                      ->GetText();
      EXPECT_EQ(std::stod(damping), scenario.object.attachment.damping);
    } else if (type != "fixed") {
      ++movable;
    }
  }
  const JointType joint = scenario.object.attachment.joint;
  const bool axis = joint == JointType::kRevolute || joint == JointType::kPrismatic;
  EXPECT_EQ(balls, joint == JointType::kSpherical ? 1 : 0);
  EXPECT_EQ(movable, robot->dof() + (axis ? 1 : 0));
}

TEST_P(SdfScene, HasTheFixturesAsBodiesThatNeverMove) {
  std::map<std::string, const XMLElement*> bodies;
  for (const XMLElement* e = world->FirstChildElement("model"); e;
       e = e->NextSiblingElement("model"))
    if (e->FirstChildElement("static")) bodies[e->Attribute("name")] = e;
  for (std::size_t i = 0; i < scenario.environment.fixtures.size(); ++i) {
    const std::string name = "fixture_" + std::to_string(i);
    ASSERT_TRUE(bodies.contains(name)) << name;
    EXPECT_FALSE(parts.contains(name)) << "part of the robot";
    const XMLElement* collision =
        bodies[name]->FirstChildElement("link")->FirstChildElement("collision");
    ASSERT_NE(collision, nullptr) << name;
    const double friction =
        scenario.environment.fixtures[i].friction.value_or(scenario.environment.friction);
    EXPECT_DOUBLE_EQ(collision->FirstChildElement("surface")
                         ->FirstChildElement("friction")
                         ->FirstChildElement("ode")
                         ->FirstChildElement("mu")
                         ->DoubleText(),
                     friction);
  }
}

TEST_P(SdfScene, HasTheMovableObjectsAsFreeModels) {
  std::map<std::string, const XMLElement*> bodies;
  for (const XMLElement* e = world->FirstChildElement("model"); e;
       e = e->NextSiblingElement("model"))
    if (std::string(e->Attribute("name")).starts_with("movable_")) bodies[e->Attribute("name")] = e;
  const std::vector<MovableSpec>& objects = scenario.environment.objects;
  ASSERT_EQ(bodies.size(), objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const XMLElement* body = bodies.at("movable_" + std::to_string(i));
    EXPECT_EQ(body->FirstChildElement("static"), nullptr);
    EXPECT_LT((PoseIn(*body).p - objects[i].xyz).norm(), 1e-12);
    EXPECT_LT(RotationError(PoseIn(*body).q, objects[i].X_WM().q).norm(), 1e-7);
    const XMLElement* link = body->FirstChildElement("link");
    const ObjectModel object =
        LoadObject({objects[i].model, objects[i].primitive, {}}, scenario.folder());
    EXPECT_NEAR(
        std::stod(link->FirstChildElement("inertial")->FirstChildElement("mass")->GetText()),
        object.mass, 1e-12);
    const XMLElement* collision = link->FirstChildElement("collision");
    ASSERT_NE(collision, nullptr);
    EXPECT_DOUBLE_EQ(collision->FirstChildElement("surface")
                         ->FirstChildElement("friction")
                         ->FirstChildElement("ode")
                         ->FirstChildElement("mu")
                         ->DoubleText(),
                     objects[i].friction.value_or(scenario.environment.friction));
  }
}

TEST_P(SdfScene, IsValidForGazebosChecker) {
  if (std::system("ign sdf --versions >/dev/null 2>&1") != 0 && !fs::exists("/usr/bin/ign"))
    GTEST_SKIP() << "ign is missing: apt-get install libsdformat-dev ignition-tools";
  FILE* pipe = popen(("ign sdf -k '" + File().string() + "' 2>&1").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string said;
  std::array<char, 4096> text;
  for (std::size_t n; (n = fread(text.data(), 1, text.size(), pipe)) > 0;)
    said.append(text.data(), n);
  const int status = pclose(pipe);
  // The checker may print "Valid." and still exit with 255, because it lacks a library that it
  // needs only for better error messages.
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  EXPECT_TRUE(code == 0 || code == 255) << code;
  EXPECT_NE(said.find("Valid."), std::string::npos) << said;
  EXPECT_EQ(said.find("Error"), std::string::npos) << said;
  EXPECT_EQ(said.find("Warning"), std::string::npos) << said;
}

std::string SceneNameOf(const testing::TestParamInfo<const char*>& scene) { return scene.param; }

INSTANTIATE_TEST_SUITE_P(Scenes, SdfScene,
                         testing::Values("box_9kg", "bar_circle", "dual_ur5", "linear_axis",
                                         "mobile_base", "hybrid_force_position", "slide_on_table",
                                         "drill", "push_boxes", "odd_spherical", "odd_fixed",
                                         "odd_revolute", "odd_prismatic"),
                         SceneNameOf);

}  // namespace
}  // namespace predictor::scene_export
