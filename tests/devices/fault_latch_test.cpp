// Tests which of several faults the latch keeps.
#include "devices/fault_latch.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

enum class Kind { kNone, kLight, kLightToo, kSevere, kSevereToo };

bool EndsWithoutPower(Kind kind) noexcept { return kind >= Kind::kSevere; }

TEST(FaultLatch, KeepsTheFirstAsTheCauseAndTheFirstSevereOneAfterIt) {
  FaultLatch<Kind> latch;
  EXPECT_FALSE(latch.any());
  EXPECT_FALSE(latch.ends_without_power());
  latch.Set(Kind::kLight);
  EXPECT_TRUE(latch.any());
  latch.Set(Kind::kLightToo);
  EXPECT_EQ(latch.first(), Kind::kLight);
  EXPECT_EQ(latch.worse(), Kind::kNone);
  EXPECT_FALSE(latch.ends_without_power());
  latch.Set(Kind::kSevere);
  EXPECT_TRUE(latch.ends_without_power());
  for (const Kind later : {Kind::kSevereToo, Kind::kLightToo, Kind::kNone}) {
    latch.Set(later);
    EXPECT_EQ(latch.first(), Kind::kLight);
    EXPECT_EQ(latch.worse(), Kind::kSevere);
    EXPECT_TRUE(latch.ends_without_power());
  }
}

TEST(FaultLatch, NothingIsWorseThanASevereFirst) {
  FaultLatch<Kind> latch;
  latch.Set(Kind::kSevere);
  latch.Set(Kind::kSevereToo);
  EXPECT_EQ(latch.first(), Kind::kSevere);
  EXPECT_EQ(latch.worse(), Kind::kNone);
  EXPECT_TRUE(latch.ends_without_power());
}

}  // namespace
}  // namespace predictor
