#include "core/heartbeat.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

TEST(Heartbeat, IsSilentSinceItsCountStands) {
  Heartbeat heartbeat;
  constexpr std::uint64_t kSecond = 1'000'000'000;
  EXPECT_EQ(heartbeat.Silence(0, 5 * kSecond), 0);  // the time before the first look is unknown
  EXPECT_DOUBLE_EQ(heartbeat.Silence(0, 7 * kSecond), 2);
  EXPECT_EQ(heartbeat.Silence(1, 8 * kSecond), 0);
  EXPECT_DOUBLE_EQ(heartbeat.Silence(1, 9 * kSecond), 1);
  EXPECT_EQ(heartbeat.Silence(0, 10 * kSecond), 0);  // any change counts, as after a wrap-around
}

}  // namespace
}  // namespace predictor
