// Tests the instructions to the person at the handles, and what a reset does to a person's
// settings.
#include <gtest/gtest.h>

#include "emulator/parameter_ramps.h"
#include "emulator/run_loop.h"
#include "runs.h"
#include "scenario/action_time.h"

namespace predictor {
namespace {

// A person performs the script, so the current instruction depends on the clock alone.
TEST(Instructions, OfAPersonFollowTheClock) {
  const Scenario scenario = LoadTestScenario("circle_by_hand", {"duration=7"});
  ASSERT_EQ(scenario.operator_.script[1].action, "circle");
  Emulator emulator(scenario);
  double circle = -1;
  Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    if (record.state != RunState::kRun) {
      EXPECT_EQ(record.action, -1) << Name(record.state);
    } else if (record.run_time > 0.002) {  // the rig receives RUN one tick later
      EXPECT_GE(record.action, 0) << record.run_time;
      if (record.action == 1 && circle < 0) circle = record.run_time;
    }
  });
  EXPECT_NEAR(circle, scenario.operator_.script[1].start, 0.002);
}

TEST(Instructions, AreTheLastBegunOfTheActiveActions) {
  const std::vector<ActionSpan> script = {{1, 11}, {3, 5}, {20, 21}};
  const std::vector<std::pair<double, int>> times = {{0, -1}, {1, 0},   {2.9, 0},  {3, 1},
                                                     {5, 0},  {11, -1}, {20.5, 2}, {21, -1}};
  for (const auto& [time, action] : times) EXPECT_EQ(ActionAt(script, time), action) << time;
}

// Only a person may relax a safety threshold of real arms.
TEST(Parameters, TightenedThresholdsOutliveAResetOfRealArms) {
  for (const bool real : {false, true}) {
    Scenario scenario = LoadTestScenario("box_9kg");
    if (real) scenario.device.type = "ur";
    ParameterRamps ramps(scenario);
    ASSERT_TRUE(ramps.Set(Parameter::kForceThreshold, 20));
    ASSERT_TRUE(ramps.Set(Parameter::kTorqueThreshold, 3));
    ASSERT_TRUE(ramps.Set(Parameter::kDampingRatio, 1.5));
    ramps.Step(0.5);  // halfway to the new values
    ramps.Reset();
    EXPECT_EQ(ramps[Parameter::kForceThreshold], real ? 20 : scenario.safety.force);
    EXPECT_EQ(ramps[Parameter::kTorqueThreshold], real ? 3 : scenario.safety.torque);
    EXPECT_EQ(ramps[Parameter::kDampingRatio], 1);
    EXPECT_FALSE(ramps.Step(0.1));  // no ramp is active
  }
}

}  // namespace
}  // namespace predictor
