#include "core/text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>

#include "core/random.h"

namespace predictor {
namespace {

TEST(Nearest, FindsWhatWasMeant) {
  const std::vector<std::string> keys = {"force", "torque", "tracking", "max_age"};
  EXPECT_EQ(Nearest("forse", keys), "force");
  EXPECT_EQ(Nearest("Torque", keys), "torque");
  EXPECT_EQ(Nearest("troque", keys), "torque");  // one swap
  EXPECT_EQ(Nearest("trcking", keys), "tracking");
  EXPECT_EQ(Nearest("maxage", keys), "max_age");
}

TEST(Nearest, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(Nearest("colour", {"force", "torque"}), "");
  EXPECT_EQ(Nearest("", {"force"}), "");
  EXPECT_EQ(Nearest("force", {}), "");
  EXPECT_EQ(Nearest(std::string(1000000, 'f'), {"force"}), "");
}

TEST(Nearest, ShortNamesAllowOneChange) {
  EXPECT_EQ(Nearest("kq", {"kp", "ko"}), "kp");
  EXPECT_EQ(Nearest("xy", {"kp", "ko"}), "");
}

TEST(Suggestion, ListsAllWhenNothingIsNear) {
  EXPECT_EQ(Suggestion("forse", {"force", "torque"}), "Did you mean force?");
  EXPECT_EQ(Suggestion("colour", {"force", "torque"}), "Known are: force, torque.");
}

TEST(DegreesHint, OnlyOfWhatMayHaveBeenMeant) {
  EXPECT_EQ(DegreesHint(-90, -3, 3), " Angles are in rad: -90 degrees are -1.5708.");
  EXPECT_EQ(DegreesHint(90, -3, -0.1), "");  // would be beyond, too
  EXPECT_EQ(DegreesHint(4, -3, 3), "");      // an angle in rad
  EXPECT_EQ(DegreesHint(5000, -3, 3), "");
}

TEST(FormatNumber, ReadsBackExactly) {
  RandomStream random(1, "numbers");
  int finite = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = std::bit_cast<double>(random.Next());
    if (!std::isfinite(x)) continue;
    ++finite;
    ASSERT_EQ(std::strtod(FormatNumber(x).c_str(), nullptr), x);
  }
  EXPECT_GT(finite, 90000);
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatNumber(-500), "-500");
}

TEST(Quote, EscapesAndCuts) {
  EXPECT_EQ(Quote("a b"), "\"a b\"");
  EXPECT_EQ(Quote(std::string("\x1b[2J\0", 5)), "\"\\x1b[2J\\x00\"");
  EXPECT_EQ(Quote(std::string(61, 'a')), "\"" + std::string(60, 'a') + "...\"");
  // "é" is two bytes; the cut falls within one.
  std::string accents = "a";
  for (int i = 0; i < 40; ++i) accents += "é";
  EXPECT_EQ(Quote(accents).substr(58), "é...\"");
}

TEST(Join, SeparatesWords) {
  EXPECT_EQ(Join({}), "");
  EXPECT_EQ(Join({"a"}), "a");
  EXPECT_EQ(Join({"a", "b", "c"}, "; "), "a; b; c");
}

}  // namespace
}  // namespace predictor
