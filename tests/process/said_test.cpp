// Tests that the output of a helper process is limited to an amount that a person can read.
#include "process/said.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Said, IsShownUnchangedIfShort) {
  SaidFilter filter("The viewer");
  SaidFilter::Time now(seconds(100));
  for (int k = 0; k < 1000; ++k, now += milliseconds(250))
    ASSERT_EQ(filter.Take("A pin: 123456.", now), std::vector<std::string>{"A pin: 123456."});
}

TEST(Said, IsOmittedAndCountedInAFlood) {
  SaidFilter filter("The viewer");
  SaidFilter::Time now(seconds(100));
  int shown = 0;
  for (int k = 0; k < 10'000; ++k, now += milliseconds(1))
    shown += static_cast<int>(filter.Take("x", now).size());
  // The first 30 lines are shown immediately. After that, five lines a second are shown, each with
  // a sentence that counts the omitted lines.
  EXPECT_GE(shown, 30 + 2 * 49);
  EXPECT_LE(shown, 30 + 2 * 51);
  const auto later = filter.Take("y", now + seconds(10));
  ASSERT_EQ(later.size(), 2U);
  EXPECT_TRUE(later[0].starts_with("The viewer sent too many messages: ")) << later[0];
  EXPECT_EQ(later[1], "y");
}

TEST(Said, IsTruncatedIfLong) {
  SaidFilter filter("The viewer");
  const auto shown = filter.Take(std::string(1 << 20, 'a'), SaidFilter::Time(seconds(1)));
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0].size(), SaidFilter::kLongest + 4);
}

}  // namespace
}  // namespace predictor
