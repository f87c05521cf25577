// Tests whether the emulator keeps to its documented limits in runs with hazards. Also tests the
// measurements on which this judgement depends.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "analysis/hazard_study/hazard_study.h"
#include "analysis/hazard_study/run_measures.h"
#include "analysis/hazard_study/run_store.h"
#include "analysis/scenarios.h"

namespace predictor {
namespace {

// A reading deviates from the truth by the noise and by a uniformly distributed rounding error of
// up to half a step. The standard deviation of this rounding error is the step divided by sqrt(12).
TEST(ResolvedForce, IsThreeStandardDeviationsOfAReading) {
  SensorSpec sensor;
  sensor.noise_force = 0.03;
  sensor.force_resolution = 0.04 * std::sqrt(12);
  EXPECT_DOUBLE_EQ(ResolvedForce(sensor), 3 * 0.05);
}

TickRecord With(double run_time, double left, double right) {
  TickRecord record = {};
  record.run_time = run_time;
  record.hands[0].true_wrench = {0, 0, left};
  record.hands[1].true_wrench = {0, right, 0};
  return record;
}

TEST(ClearCrossing, CountsFromTheLastTimeAtWhichTheForceExceededTheThresholdClearly) {
  ClearCrossing crossing(30, {0.15, 0.5});
  const auto add = [&](double run_time, double left, double right) {
    crossing.Add(With(run_time, left, right));
  };
  add(1.000, 29, 31);
  EXPECT_EQ(crossing.duration(0), -1);
  EXPECT_EQ(crossing.duration(1), 0);
  add(1.001, 30.1, 31);  // the left force exceeds 30 N, but by less than its sensor resolves
  EXPECT_EQ(crossing.duration(0), -1);
  EXPECT_NEAR(crossing.duration(1), 0.001, 1e-12);
  add(1.002, 30.2, 30.4);
  EXPECT_EQ(crossing.duration(0), 0);
  EXPECT_EQ(crossing.duration(1), -1);
  add(1.005, 30.2, 31);
  EXPECT_NEAR(crossing.duration(0), 0.003, 1e-12);
  EXPECT_EQ(crossing.duration(1), 0);
}

Scenario Studied(const std::string& scenario, const std::string& controller,
                 const std::string& hazard) {
  const auto named = [](const std::vector<StudyChoice>& choices, const std::string& name) {
    return *std::ranges::find(choices, name, &StudyChoice::name);
  };
  return StudiedScenario(kScenarios / (scenario + ".yaml"), named(StudiedControllers(), controller),
                         named(StudiedHazards(), hazard), HazardStudyOptions().duration);
}

TEST(StudiedScenario, KeepsTheOwnLimitsOfTheCobot) {
  const auto limits = [](const std::vector<std::string>& set) {
    return StudiedScenario(kScenarios / "box_9kg.yaml", {"own", set}, StudiedHazards()[0], 6)
        .cobot.safety;
  };
  EXPECT_EQ(limits({}).force, 100);
  EXPECT_EQ(limits({}).speed, 0.75);
  EXPECT_EQ(limits({"cobot.safety.force=50"}).force, 50);
  EXPECT_FALSE(limits({"cobot.safety.force=50"}).speed);
}

HazardRun StudiedRun(const std::string& scenario, const std::string& controller,
                     const std::string& hazard, std::uint64_t seed) {
  return HazardRuns(Studied(scenario, controller, hazard)).Run(seed);
}

// A run depends on its seed only, and not on the runs before it.
TEST(HazardRuns, RepeatForTheSameSeed) {
  const Scenario scenario = Studied("single_arm", "own", "brakes_close");
  HazardRuns runs(scenario), again(scenario);
  std::vector<std::string> texts;
  for (const std::uint64_t seed : {1, 2, 3}) texts.push_back(TextOf(runs.Run(seed)));
  EXPECT_EQ(TextOf(again.Run(3)), texts[2]);
  EXPECT_EQ(TextOf(again.Run(1)), texts[0]);
  EXPECT_EQ(TextOf(runs.Run(2)), texts[1]);
}

TEST(HazardRuns, DifferInTheTimeOfTheHazardAndInTheForces) {
  HazardRuns runs(Studied("single_arm", "own", "brakes_close"));
  const HazardRun one = runs.Run(1), two = runs.Run(2);
  EXPECT_NE(one.begin, two.begin);
  EXPECT_NE(one.after, two.after);
  for (const HazardRun& run : {one, two}) {
    EXPECT_GE(run.begin, 2);
    EXPECT_LE(run.begin, 4);
  }
}

// A hand reaches this force before the state is saved, so the run of every seed is already over.
TEST(HazardRuns, EndWithTheCommonBeginningIfThatStops) {
  Scenario scenario = Studied("single_arm", "own", "brakes_close");
  scenario.safety.force = 2;
  HazardRuns runs(scenario);
  HazardRun one = runs.Run(1);
  const HazardRun two = runs.Run(2);
  EXPECT_EQ(one.cause, StopCause::kForce);
  EXPECT_EQ(one.begin, -1);
  EXPECT_GT(one.travel, 0);
  one.seed = 2;
  EXPECT_EQ(TextOf(one), TextOf(two));
}

// In these runs, the stop came 2 or 3 ms after the true force crossed its threshold.
TEST(HazardRuns, StopWithinThreeMillisecondsAfterTheForceExceedsItsThresholdClearly) {
  const struct {
    const char *scenario, *controller, *hazard;
    std::uint64_t seed;
  } kRuns[] = {{"box_9kg", "own", "power_loss", 2},
               {"box_9kg", "joint_impedance", "object_slips", 1},
               {"box_9kg", "variable_impedance", "takeover", 1},
               {"bar_circle", "admittance", "power_loss", 1},
               {"bar_circle", "load_sharing", "takeover", 1}};
  for (const auto& [scenario, controller, hazard, seed] : kRuns) {
    SCOPED_TRACE(std::string(scenario) + ", " + controller + ", " + hazard);
    const HazardRun run = StudiedRun(scenario, controller, hazard, seed);
    EXPECT_EQ(run.cause, StopCause::kForce);
    EXPECT_GE(run.clear_detection, 0);
    EXPECT_LE(run.clear_detection, 0.003 + 1e-9);
  }
}

// In these runs, the handles were fastest.
TEST(HazardRuns, CommandNoHandleFasterThanItsCap) {
  for (const char* hazard : {"object_slips", "object_breaks_loose"})
    for (const char* scenario : {"box_9kg", "bar_circle"}) {
      SCOPED_TRACE(std::string(scenario) + ", " + hazard);
      const HazardRun run = StudiedRun(scenario, "load_sharing", hazard, 1);
      EXPECT_GT(run.commanded, 0.99);
      EXPECT_LE(run.commanded, 1 + 1e-9);
    }
}

}  // namespace
}  // namespace predictor
