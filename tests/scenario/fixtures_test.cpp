// The keys of environment.fixtures.
#include <gtest/gtest.h>

#include "fixture.h"

namespace predictor {
namespace {

std::string ErrorOfFixture(const std::string& keys) {
  return ErrorOfOverride("environment.fixtures=[{" + keys + "}]");
}

TEST(FixtureKeys, AreReadWithTheirDefaults) {
  const Scenario s = Fixture(
      {"environment.fixtures=[{shape: capsule, size: [0.05, 0.4, 0], xyz: [1, 2, 3], rpy: [0, 90 "
       "deg, 0], friction: 0.2, touches: [object, cobot]}, {shape: plane}]"});
  ASSERT_EQ(s.environment.fixtures.size(), 2u);
  const FixtureSpec& capsule = s.environment.fixtures[0];
  EXPECT_EQ(capsule.shape, FixtureShape::kCapsule);
  EXPECT_EQ(capsule.size, Vector3(0.05, 0.4, 0));
  EXPECT_LT((capsule.X_WG() * Vector3(0, 0, 1) - Vector3(2, 2, 3)).norm(), 1e-12);
  EXPECT_EQ(capsule.friction, 0.2);
  EXPECT_TRUE(capsule.Touches("cobot"));
  const FixtureSpec& plane = s.environment.fixtures[1];
  EXPECT_FALSE(plane.friction.has_value());
  EXPECT_TRUE(plane.Touches("object"));
  EXPECT_FALSE(plane.Touches("cobot"));
}

TEST(FixtureKeys, AnUnknownShapeIsAnErrorThatListsTheKnownOnes) {
  const std::string error = ErrorOfFixture("shape: cone");
  EXPECT_NE(error.find("environment.fixtures.0.shape is \"cone\""), std::string::npos) << error;
  EXPECT_NE(error.find("box, cylinder, capsule, sphere, plane"), std::string::npos) << error;
}

TEST(FixtureKeys, ASizeThatIsZeroWhereItCountsIsAnError) {
  EXPECT_EQ(ErrorOfFixture("shape: sphere, size: [0.1, 0, 0]"), "");
  EXPECT_NE(ErrorOfFixture("shape: cylinder, size: [0.1, 0, 0]")
                .find("environment.fixtures.0.size has a zero among the first 2 entries, the "
                      "dimensions of a cylinder."),
            std::string::npos);
  EXPECT_NE(ErrorOfFixture("shape: box, size: [0.1, 1, 0]"), "");
}

TEST(FixtureKeys, ADampingWithoutAStiffnessIsAnError) {
  EXPECT_EQ(ErrorOfFixture("shape: box, stiffness: 2000, damping: 10"), "");
  EXPECT_NE(ErrorOfFixture("shape: box, damping: 10")
                .find("environment.fixtures.0.damping is given without a stiffness."),
            std::string::npos);
}

TEST(FixtureKeys, TwoFixturesWithTheSameNameAreAnError) {
  EXPECT_EQ(ErrorOfFixture("shape: box}, {shape: box}, {shape: box, name: wall"), "");
  const std::string error = ErrorOfFixture("shape: box, name: wall}, {shape: box, name: wall");
  EXPECT_NE(
      error.find("environment.fixtures.1.name is \"wall\", as that of environment.fixtures.0"),
      std::string::npos)
      << error;
}

TEST(FixtureKeys, ThatAreImpossibleAreErrors) {
  EXPECT_NE(ErrorOfFixture("size: [1, 1, 1]").find("shape is missing"), std::string::npos);
  EXPECT_NE(ErrorOfFixture("shape: box, touches: []"), "");
  EXPECT_NE(ErrorOfFixture("shape: box, touches: [hand]"), "");
  EXPECT_NE(ErrorOfFixture("shape: box, time_constant: 0.001"), "");
  EXPECT_NE(ErrorOfFixture("shape: box, friction: -1"), "");
}

}  // namespace
}  // namespace predictor
