// Compares two values of the largest wall stiffness at which the haptic loop is stable. One value
// is from the linear loop with a spring and a damper. The other is from the simulation of an object
// that touches a fixture.
#include <gtest/gtest.h>

#include <cstdio>

#include "analysis/check/contact.h"
#include "analysis/stability_map/growth.h"
#include "scenarios.h"
#include "simulation/world.h"
#include "support/soak.h"

namespace predictor {
namespace {

constexpr double kWallDamping = 5;    // [N·s/m]
constexpr double kPressed = 0.06;     // lift of the object by the wall, for 30 N [m]
constexpr double kBallRadius = 0.05;  // the wall is a ball, so that one point touches [m]

struct ArmLoop {
  double bandwidth, delay;  // [Hz], [s]
};

Scenario LoopWith(const ArmLoop& arm, double hand_mass) {
  // The cobot's damping is low, because high damping would hide the damping of the loop. If the box
  // hung on a joint or the cobot were compliant sideways, the box would slip off the ball.
  Scenario s = Load(
      "box_9kg.yaml",
      {"object.attachment.joint=fixed", "cobot.controller.stiffness.translation=[300, 300, 500]",
       "cobot.controller.damping_ratio=0.3", "rendering.lead=0",
       "operator.hand.stiffness=[60, 60, 60]", "operator.hand.visual_stiffness=[0, 0, 0]"});
  s.operator_.hand.mass = hand_mass;
  for (ArmSpec* spec : {&*s.device.left, &*s.device.right}) {
    spec->loop.bandwidth = arm.bandwidth;
    spec->loop.delay = arm.delay;
    // Quantisation steps of the readings would excite the oscillation again after it has decayed.
    spec->sensor.force_resolution = spec->sensor.torque_resolution = 1e-9;
  }
  return s;
}

Vector3 MiddleOfLowerFace(const Pose& X_WO) { return X_WO * Vector3(0, 0, -0.1); }

WallLimit Predicted(const Scenario& s) {
  const World world(s);
  const Pose X_WO = world.state().object.X_W;
  Wall wall;
  wall.p_DC = MiddleOfLowerFace(X_WO) - X_WO * s.handle(0).pose.xyz;
  wall.damping = kWallDamping;
  return StiffestStableWall(world.Linearise(), s, s.operator_.hand, 0, wall, LoopModel::kExact);
}

bool Grows(Scenario s, double stiffness) {
  FixtureSpec ball;
  ball.shape = FixtureShape::kSphere;
  ball.size = {kBallRadius, 0, 0};
  ball.xyz = MiddleOfLowerFace(World(s).state().object.X_W) + Vector3(0, 0, kPressed - kBallRadius);
  ball.friction = 0;
  ball.stiffness = stiffness;
  ball.damping = kWallDamping;
  s.environment.fixtures = {ball};
  const Growth growth = MeasureGrowth(s, 0);
  // Once a disturbance has decayed, the measured rate is that of rounding errors, which is about 0.
  // If there is no rate, a limit acted from the start.
  return growth.grows && growth.rate.value_or(1) > 0.1;
}

// The full test covers 24 points, the short test three of them.
TEST(WallLimit, IsAsPredictedSoak) {
  int point = 0, compared = 0;
  for (const ArmLoop arm : {ArmLoop{15, 0.004}, {10, 0.008}, {8, 0.010}, {10, 0.012}})
    for (const double mass : {2.5, 3.0, 3.5, 4.0, 5.0, 6.0}) {
      if (!InFull() && point++ % 8 != 3) continue;
      const Scenario s = LoopWith(arm, mass);
      const WallLimit limit = Predicted(s);
      std::printf("%2.0f Hz, %2.0f ms, %.1f kg: %6.0f N/m, %.1f Hz\n", arm.bandwidth,
                  1e3 * arm.delay, mass, limit.stiffness, limit.frequency);
      ASSERT_TRUE(limit.reached && limit.stiffness > 0);
      EXPECT_FALSE(Grows(s, 0.8 * limit.stiffness));
      EXPECT_TRUE(Grows(s, 1.2 * limit.stiffness));
      ++compared;
    }
  EXPECT_EQ(compared, InFull() ? 24 : 3);
  std::printf("soak: count=%d\n", compared);
}

}  // namespace
}  // namespace predictor
