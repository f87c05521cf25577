// Actions last as long as a script's checks assume.
#include "scenario/action_time.h"

#include <gtest/gtest.h>

#include "scenario/actions/action.h"

namespace predictor {
namespace {

constexpr double kTick = 0.001;  // [s]

double TimeOf(const ActionSpec& spec) {
  Intent intent;
  const std::unique_ptr<Action> action = MakeAction(spec, 0);
  action->Begin(&intent);
  int ticks = 1;
  while (action->Advance(kTick, 1, &intent) && ticks < 100000) ++ticks;
  return ticks * kTick;
}

TEST(ActionTime, IsWhatAnActionTakes) {
  for (const std::string& type : ActionNames()) {
    ActionSpec spec;
    spec.action = type;
    spec.duration = 1.7;
    spec.period = 3;
    spec.cycles = 2;
    spec.force = {10, 0, 0};
    EXPECT_NEAR(TimeOf(spec), ActionTime(spec), 2 * kTick) << type;
  }
}

TEST(ActionTime, OfAShortCircleHasAShorterRamp) {
  ActionSpec spec;
  spec.action = "circle";
  spec.period = 1;
  spec.cycles = 0.5;
  EXPECT_NEAR(ActionTime(spec), 1.0, 1e-12);
  EXPECT_NEAR(TimeOf(spec), 1.0, 2 * kTick);
  spec.cycles = 4;
  EXPECT_NEAR(ActionTime(spec), 5.0, 1e-12);
}

}  // namespace
}  // namespace predictor
