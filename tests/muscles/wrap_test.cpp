#include "muscles/wrap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "muscles/arms.h"

namespace predictor::muscles {
namespace {

double LengthOf(const Vector3& from, const Vector3& to, const Contact& contact) {
  return (contact.begin - from).norm() + contact.length + (to - contact.end).norm();
}

// The line consists of two tangents of length √(d² - r²) and the arc between the tangents.
TEST(Wrap, AroundABallIsTwoTangentsAndAnArc) {
  const Vector3 center(0.1, -0.2, 0.3), from = center + Vector3(-0.05, 0, 0.01);
  const Vector3 to = center + Vector3(0.05, 0, 0.01);
  const auto contact = AroundBall(from, to, center, 0.03);
  ASSERT_TRUE(contact);
  const double d = std::hypot(0.05, 0.01), tangent = std::sqrt(d * d - 0.03 * 0.03);
  const double arc = kPi - 2 * std::atan2(0.01, 0.05) - 2 * std::acos(0.03 / d);
  EXPECT_NEAR(LengthOf(from, to, *contact), 2 * tangent + 0.03 * arc, 1e-15);
  EXPECT_GT(contact->begin.z(), center.z());  // the shorter side
  EXPECT_NEAR((contact->begin - center).dot(contact->begin - from), 0, 1e-15);
}

TEST(Wrap, AStraightLineThatMissesTheBallStays) {
  EXPECT_FALSE(AroundBall({-1, 0, 0.31}, {1, 0, 0.31}, Vector3::Zero(), 0.3));
  EXPECT_TRUE(AroundBall({-1, 0, 0.29}, {1, 0, 0.29}, Vector3::Zero(), 0.3));
  // the line passes the ball
  EXPECT_FALSE(AroundBall({1, 0, 0.1}, {2, 0, 0.1}, Vector3::Zero(), 0.3));
}

// On the unrolled cylinder, the line is straight, so its parts climb in proportion.
TEST(Wrap, AroundACylinderIsTheStraightLineOfTheUnrolledSurface) {
  const double r = 0.02, rho = 0.05, height = 0.08;
  const Vector3 axis = Vector3::UnitZ();
  const Vector3 from(rho, 0, 0), to(-rho, 0, height);
  const auto contact = AroundCylinder(from, to, Vector3::Zero(), axis, r);
  ASSERT_TRUE(contact);
  EXPECT_GT(contact->begin.y(), 0);  // the positive sense about z leads from +x over +y to -x
  const double flat = 2 * std::sqrt(rho * rho - r * r) + r * (kPi - 2 * std::acos(r / rho));
  EXPECT_NEAR(LengthOf(from, to, *contact), std::hypot(flat, height), 1e-15);
  const auto other = AroundCylinder(from, to, Vector3::Zero(), -axis, r);
  ASSERT_TRUE(other);
  EXPECT_LT(other->begin.y(), 0);
}

TEST(Wrap, ALineOnTheSideOfTheCylinderStays) {
  const Vector3 from(0.05, 0.03, 0), to(-0.05, 0.03, 0.1);
  EXPECT_FALSE(AroundCylinder(from, to, Vector3::Zero(), Vector3::UnitZ(), 0.02));
  // On the other side, the line must go around the cylinder.
  const auto contact = AroundCylinder(from, to, Vector3::Zero(), -Vector3::UnitZ(), 0.02);
  ASSERT_TRUE(contact);
  EXPECT_LT(contact->begin.y(), 0.02);
  EXPECT_GT(LengthOf(from, to, *contact), (to - from).norm());
}

// The length must not jump where the line begins to touch the cylinder.
TEST(Wrap, BeginsAndEndsWithoutAJump) {
  for (const double offset : {0.0199999, 0.0200001}) {
    const Vector3 from(0.05, offset, 0), to(-0.05, offset, 0);
    const auto ball = AroundBall(from, to, Vector3::Zero(), 0.02);
    const auto cylinder = AroundCylinder(from, to, Vector3::Zero(), Vector3::UnitZ(), 0.02);
    EXPECT_EQ(ball.has_value(), offset < 0.02);
    EXPECT_EQ(cylinder.has_value(), offset < 0.02);
    for (const auto& contact : {ball, cylinder}) {
      if (!contact) continue;
      EXPECT_NEAR(LengthOf(from, to, *contact), 0.1, 1e-8);
    }
  }
}

}  // namespace
}  // namespace predictor::muscles
