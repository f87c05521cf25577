// Tests the joints between end-effector and object.
#include <gtest/gtest.h>

#include "world_fixtures.h"

namespace predictor {
namespace {

TEST(Attachment, FixedIsRigid) {
  Scenario s = BoxScene(2);
  s.object.attachment.joint = JointType::kFixed;
  World world(s);
  const auto relative = [&] {
    return world.state().end_effector.X_W.Inverse() * world.state().object.X_W;
  };
  const Pose X_EO = s.object.attachment.on_end_effector.ToPose() *
                    s.object.attachment.on_object.ToPose().Inverse();
  EXPECT_LT(PoseError(relative(), X_EO).norm(), 1e-9);
  Simulate(&world, Push(s, {10, -10, 10}), 0.5);
  EXPECT_LT(PoseError(relative(), X_EO).norm(), 1e-9);
}

TEST(Attachment, RevoluteTurnsAboutItsAxisWithinItsRange) {
  Scenario s = BoxScene(2);
  s.object.attachment.joint = JointType::kRevolute;
  s.object.attachment.axis = {0, 1, 0};
  s.object.attachment.range = {-0.4, 0.4};
  s.cobot.controller.Set("stiffness.translation=[500, 500, 500]");
  World world(s);
  double largest = 0;
  Simulate(&world, Push(s, {10, 5, 0}), 1.0, [&](const WorldState& state) {
    const Pose X_AB = s.object.attachment.on_end_effector.ToPose().Inverse() *
                      state.end_effector.X_W.Inverse() * state.object.X_W *
                      s.object.attachment.on_object.ToPose();
    const Vector3 turned = RotationError(X_AB.q, Quaternion::Identity());
    EXPECT_LT(X_AB.p.norm(), 1e-9);
    EXPECT_LT(std::hypot(turned.x(), turned.z()), 1e-9);
    largest = std::max(largest, std::abs(turned.y()));
  });
  EXPECT_GT(largest, 0.3);
  EXPECT_LT(largest, 0.45);
}

TEST(Attachment, PrismaticHangsAtTheEndOfItsRange) {
  Scenario s = BoxScene(2);
  s.object.attachment.joint = JointType::kPrismatic;
  s.object.attachment.range = {-0.05, 0.05};
  const World world(s);
  const Pose X_WA = world.state().end_effector.X_W * s.object.attachment.on_end_effector.ToPose();
  const Vector3 p = X_WA.Inverse() * (world.state().object.X_W * s.object.attachment.on_object.xyz);
  EXPECT_NEAR(p.z(), -0.05, 0.002);
  EXPECT_LT(p.head<2>().norm(), 1e-9);
}

}  // namespace
}  // namespace predictor
