// The example controllers must suit arms whose last links are light.
#include <gtest/gtest.h>

#include "support/plugins.h"
#include "world_fixtures.h"

namespace predictor {
namespace {

// Returns a scenario with an xArm7 without friction, whose last link has an inertia of 1.3e-4 kg·m²
// about its joint.
Scenario LightWrist(const ControllerSpec& controller) {
  Scenario s = BoxScene(3);
  s.cobot.model = "package://example-robot-data/robots/xarm_description/urdf/xarm7.urdf";
  s.cobot.remove_links = {};
  s.cobot.end_effector = "link_eef";
  s.cobot.posture = {0, -0.5, 0, 1.0, 0, 1.5, 0};  // the flange faces down
  s.cobot.effort_limit = {100};
  s.cobot.controller = controller;
  return s;
}

// Returns the number of steps in which the torque of a joint is at its limit.
int StepsAtTheLimit(const Scenario& s) {
  World world(s);
  int steps = 0;
  const auto count = [&](const WorldState& state) {
    steps += (state.torque.cwiseAbs().array() >= world.effort_limit().array()).any();
  };
  Simulate(&world, Push(s, {0, 10, 5}), 0.5, count);
  Simulate(&world, HandsOff(s), 0.5, count);
  return steps;
}

TEST(PluginExamples, DoNotChatterAtALightWrist) {
  const std::string documented = "joint_stiffness=200 damping_rate=100";
  for (const ControllerSpec& controller :
       {test::Plugin("joint_impedance", documented), test::Plugin("joint_impedance"),
        test::PythonExample(documented), test::Plugin("following_spring")}) {
    const Scenario s = LightWrist(controller);
    EXPECT_EQ(StepsAtTheLimit(s), 0) << controller.type;
    EXPECT_TRUE(World(s).JudgeController().is_stable()) << controller.type;
  }
}

// With a damper that ignores the inertia, the joint chatters. This test thus shows that the
// previous test can fail.
TEST(PluginExamples, WouldChatterWithADamperThatIgnoresTheInertia) {
  const Scenario s =
      LightWrist(test::Plugin("joint_impedance", "joint_stiffness=200 damping_rate=3000"));
  EXPECT_GT(StepsAtTheLimit(s), 100);
  EXPECT_FALSE(World(s).JudgeController().is_stable());
}

}  // namespace
}  // namespace predictor
