// How far the movable objects were moved.
#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/summary.h"

namespace predictor {
namespace {

TickRecord WithMovables(int count) {
  TickRecord record{};
  record.state = RunState::kRun;
  record.ran = 1;
  record.movable_count = static_cast<decltype(record.movable_count)>(count);
  record.movables[0].p = {1, 2, 3};
  record.movables[1].p = {4, 5, 6};
  return record;
}

TEST(Movables, HaveNoFigureInASceneWithoutThem) {
  SummaryBuilder builder(Scenario{});
  builder.Add(WithMovables(0));
  EXPECT_TRUE(std::isnan(builder.summary().Get<double>("movables.moved_m")));
}

TEST(Movables, TheOneThatWasMovedFarthestCounts) {
  SummaryBuilder builder(Scenario{});
  TickRecord record = WithMovables(2);
  builder.Add(record);
  record.movables[0].p = {9, 9, 9};  // the way there does not count
  builder.Add(record);
  record.movables[0].p = {1, 2, 3.1};
  record.movables[1].p = {4.03, 5, 6.04};
  builder.Add(record);
  EXPECT_NEAR(builder.summary().Get<double>("movables.moved_m"), 0.1, 1e-12);
  record.movable_count = 255;  // a damaged record
  builder.Add(record);
}

}  // namespace
}  // namespace predictor
