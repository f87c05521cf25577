// If the script lifts the object but the object does not rise, the summary must report this.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "evaluation/summary.h"

namespace predictor {
namespace {

// Returns the summary of a run until `end` [s] in which the object rises by `rise` [m] while the
// script moves it up by 0.05 m, from 1 s to 4 s.
Summary OfALift(double rise, double end) {
  Scenario s;
  s.operator_.type = "virtual";
  s.operator_.script = {MakeActionSpec("move", 5, {"duration=1", "by=[0, 0, 0.2]"}),
                        MakeActionSpec("move", 1, {"duration=3", "by=[0, 0, 0.05]"})};
  SummaryBuilder builder(s);
  for (double time = 0; time <= end; time += 0.5) {
    TickRecord record{};
    record.state = RunState::kRun;
    record.ran = 1;
    record.run_time = time;
    record.object.pose = {{0, 0, 0.1 + rise * std::clamp((time - 1) / 3, 0.0, 1.0)}, {1, 0, 0, 0}};
    builder.Add(record);
  }
  return builder.summary();
}

bool Warns(const Summary& summary) {
  return SummaryTable(summary).find("Warning: the script moves") != std::string::npos;
}

TEST(Lift, ThatDoesNotRaiseTheObjectIsAWarning) {
  for (const double rise : {-0.02, 0.0, 0.004, 0.006, 0.05}) {
    const Summary s = OfALift(rise, 4.5);
    EXPECT_NEAR(s.Get<double>("object.scripted_lift_m"), 0.05, 1e-12);
    EXPECT_NEAR(s.Get<double>("object.scripted_rise_m"), std::max(rise, 0.0), 1e-12);
    EXPECT_EQ(Warns(s), rise < 0.005) << rise;
  }
}

TEST(Lift, ThatARunDoesNotCompleteIsNoWarning) {
  const Summary s = OfALift(0, 3);
  EXPECT_TRUE(std::isnan(s.Get<double>("object.scripted_lift_m")));
  EXPECT_FALSE(Warns(s));
}

}  // namespace
}  // namespace predictor
