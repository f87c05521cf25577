// The stability that the program predicts for the sampled loop must agree with the simulation.
#include "simulation/sampled_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "world_fixtures.h"

namespace predictor {
namespace {

// Returns a scenario with a Panda that has no friction, motors that never saturate, a load, and
// springs in its joints.
Scenario SpringScene(const std::vector<std::string>& parameters) {
  Scenario s = FlangeScene("joint_impedance", parameters);
  s.cobot.effort_limit = {1e12};
  return s;
}

// Returns the rate at which a tiny motion grows in the simulation [1/s], between speeds that are
// far above rounding errors and far below those at which the model is no longer linear.
double SimulatedGrowth(const Scenario& s) {
  World world(s);
  EXPECT_TRUE(world.Step(Push(s, {1e-6, 2e-6, 1e-6}), kTick).ok());
  double time = 0, speed = 0;  // at the first speed above 1e-7 rad/s
  for (int k = 0; k < 5000; ++k) {
    EXPECT_TRUE(world.Step(HandsOff(s), kTick).ok());
    const double now = world.state().v.norm();
    if (speed > 0 && now > 1e-3) return std::log(now / speed) / (world.state().time - time);
    if (speed > 0 || now < 1e-7) continue;
    speed = now;
    time = world.state().time;
  }
  return 0;
}

TEST(SampledLoop, OfAnOrdinaryControllerIsStable) {
  EXPECT_TRUE(World(BoxScene(9)).JudgeController().is_stable());
  EXPECT_TRUE(World(SpringScene({"joint_stiffness=300"})).JudgeController().is_stable());
}

// In continuous time, no damper would be too strong, but the sampled loop becomes unstable.
TEST(SampledLoop, OfATooStrongDamperGrowsAsInTheSimulation) {
  const Scenario s = SpringScene({"joint_stiffness=20000", "joint_damping_ratio=1.2"});
  const SampledLoop loop = World(s).JudgeController();
  EXPECT_FALSE(loop.is_stable());
  EXPECT_GT(loop.damping, 0);
  EXPECT_NEAR(SimulatedGrowth(s), loop.growth, 0.1 * loop.growth);
}

// The damping of this controller is proportional to its damping ratio, so that the suggested remedy
// can be tested.
TEST(SampledLoop, NamesTheDampingWithWhichItIsStable) {
  const auto with = [](double ratio) {
    return World(SpringScene(
                     {"joint_stiffness=2000", "joint_damping_ratio=" + std::to_string(ratio)}))
        .JudgeController();
  };
  const SampledLoop loop = with(5);
  ASSERT_FALSE(loop.is_stable());
  ASSERT_GT(loop.stable_damping, 0);
  EXPECT_TRUE(with(5 * loop.stable_damping).is_stable());
  EXPECT_FALSE(with(5 * loop.stable_damping / 0.8).is_stable());
}

TEST(SampledLoop, NamesTheJointWhoseSpringIsTooStiff) {
  const SampledLoop loop =
      World(SpringScene({"joint_stiffness=[300, 300, 300, 300, 300, 300, 100000]",
                         "joint_damping_ratio=0"}))
          .JudgeController();
  ASSERT_FALSE(loop.is_stable());
  EXPECT_EQ(loop.joint, 6);
  EXPECT_NEAR(loop.stiffness, 100000, 100);
  EXPECT_GT(loop.stable_stiffness, 0);
}

// The period and the delay of the controller are part of the loop.
TEST(SampledLoop, WithADelayGrowsAsInTheSimulation) {
  Scenario s = SpringScene({"joint_stiffness=600", "joint_damping_ratio=0.1"});
  EXPECT_TRUE(World(s).JudgeController().is_stable());
  s.cobot.control.rate = 500;
  s.cobot.control.delay = 0.003;
  const SampledLoop loop = World(s).JudgeController();
  ASSERT_FALSE(loop.is_stable());
  EXPECT_NEAR(SimulatedGrowth(s), loop.growth, 0.1 * loop.growth);
}

}  // namespace
}  // namespace predictor
