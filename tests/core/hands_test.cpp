#include "core/hands.h"

#include <gtest/gtest.h>

#include <vector>

namespace predictor {
namespace {

std::vector<int> Visited(const Hands& hands) {
  std::vector<int> visited;
  for (const int hand : hands) visited.push_back(hand);
  return visited;
}

TEST(Hands, VisitsThePresentHands) {
  EXPECT_EQ(Visited({}), std::vector<int>{});
  EXPECT_EQ(Visited({true, false}), std::vector<int>{0});
  EXPECT_EQ(Visited({false, true}), std::vector<int>{1});
  EXPECT_EQ(Visited({true, true}), (std::vector<int>{0, 1}));
  Hands hands;
  hands.Add(1);
  EXPECT_FALSE(hands.Has(0));
  EXPECT_TRUE(hands.Has(1));
  EXPECT_EQ(hands.count(), 1);
}

}  // namespace
}  // namespace predictor
