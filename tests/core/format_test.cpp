#include "core/format.h"

#include <gtest/gtest.h>

namespace predictor {
namespace {

TEST(SeenAndAllowed, HasThreeDigitsOrAsManyAsDistinguishThem) {
  EXPECT_EQ(SeenAndAllowed(30.5312, 30, Quantity::kForce), "30.5 N, limit 30 N");
  EXPECT_EQ(SeenAndAllowed(30.0312, 30, Quantity::kForce), "30.03 N, limit 30 N");
  EXPECT_EQ(SeenAndAllowed(0.4, 0.35, Quantity::kAngle), "22.9°, limit 20.1°");
  EXPECT_EQ(SeenAndAllowed(0.0123456, 0.01, Quantity::kLength), "12.3 mm, limit 10 mm");
  EXPECT_EQ(SeenAndAllowed(12345, 50, Quantity::kCount), "12345, limit 50");
  EXPECT_EQ(SeenAndAllowed(3, 3, Quantity::kCount), "3, limit 3");
  EXPECT_EQ(SeenAndAllowed(1.2345, 0.1, Quantity::kTime), "1234 ms, limit 100 ms");
}

}  // namespace
}  // namespace predictor
