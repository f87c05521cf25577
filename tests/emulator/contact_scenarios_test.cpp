// Tests the scenarios in which the object touches its surroundings. The test computes penetrations
// from the recorded poses and the shapes in the scenario, without the physics engine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "runs.h"

namespace predictor {
namespace {

constexpr double kMaxDepth = 1e-4;  // [m]

// Returns the distance of a point from the surface of a box [m], which is negative inside.
double DistanceFrom(const FixtureSpec& box, const Vector3& p_W) {
  const Vector3 out = (box.X_WG().Inverse() * p_W).cwiseAbs() - box.size / 2;
  return out.cwiseMax(0).norm() + std::min(0.0, out.maxCoeff());
}

// Returns how deep a ball, whose centre moves along the segment from a to b, enters a fixture [m].
// A negative value is a gap. The segment is sampled.
double DepthOfCapsule(const FixtureSpec& box, const Vector3& a, const Vector3& b, double radius) {
  constexpr int kPoints = 20;
  double depth = -HUGE_VAL;
  for (int i = 0; i <= kPoints; ++i)
    depth = std::max(depth, radius - DistanceFrom(box, a + (b - a) * i / kPoints));
  return depth;
}

TEST(ContactScenarios, APegGoesIntoAHoleWithOneMillimetreOfClearance) {
  const Scenario scenario = LoadTestScenario("peg_in_hole");
  const auto& fixtures = scenario.environment.fixtures;
  const FixtureSpec& bottom = fixtures.back();
  const double floor = bottom.xyz.z() + bottom.size.z() / 2;          // [m]
  const double rim = fixtures[0].xyz.z() + fixtures[0].size.z() / 2;  // [m]
  constexpr double kRadius = 0.02, kTip = 0.14;  // from peg_bar.urdf; the tip is kTip below O [m]
  // The inner faces are 20.5 mm from the hole's axis.
  const Vector3 axis(bottom.xyz.x(), bottom.xyz.y(), 0);
  for (std::size_t i = 0; i + 1 < fixtures.size(); ++i) {
    const Vector3 to = Vector3(fixtures[i].xyz.x(), fixtures[i].xyz.y(), 0) - axis;
    EXPECT_NEAR(to.norm() - fixtures[i].size.x() / 2, kRadius + 0.0005, 2e-6) << i;
  }
  double deepest = -HUGE_VAL, first_tip = HUGE_VAL, lowest_tip = HUGE_VAL;
  int touching = 0;
  const TestRun run = RunScenario("peg_in_hole", {}, [&](const TickRecord& record) {
    const Pose X = ObjectOf(record);
    const double tip = (X * Vector3(0, 0, -kTip)).z();
    if (first_tip == HUGE_VAL) first_tip = tip;
    lowest_tip = std::min(lowest_tip, tip);
    double depth = -HUGE_VAL;
    for (const FixtureSpec& fixture : fixtures)
      depth = std::max(depth, DepthOfCapsule(fixture, X * Vector3(0, 0, -0.02),
                                             X * Vector3(0, 0, kRadius - kTip), kRadius));
    touching += depth > 0 ? 1 : 0;
    deepest = std::max(deepest, depth);
  });
  EXPECT_TRUE(EndsWell(run));
  EXPECT_GT(first_tip, rim + 0.02);
  EXPECT_NEAR(lowest_tip, floor, 2e-4);  // 100 mm into the hole
  EXPECT_GT(touching, 500);
  EXPECT_LE(deepest, kMaxDepth);
  RecordProperty("deepest_um", static_cast<int>(deepest * 1e6));
}

// Returns how deep the bar enters the box [m], from the corners of its cross-sections, including
// those of its ends.
double DepthOfBar(const FixtureSpec& box, const Pose& X) {
  constexpr int kSections = 90;
  double depth = -HUGE_VAL;
  for (int i = 0; i <= kSections; ++i)
    for (const double x : {-0.02, 0.02})
      for (const double z : {-0.02, 0.02})
        depth = std::max(depth, -DistanceFrom(box, X * Vector3(x, -0.45 + 0.9 * i / kSections, z)));
  return depth;
}

TEST(ContactScenarios, ABarPassesADoorwayOnlyIfItIsTilted) {
  const auto& posts = LoadTestScenario("doorway").environment.fixtures;
  const double near_side = posts[0].xyz.x() + posts[0].size.x() / 2;  // [m]
  const double far_side = posts[0].xyz.x() - posts[0].size.x() / 2;   // [m]
  for (const bool tilted : {true, false}) {
    double last_x = 0, deepest = -HUGE_VAL;
    const std::vector<std::string> set =
        tilted ? std::vector<std::string>{}
               : std::vector<std::string>{"operator.script.1.rotate_by=[0.1 deg, 0, 0]",
                                          "operator.script.3.rotate_by=[-0.1 deg, 0, 0]"};
    const TestRun run = RunScenario("doorway", set, [&](const TickRecord& record) {
      const Pose X = ObjectOf(record);
      last_x = X.p.x();
      if (record.tick % 10 != 0) return;
      for (std::size_t i = 0; i < 2; ++i) deepest = std::max(deepest, DepthOfBar(posts[i], X));
    });
    EXPECT_LE(deepest, kMaxDepth);
    if (tilted) {
      EXPECT_TRUE(EndsWell(run));
      EXPECT_LT(last_x, far_side - 0.02);
    } else {
      EXPECT_GT(last_x, near_side);
      EXPECT_GT(deepest, 0);
    }
  }
}

TEST(ContactScenarios, APlateCarriesTheForceOfADrill) {
  const Scenario scenario = LoadTestScenario("drill");
  const FixtureSpec& plate = scenario.environment.fixtures[0];
  constexpr double kTip = 0.225;  // distance below O in drill.urdf [m]
  double deepest = -HUGE_VAL;
  Vector3 force = Vector3::Zero();
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  int ticks = 0;
  const TestRun run = RunScenario("drill", {}, [&](const TickRecord& record) {
    const Vector3 tip = ObjectOf(record) * Vector3(0, 0, -kTip);
    const double height = tip.z() - plate.xyz.z() - plate.size.z() / 2;
    deepest = std::max(deepest, -height);
    if (record.run_time < 8 || record.run_time > 10.5) return;  // both hands push
    ++ticks;
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    for (const HandRecord& hand : record.hands)
      force += Vector3(hand.true_wrench[0], hand.true_wrench[1], hand.true_wrench[2]);
  });
  EXPECT_TRUE(EndsWell(run));
  ASSERT_GT(ticks, 1000);
  EXPECT_NEAR(force.z() / ticks, -40, 6);  // the hands also resist displacement
  EXPECT_LE(deepest, kMaxDepth);
  EXPECT_LT(highest - lowest, kMaxDepth);
}

}  // namespace
}  // namespace predictor
