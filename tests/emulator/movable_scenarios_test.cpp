// Tests the scenario in which the carried box pushes a crate. The test computes places and
// penetrations from the recorded poses and the shapes of the scenario, without the physics engine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "runs.h"

namespace predictor {
namespace {

constexpr double kMaxDepth = 2e-4;           // [m]
const Vector3 kBoxHalf = {0.13, 0.19, 0.1};  // of box_9kg.urdf [m]

// Returns the height of the lowest corner of a box [m].
double LowestOf(const Pose& X, const Vector3& half) {
  return X.p.z() - (X.R().row(2).transpose().cwiseAbs()).dot(half);
}

TEST(MovableScenarios, ABoxPushesACrateWithAParcelOnIt) {
  const Scenario scenario = LoadTestScenario("push_boxes");
  const FixtureSpec& table = scenario.environment.fixtures[0];
  const double top = table.xyz.z() + table.size.z() / 2;
  const Vector3 crate_half = scenario.environment.objects[0].primitive->size / 2;
  const Vector3 parcel_half = scenario.environment.objects[1].primitive->size / 2;
  double box_farthest = -HUGE_VAL, deepest = -HUGE_VAL, overlap = -HUGE_VAL;
  Pose crate, parcel;
  const TestRun run = RunScenario("push_boxes", {}, [&](const TickRecord& record) {
    ASSERT_EQ(record.movable_count, 2);
    crate = FromRecord(record.movables[0]);
    parcel = FromRecord(record.movables[1]);
    const Pose box = ObjectOf(record);
    box_farthest = std::max(box_farthest, box.p.y() + kBoxHalf.y());
    deepest = std::max(deepest, top - LowestOf(crate, crate_half));
    // The parcel lies on the crate.
    overlap = std::max(overlap, crate.p.z() + crate_half.z() - LowestOf(parcel, parcel_half));
  });
  EXPECT_TRUE(EndsWell(run));
  EXPECT_LE(deepest, kMaxDepth);
  EXPECT_LE(overlap, kMaxDepth);
  const Vector3 moved = crate.p - scenario.environment.objects[0].xyz;
  EXPECT_GT(moved.y(), 0.1);
  // The crate stays where the box left it.
  EXPECT_NEAR(crate.p.y() - crate_half.y(), box_farthest, 0.02);
  EXPECT_NEAR(crate.p.z(), top + crate_half.z(), 1e-3);
  const Vector3 with_crate = parcel.p - scenario.environment.objects[1].xyz - moved;
  EXPECT_LT(with_crate.norm(), 0.01);
}

}  // namespace
}  // namespace predictor
