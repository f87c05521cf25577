// Actions must last as long as a script's checks assume.
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
  for (const ParameterKind* kind : Actions()) {
    ActionSpec spec = MakeActionSpec(kind->name, 0);
    for (const YamlNode& item : WriteParameters(kind->parameters().get()).items) {
      if (item.key == "duration") spec.Set("duration=1.7");
      if (item.key == "period") spec.Set("period=3");
      if (item.key == "cycles") spec.Set("cycles=2");
      for (const std::string key : {"force", "by", "rotate_by"})
        if (item.key == key) spec.Set(key + "=[0.1, 0, 0]");
    }
    EXPECT_NEAR(TimeOf(spec), ActionTime(spec), 2 * kTick) << kind->name;
  }
}

TEST(ActionTime, OfAShortCircleHasAShorterRamp) {
  ActionSpec spec = MakeActionSpec("circle", 0, {"period=1", "cycles=0.5"});
  EXPECT_NEAR(ActionTime(spec), 1.0, 1e-12);
  EXPECT_NEAR(TimeOf(spec), 1.0, 2 * kTick);
  spec.Set("cycles=4");
  EXPECT_NEAR(ActionTime(spec), 5.0, 1e-12);
}

}  // namespace
}  // namespace predictor
