#include "scenario/differences.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

TEST(Differences, OfEqualScenariosAreNone) {
  Scenario a, b;
  b.name = "another name";
  EXPECT_TRUE(DifferentKeys(a, b).empty());
}

TEST(Differences, NameTheKeysAndBothValues) {
  Scenario a, b;
  a.environment.friction = 0.8;
  b.environment.friction = 0.5;
  a.cobot.effort_limit = {87, 12};
  b.operator_.body = BodySpec{};
  const std::vector<KeyDifference> different = DifferentKeys(a, b);
  const auto of = [&](const std::string& key) -> KeyDifference {
    for (const KeyDifference& d : different)
      if (d.key == key) return d;
    return {};
  };
  EXPECT_EQ(of("environment.friction").a, "0.8");
  EXPECT_EQ(of("environment.friction").b, "0.5");
  EXPECT_EQ(of("cobot.effort_limit").a, "[87, 12]");
  for (const KeyDifference& d : different)
    EXPECT_TRUE(d.key.starts_with("environment.friction") || d.key.starts_with("cobot.effort") ||
                d.key.starts_with("operator.body"))
        << d.key;
}

}  // namespace
}  // namespace predictor
