// The keys of environment.objects.
#include <gtest/gtest.h>

#include "fixture.h"

namespace predictor {
namespace {

std::string ErrorOfObject(const std::string& keys) {
  return ErrorOfOverride("environment.objects=[{" + keys + "}]");
}

TEST(MovableKeys, AreReadWithTheirDefaults) {
  const Scenario s = Fixture(
      {"environment.objects=[{name: brick, primitive: {shape: box, size: [0.2, 0.1, 0.05], mass: "
       "2}, xyz: [1, 2, 3], rpy: [0, 90 deg, 0], friction: 0.2, touches: [object, cobot]}, {name: "
       "tool, model: tool.urdf}]"});
  ASSERT_EQ(s.environment.objects.size(), 2u);
  const MovableSpec& brick = s.environment.objects[0];
  EXPECT_EQ(brick.name, "brick");
  ASSERT_TRUE(brick.primitive.has_value());
  EXPECT_EQ(brick.primitive->mass, 2);
  EXPECT_LT((brick.X_WM() * Vector3(0, 0, 1) - Vector3(2, 2, 3)).norm(), 1e-12);
  EXPECT_EQ(brick.friction, 0.2);
  EXPECT_TRUE(brick.Touches("cobot"));
  const MovableSpec& tool = s.environment.objects[1];
  EXPECT_EQ(tool.model, "tool.urdf");
  EXPECT_FALSE(tool.friction.has_value());
  EXPECT_TRUE(tool.Touches("object"));
  EXPECT_FALSE(tool.Touches("cobot"));
}

TEST(MovableKeys, AMissingOrEmptyNameIsAnError) {
  EXPECT_NE(ErrorOfObject("primitive: {}").find("name is missing"), std::string::npos);
  EXPECT_NE(ErrorOfObject("name: '', primitive: {}").find("environment.objects.0.name is empty."),
            std::string::npos);
}

TEST(MovableKeys, TwoObjectsWithTheSameNameAreAnError) {
  EXPECT_EQ(ErrorOfObject("name: a, primitive: {}}, {name: b, primitive: {}"), "");
  const std::string error = ErrorOfObject("name: a, primitive: {}}, {name: a, primitive: {}");
  EXPECT_NE(error.find("environment.objects.1.name is \"a\", as that of environment.objects.0. "
                       "Choose another name."),
            std::string::npos)
      << error;
}

TEST(MovableKeys, ABodyNeedsEitherAModelOrAPrimitive) {
  EXPECT_NE(ErrorOfObject("name: a").find(
                "environment.objects.0 has neither a model nor a primitive. Give "
                "environment.objects.0.model, a URDF, or environment.objects.0.primitive."),
            std::string::npos);
  EXPECT_NE(ErrorOfObject("name: a, model: a.urdf, primitive: {}")
                .find("environment.objects.0.primitive is given together with"),
            std::string::npos);
}

// A cube of 0.1 m of osmium weighs 22.6 kg.
TEST(MovableKeys, AMassThatNoMaterialHasIsAnError) {
  EXPECT_EQ(ErrorOfObject("name: a, primitive: {size: [0.1, 0.1, 0.1], mass: 22}"), "");
  const std::string error = ErrorOfObject("name: a, primitive: {size: [0.1, 0.1, 0.1], mass: 24}");
  EXPECT_NE(error.find("environment.objects.0.primitive.mass is 24 kg, more than 23 kg, which the "
                       "densest metal of this size would weigh."),
            std::string::npos)
      << error;
  // The volumes are π r² l = 0.00314 m³ and 4/3 π r³ = 0.00419 m³.
  for (const std::string shape : {"cylinder, size: [0.1, 0.1, 0]", "sphere, size: [0.1, 0, 0]"}) {
    const double most = shape[0] == 'c' ? 72.3 : 96.3;
    const auto with = [&](double mass) {
      return ErrorOfObject("name: a, primitive: {shape: " + shape +
                           ", mass: " + std::to_string(mass) + "}");
    };
    EXPECT_EQ(with(0.99 * most), "");
    EXPECT_NE(with(1.01 * most), "");
  }
}

TEST(MovableKeys, APoseFarAwayIsAnError) {
  EXPECT_EQ(ErrorOfObject("name: a, primitive: {}, xyz: [9.9, 0, 0]"), "");
  EXPECT_NE(ErrorOfObject("name: a, primitive: {}, xyz: [8, 0, 8]")
                .find("environment.objects.0.xyz is 11.314 m from the origin of W"),
            std::string::npos)
      << ErrorOfObject("name: a, primitive: {}, xyz: [8, 0, 8]");
}

TEST(MovableKeys, TooManyObjectsAreAnError) {
  const auto list = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += (i > 0 ? "}, {" : "") + ("name: o" + std::to_string(i)) + ", primitive: {}";
    return text;
  };
  EXPECT_EQ(ErrorOfObject(list(kMaxMovables)), "");
  EXPECT_NE(ErrorOfObject(list(kMaxMovables + 1)).find("environment.objects"), std::string::npos);
}

TEST(MovableKeys, DartRefusesThemByName) {
  const std::string error = ErrorOf(
      FixtureText(), {"simulation.engine=dart", "environment.objects=[{name: a, primitive: {}}]"});
  EXPECT_NE(error.find("simulation.engine is dart, whose world has no movable objects. Set "
                       "simulation.engine: mujoco, or remove environment.objects."),
            std::string::npos)
      << error;
}

}  // namespace
}  // namespace predictor
