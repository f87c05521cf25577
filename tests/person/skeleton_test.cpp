#include "person/skeleton.h"

#include <gtest/gtest.h>

#include "person/people.h"

namespace predictor::person {
namespace {

TEST(Skeleton, OfAnUprightPersonIsAsTallAsThePerson) {
  const BodyModel model(Man());
  const Anthropometry& a = model.anthropometry();
  const Skeleton s = SkeletonOf(model, BodyVector::Zero(), 0.25);
  EXPECT_NEAR(s.head.z() + a.head.length / 2, Man().height, 1e-9);
  EXPECT_NEAR((s.face - Vector3::UnitX()).norm(), 0, 1e-12);
  EXPECT_NEAR(s.sides[0].ankle.y(), 0.125, 1e-12);
  EXPECT_NEAR(s.sides[1].ankle.y(), -0.125, 1e-12);
  EXPECT_NEAR(s.sides[0].toes.x() - s.sides[0].heel.x(), a.foot.length, 1e-12);
  // The arms hang straight down from the shoulders.
  EXPECT_NEAR(s.sides[0].shoulder.z() - s.sides[0].knuckles.z(),
              a.upper_arm.length + a.forearm.length + a.hand.length, 1e-9);
}

// The limbs are rigid in every posture. If the legs can reach the ground, they have their true
// length.
TEST(Skeleton, LimbsKeepTheirLengths) {
  const BodyModel model(Man());
  const Anthropometry& a = model.anthropometry();
  RandomStream random(1, "skeleton");
  for (int n = 0; n < 20; ++n) {
    BodyVector q = RandomPosture(model, &random);
    q[kPelvisX] = q[kPelvisY] = 0;
    q[kPelvisZ] = -0.2;
    const Skeleton s = SkeletonOf(model, q, 0.25);
    for (const SkeletonSide& side : s.sides) {
      EXPECT_NEAR((side.shoulder - side.elbow).norm(), a.upper_arm.length, 1e-9);
      EXPECT_NEAR((side.elbow - side.wrist).norm(), a.forearm.length, 1e-9);
      EXPECT_NEAR((side.wrist - side.knuckles).norm(), a.hand.length, 1e-9);
      EXPECT_NEAR((side.hip - side.knee).norm(), a.thigh.length, 1e-9);
      EXPECT_NEAR((side.knee - side.ankle).norm(), a.shank.length, 1e-9);
    }
    EXPECT_NEAR((s.sides[0].hip - s.sides[1].hip).norm(), 2 * a.half_hip_width, 1e-9);
    EXPECT_NEAR(s.face.norm(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace predictor::person
