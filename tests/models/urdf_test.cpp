#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/error.h"
#include "models/mujoco_urdf.h"
#include "models/object_model.h"
#include "models/robots.h"
#include "support/text.h"

namespace predictor::test {
namespace {

constexpr const char* kPanda =
    "package://example-robot-data/robots/panda_description/urdf/panda.urdf";

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

UrdfModel Panda(const std::vector<std::string>& remove_links = {}) {
  return ReadUrdf(ResolveModelPath(kPanda, "."), remove_links);
}

TEST(Urdf, ReadsWhatTheFileSays) {
  const UrdfModel panda = Panda();
  EXPECT_EQ(panda.name, "panda");
  ASSERT_EQ(panda.links.size(), 13u);
  EXPECT_EQ(panda.links[static_cast<std::size_t>(panda.root)].name, "panda_link0");
  const UrdfLink& link1 = panda.links[1];
  EXPECT_EQ(link1.name, "panda_link1");
  EXPECT_EQ(link1.mass, 4.970684);
  EXPECT_EQ(link1.com, Vector3(0.003875, 0.002081, -0.04762));
  EXPECT_EQ(link1.inertia(0, 2), 0.006772);
  ASSERT_EQ(link1.visuals.size(), 1u);
  EXPECT_EQ(link1.visuals[0].kind, ShapeKind::kMesh);
  EXPECT_TRUE(link1.visuals[0].mesh.is_absolute());
  const UrdfJoint& joint4 = panda.joints[3];
  EXPECT_EQ(joint4.name, "panda_joint4");
  EXPECT_EQ(joint4.lower, -3.0718);
  EXPECT_EQ(joint4.upper, -0.0698);
  EXPECT_EQ(joint4.velocity, 2.175);
  EXPECT_EQ(joint4.effort, 87);
  EXPECT_EQ(joint4.axis, Vector3::UnitZ());
}

TEST(Urdf, RemovesLinksWithTheirSubtrees) {
  const UrdfModel whole = Panda();
  const UrdfModel arm = Panda({"panda_hand"});
  EXPECT_EQ(arm.links.size(), 9u);
  EXPECT_EQ(arm.links.back().name, "panda_link8");
  EXPECT_EQ(arm.joints.size(), 8u);
  EXPECT_NEAR(whole.Mass() - arm.Mass(), 0.73 + 2 * 0.015, 1e-12);
  EXPECT_FALSE(Contains(arm.text, "panda_hand"));
  EXPECT_FALSE(Contains(arm.text, "finger"));
  const UrdfModel again = ParseUrdf(arm.text, "again.urdf", ".");
  EXPECT_EQ(again.LinkNames(), arm.LinkNames());
}

TEST(Urdf, RemovingReportsUnknownLinks) {
  EXPECT_TRUE(Contains(MessageOf([] { Panda({"panda_hnad"}); }), "Did you mean panda_hand?"));
  EXPECT_TRUE(Contains(MessageOf([] { Panda({"panda_link0"}); }), "\"panda_link0\" is the root"));
}

TEST(Urdf, MimicJointsAreJointsOfTheirOwn) {
  const UrdfModel panda = Panda();
  EXPECT_FALSE(Contains(panda.text, "<mimic"));
  EXPECT_EQ(RobotModel::Build(panda, {})->dof(), 9);
}

TEST(Urdf, DefaultsAreThoseOfTheStandard) {
  const UrdfModel tree = ParseUrdf(kTreeUrdf, "tree.urdf", ".");
  const auto joint = [&tree](const std::string& name) {
    for (const UrdfJoint& j : tree.joints) {
      if (j.name == name) return j;
    }
    throw std::out_of_range(name);
  };
  EXPECT_EQ(joint("default_axis").axis, Vector3::UnitX());
  EXPECT_NEAR(joint("turn").axis.norm(), 1, 1e-15);
  EXPECT_EQ(joint("turn").lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(joint("turn").velocity, std::numeric_limits<double>::infinity());
  EXPECT_LT(PoseError(joint("weld").X_PJ, PoseFromXyzRpy({0, 0.1, 0.3}, {0.2, 0, 1})).norm(),
            1e-15);
}

TEST(Urdf, RoundedInertiaIsRepairedNotRefused) {
  // The plate's third moment is rounded up, and the rod has no moment about its axis.
  const std::string text = R"(<robot name="r"><link name="base"/>
    <link name="plate"><inertial><mass value="1"/>
      <inertia ixx="0.333333" iyy="0.333333" izz="0.6666663"/></inertial></link>
    <link name="rod"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0" izz="0.1"/></inertial></link>
    <joint name="j" type="continuous"><parent link="base"/><child link="plate"/></joint>
    <joint name="k" type="continuous"><parent link="plate"/><child link="rod"/></joint></robot>)";
  const UrdfModel model = ParseUrdf(text, "rounded.urdf", ".");
  const Matrix3& plate = model.links[1].inertia;
  const Matrix3& rod = model.links[2].inertia;
  EXPECT_GE(plate(0, 0) + plate(1, 1), plate(2, 2));
  EXPECT_LT((plate - Vector3(0.333333, 0.333333, 0.6666663).asDiagonal().toDenseMatrix()).norm(),
            1e-6);
  EXPECT_GT(rod(1, 1), 0);
  EXPECT_LT(rod(1, 1), 1e-7);
  EXPECT_EQ(ParseUrdf(model.text, "again.urdf", ".").links[1].inertia, plate);
}

TEST(Urdf, TextForMujocoHasNoShapesUnlessAsked) {
  const UrdfModel bar = ReadUrdf(PREDICTOR_SOURCE_DIR "/assets/bar.urdf");
  EXPECT_FALSE(Contains(MujocoUrdf(bar), "<geometry"));
  EXPECT_TRUE(Contains(MujocoUrdf(bar, MujocoShapes::kCollisions), "<collision"));
  EXPECT_FALSE(Contains(MujocoUrdf(bar, MujocoShapes::kCollisions), "<visual"));
  EXPECT_FALSE(Contains(MujocoUrdf(Panda()), "<dynamics"));
}

TEST(Robot, NamesTheNearestLink) {
  const auto robot = RobotModel::Build(Panda(), {});
  EXPECT_TRUE(
      Contains(MessageOf([&] { robot->Frame("panda_lnk8"); }), "Did you mean panda_link8?"));
}

TEST(Robot, RefusesModelsThatAreNotArms) {
  EXPECT_TRUE(Contains(MessageOf([] {
                         RobotModel::Load({"assets/bar.urdf", PREDICTOR_SOURCE_DIR, {}, {}});
                       }),
                       "no moving joint"));
  const std::string humanoid =
      "package://example-robot-data/robots/simple_humanoid_description/urdf/simple_humanoid.urdf";
  EXPECT_TRUE(Contains(MessageOf([&] {
                         RobotModel::Load({humanoid, ".", {}, {}});
                       }),
                       "29 moving joints, but at most 16"));
}

TEST(Objects, HaveTheMassesTheyAreNamedBy) {
  const std::string assets = PREDICTOR_SOURCE_DIR "/assets/";
  const ObjectModel small = ReadObject(assets + "box_9kg.urdf");
  EXPECT_EQ(small.mass, 9);
  EXPECT_EQ(small.com, Vector3::Zero());
  ASSERT_EQ(small.collisions.size(), 1u);
  EXPECT_EQ(small.collisions[0].size, Vector3(0.26, 0.38, 0.2));
  EXPECT_EQ(ReadObject(assets + "box_18kg.urdf").mass, 18);
  const ObjectModel bar = ReadObject(assets + "bar.urdf");
  EXPECT_NEAR(bar.mass, 2.1, 1e-12);
  EXPECT_LT(bar.com.norm(), 1e-12);
  EXPECT_EQ(bar.visuals.size(), 3u);
  EXPECT_GT(bar.visuals[1].X_LG.p.y(), 0.1);  // the handles, left and right of the middle
  EXPECT_EQ(bar.visuals[1].X_LG.p, -bar.visuals[2].X_LG.p);
}

// The files must give the inertias of uniform boxes.
TEST(Objects, BoxesAreUniform) {
  for (const auto& [name, size] :
       {std::pair{"box_9kg", Vector3(0.26, 0.38, 0.2)}, {"box_18kg", Vector3(0.26, 0.76, 0.2)}}) {
    const ObjectModel box =
        ReadObject(std::string(PREDICTOR_SOURCE_DIR "/assets/") + name + ".urdf");
    PrimitiveSpec uniform;
    uniform.size = size;
    uniform.mass = box.mass;
    EXPECT_LT((box.inertia - MakeObject(uniform).inertia).norm(), 1e-6);
  }
}

TEST(Objects, AreOneRigidBody) {
  const std::string message = MessageOf([] { MakeObject(Panda()); });
  EXPECT_TRUE(Contains(message, "\"panda_joint1\" of the object moves")) << message;
  const UrdfModel empty = ParseUrdf(R"(<robot name="e"><link name="a"/></robot>)", "e.urdf", ".");
  EXPECT_TRUE(Contains(MessageOf([&] { MakeObject(empty); }), "needs a mass"));
}

TEST(Objects, PrimitivesThatCannotBeAreRefused) {
  const auto message = [](const std::function<void(PrimitiveSpec*)>& change) {
    PrimitiveSpec primitive;
    change(&primitive);
    return MessageOf([&] { MakeObject(primitive); });
  };
  EXPECT_EQ(message([](PrimitiveSpec*) {}), "");
  EXPECT_TRUE(Contains(message([](PrimitiveSpec* p) { p->mass = -1; }), "mass is -1 kg"));
  EXPECT_TRUE(Contains(message([](PrimitiveSpec* p) { p->mass = NAN; }), "mass is nan kg"));
  EXPECT_TRUE(Contains(message([](PrimitiveSpec* p) { p->size.y() = 0; }), "greater than 0"));
  EXPECT_TRUE(Contains(message([](PrimitiveSpec* p) { p->inertia = Vector3(1, 1, 3); }),
                       "physically impossible"));
  EXPECT_TRUE(Contains(message([](PrimitiveSpec* p) { p->inertia = Vector3(1, 1, 0); }), "finite"));
}

}  // namespace
}  // namespace predictor::test
