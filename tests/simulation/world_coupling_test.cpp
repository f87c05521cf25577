// Tests the effect of the coupling in the world.
#include <gtest/gtest.h>

#include "world_fixtures.h"

namespace predictor {
namespace {

TEST(WorldCoupling, HoldsTheObjectWhereTheDeviceStays) {
  const Scenario s = BoxScene(9);
  World world(s);
  WorldInput input = Push(s, {20, 0, 0});
  input.coupled = true;
  input.handle = world.state().handle;
  const auto start = world.state().handle;
  Simulate(&world, input, 3.0);
  for (std::size_t h = 0; h < kHands; ++h) {
    const double parted = (world.state().handle[h].X_W.p - start[h].X_W.p).norm();
    EXPECT_NEAR(parted, s.coupling.deadband + 20 / s.coupling.stiffness, 0.002);
    EXPECT_NEAR(world.state().coupling[h][0],
                -s.coupling.stiffness * (parted - s.coupling.deadband), 0.5);
  }
  World uncoupled(s);
  input.coupled = false;
  Simulate(&uncoupled, input, 1.0);
  EXPECT_GT((uncoupled.state().handle[0].X_W.p - start[0].X_W.p).norm(), 0.1);
  EXPECT_TRUE(uncoupled.state().coupling[0].isZero(0));
}

// If the device follows exactly, a person must feel only the cap on the handles' speed.
TEST(WorldCoupling, BrakesAboveTheSpeedCapOnly) {
  const Scenario s = BoxScene(9);
  World capped(s), free(s);
  double fastest_capped = 0;
  double fastest_free = 0;
  for (int i = 0; i < 800; ++i) {
    WorldInput input = Push(s, {25, 0, 0});
    ASSERT_TRUE(free.Step(input, kTick).ok());
    input.coupled = true;
    input.handle = capped.state().handle;
    const bool below = capped.state().handle[0].V_W.head<3>().norm() < 0.24;
    ASSERT_TRUE(capped.Step(input, kTick).ok());
    EXPECT_TRUE(!below || capped.state().coupling[0].isZero(0));
    fastest_capped = std::max(fastest_capped, capped.state().handle[0].V_W.head<3>().norm());
    fastest_free = std::max(fastest_free, free.state().handle[0].V_W.head<3>().norm());
  }
  EXPECT_GT(fastest_free, 0.5);
  EXPECT_LT(fastest_capped, 0.30);
}

TEST(WorldCoupling, IsStableOnALightObject) {
  Scenario s = BoxScene(0.2);
  s.object.primitive->size = {0.02, 0.4, 0.02};
  s.object.attachment.on_object.xyz = {0, 0, 0.01};
  s.left_handle->pose.xyz = {0, 0.19, 0};
  s.right_handle->pose.xyz = {0, -0.19, 0};
  World world(s);
  WorldInput input = HandsOff(s);
  input.coupled = true;
  input.handle = world.state().handle;
  for (std::size_t h = 0; h < kHands; ++h) {
    input.handle[h].X_W.p += Vector3(0.05, 0.02, -0.03);
  }
  Simulate(&world, input, 3.0);
  EXPECT_LT(world.state().object.V_W.norm(), 0.02);
}

}  // namespace
}  // namespace predictor
