// What `check` says about cobot and object at the start must agree with geometry and equilibrium.
#include "analysis/check/start.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "analysis/scenarios.h"
#include "models/arm_model.h"
#include "support/text.h"

namespace predictor {
namespace {

constexpr double kStiffness = 500;  // vertical stiffness of the scenario's controller [N/m]

// Returns a scenario with the tutorial's cobot, which consists of cylinders. With all joints at
// zero, the cobot stands upright. The upper arm has a radius of 60 mm and extends from 0.3 m to 0.7
// m. The last wrist link extends to 1.3 m and the flange to 1.31 m.
Scenario Cylinders() {
  Scenario s = Load("box_9kg.yaml");
  s.file = PREDICTOR_SOURCE_DIR "/docs/tutorials/own.yaml";
  s.cobot.model = "my_cobot.urdf";
  s.cobot.end_effector = "flange";
  s.cobot.remove_links.clear();
  s.object.model.clear();
  s.object.primitive = PrimitiveSpec{.size = {0.2, 0.2, 0.2}};
  return s;
}

ObjectGaps GapsAt(const Vector3& p_WO) {
  return LinkGaps(Cylinders()).At(JointVector::Zero(6), {p_WO, Quaternion::Identity()});
}

TEST(LinkGaps, AreTheDistancesOfTheShapes) {
  const LinkGap beside = GapsAt({0.5, 0, 0.5}).links;
  EXPECT_EQ(beside.link, "upper_arm");
  EXPECT_NEAR(beside.distance, 0.5 - 0.1 - 0.06, 1e-6);
  const LinkGap inside = GapsAt({0.1, 0, 0.5}).links;
  EXPECT_EQ(inside.link, "upper_arm");
  EXPECT_NEAR(inside.distance, 0.1 - 0.1 - 0.06, 1e-6);
  const ObjectGaps above = GapsAt({0, 0, 1.5});
  EXPECT_EQ(above.hand.link, "flange");
  EXPECT_NEAR(above.hand.distance, 1.5 - 0.1 - 1.31, 1e-6);
  EXPECT_EQ(above.links.link, "wrist_2");
  EXPECT_NEAR(above.links.distance, 1.5 - 0.1 - 1.3, 1e-6);
}

// The engine cannot read this robot's meshes.
TEST(LinkGaps, UseBarsBetweenTheJointsForMeshesThatCannotBeRead) {
  Scenario s = Cylinders();
  s.cobot.model = "package://example-robot-data/robots/kinova_description/robots/kinova.urdf";
  s.cobot.end_effector = "j2s6s200_link_6";
  s.cobot.remove_links.clear();
  const auto model = RobotModel::Load({s.cobot.model, s.folder(), {}, {}});
  RobotData data(*model);
  const JointVector q = JointVector::Zero(model->dof());
  data.UpdateKinematics(*model, q, q);
  const Vector3 elbow = data.FramePose(*model, model->Frame("j2s6s200_link_3")).p;
  const LinkGaps gaps(s);
  EXPECT_LT(gaps.At(q, {elbow, Quaternion::Identity()}).links.distance, -0.05);
  EXPECT_GT(gaps.At(q, {elbow + Vector3(1.5, 0, 0), Quaternion::Identity()}).links.distance, 0.3);
}

StartReport Describe(const Scenario& s, const World& world) {
  return DescribeStart(s, *LoadCobotModel(s), world);
}

Scenario Box() {
  Scenario s = Load("box_9kg.yaml");
  s.object.model.clear();
  s.object.primitive = PrimitiveSpec{.size = {0.3, 0.3, 0.2}, .mass = 9};
  return s;
}

// The floor carries the part of the weight that the spring of the sagging cobot does not carry.
TEST(Start, OfAnObjectOnTheFloorDividesItsWeight) {
  const World hanging(Box());
  const StartReport free = Describe(Box(), hanging);
  EXPECT_EQ(free.support.floor, 0);
  const double bottom = hanging.state().object.X_W.p.z() - 0.1;
  for (const double lower : {0.05, 0.1}) {
    Scenario s = Box();
    s.cobot.base.xyz.z() -= bottom + lower;
    const StartReport start = Describe(s, World(s));
    const double sag =
        free.weight / kStiffness + free.flange.z() - bottom - lower - start.flange.z();
    EXPECT_NEAR(start.support.floor, start.weight - kStiffness * sag, 0.05) << lower;
    EXPECT_NEAR(start.support.floor, kStiffness * lower, 1) << lower;
    EXPECT_EQ(start.support.other, 0);
    EXPECT_EQ(StartWarnings(start).size(), 1u);
  }
}

TEST(Start, OfAnObjectInsideTheCobotWarns) {
  Scenario s = Box();
  EXPECT_TRUE(StartWarnings(Describe(s, World(s))).empty());
  s.object.attachment.on_end_effector.xyz = {0, 0, -0.15};  // above the flange, in the wrist
  const StartReport start = Describe(s, World(s));
  EXPECT_LT(start.gaps.links.distance, -0.01);
  EXPECT_FALSE(start.is_outside);
  EXPECT_EQ(StartWarnings(start).size(), 2u);  // the wrist, and the end-effector itself
}

// Joints connect neighbouring links of the Panda, and the object hangs at link 8, which is fixed to
// link 7.
TEST(Start, ListsThePairsOfCobotTouchesWithTheirReasons) {
  Scenario s = Box();
  std::string text;
  AddStart(Describe(s, World(s)), &text);
  EXPECT_FALSE(Contains(text, "cobot.touches"));
  s.cobot.touches = {"object", "cobot"};
  const StartReport start = Describe(s, World(s));
  text.clear();
  AddStart(start, &text);
  EXPECT_TRUE(Contains(text,
                       "  cobot.touches    the object can touch panda_link0, panda_link1, "
                       "panda_link2, panda_link3, panda_link4, panda_link5, panda_link6\n"))
      << text;
  EXPECT_TRUE(Contains(text, "  cobot.touches    panda_link5 can touch panda_link7\n")) << text;
  EXPECT_TRUE(
      Contains(text, "  no contact       connected by a joint: panda_link0 and panda_link1, "))
      << text;
  EXPECT_TRUE(
      Contains(text, "  no contact       hand and what it holds: panda_link7 and the object\n"))
      << text;
  // The nearest link that does not hold the object was found by another class.
  double nearest = kFarthestPair;
  for (const ContactPair& pair : start.pairs)
    if (pair.other.empty() && pair.state == PairState::kCanTouch)
      nearest = std::min(nearest, pair.distance);
  EXPECT_NEAR(nearest, start.gaps.links.distance, 1e-6);
}

}  // namespace
}  // namespace predictor
