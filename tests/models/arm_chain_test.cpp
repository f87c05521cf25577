// Tests the chains of the arms of real robots. The chains do not include grippers, wheels, heads
// and further arms.
#include "models/arm_chain.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "models/robots.h"

namespace predictor {
namespace {

UrdfModel Robot(const std::string& path) {
  return ReadUrdf(ResolveModelPath("package://example-robot-data/robots/" + path, "."));
}

using Names = std::vector<std::string>;

TEST(ArmChain, EndsAtTheGripper) {
  const struct {
    const char *urdf, *end_effector;
    std::size_t joints;
    Names removed;
  } cases[] = {{"ur_description/urdf/ur5_robot.urdf", "tool0", 6, {}},
               {"kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", 6, {}},
               // The hand has two prismatic joints, one of which follows the other.
               {"panda_description/urdf/panda.urdf",
                "panda_hand_tcp",
                7,
                {"panda_leftfinger", "panda_rightfinger"}},
               // The gripper's only joint looks like a further joint of the wrist.
               {"z1_description/urdf/z1.urdf", "gripperStator", 6, {"gripperMover"}},
               {"so_arm_description/urdf/so100.urdf", "gripper", 5, {"jaw"}},
               {"so_arm_description/urdf/so101.urdf",
                "gripper_frame_link",
                5,
                {"moving_jaw_so101_v1_link"}}};
  for (const auto& c : cases) {
    const ArmChain arm = FindArm(Robot(c.urdf));
    EXPECT_EQ(arm.end_effector, c.end_effector);
    EXPECT_EQ(arm.joints.size(), c.joints) << c.urdf;
    EXPECT_EQ(arm.remove_links, c.removed) << c.urdf;
    EXPECT_EQ(arm.removed_mass > 0, !c.removed.empty()) << c.urdf;
  }
}

TEST(ArmChain, OfSeveralArmsIsOneOrTheOneOfTheGivenLink) {
  const UrdfModel baxter = Robot("baxter_description/urdf/baxter.urdf");
  EXPECT_EQ(FindArm(baxter).joints.size(), 7U);
  const ArmChain left = FindArm(baxter, "left_gripper");
  EXPECT_EQ(left.joints,
            (Names{"left_s0", "left_s1", "left_e0", "left_e1", "left_w0", "left_w1", "left_w2"}));
  EXPECT_NE(std::ranges::find(left.remove_links, "head"), left.remove_links.end());
  EXPECT_NE(std::ranges::find(left.remove_links, "right_upper_shoulder"), left.remove_links.end());
  // The remaining model must have only the joints of the chain, and its mass must be that of the
  // robot minus the removed mass.
  const UrdfModel rest = ReadUrdf(baxter.file, left.remove_links);
  EXPECT_EQ(RobotModel::Build(rest, {})->dof(), 7);
  EXPECT_NEAR(rest.Mass() + left.removed_mass, baxter.Mass(), 1e-9);
}

std::string Link(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial></link>";
}
std::string Joint(const std::string& name, const std::string& parent,
                  const std::string& more = "") {
  return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" +
         name + "'/><limit lower='-1' upper='1' velocity='1' effort='1'/>" + more + "</joint>";
}
// Returns a chain of joints a0, a1, .... Each joint is the parent of the next one.
std::string Chain(int joints) {
  std::string text = Link("base");
  for (int j = 0; j < joints; ++j)
    text += Link("a" + std::to_string(j)) +
            Joint("a" + std::to_string(j), j == 0 ? "base" : "a" + std::to_string(j - 1));
  return text;
}
ArmChain ArmOf(const std::string& text) {
  return FindArm(ParseUrdf("<robot name='r'>" + text + "</robot>", "r.urdf", "."));
}

TEST(ArmChain, EndsWhereAHandBeginsWhateverItsNames) {
  const std::string two =
      Link("x") + Link("y") + Link("z") + Joint("x", "a5") + Joint("y", "x") + Joint("z", "a5");
  EXPECT_EQ(ArmOf(Chain(6) + two).remove_links, (Names{"x", "z"}));
  // A branch close to the base belongs to another arm, so its links must be removed.
  const std::string arm = Link("x") + Joint("x", "a1");
  EXPECT_EQ(ArmOf(Chain(6) + arm).end_effector, "a5");
  EXPECT_EQ(ArmOf(Chain(6) + arm).remove_links, Names{"x"});
}

TEST(ArmChain, EndsAtCoupledJointsUnlessTheArmContinues) {
  const std::string follows = "<mimic joint='a5'/>";
  EXPECT_EQ(ArmOf(Chain(6) + Link("x") + Joint("x", "a4", follows)).end_effector, "a4");
  EXPECT_EQ(ArmOf(Chain(6) + Link("x") + Joint("x", "a5", "<mimic joint='a2'/>")).end_effector,
            "a5");  // a2 carries the rest of the arm
}

TEST(ArmChain, RefusesALinkThatDoesNotExistOrMove) {
  const UrdfModel ur = Robot("ur_description/urdf/ur5_robot.urdf");
  for (const auto& [link, says] : {std::pair{"tool1", "Did you mean tool0?"},
                                   std::pair{"base_link", "No joint moves link \"base_link\""}}) {
    try {
      FindArm(ur, link);
      ADD_FAILURE() << link;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace predictor
