// Tests the example controllers in the shipped scenarios with the parameters of the documentation.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "analysis/check/check.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/summary.h"
#include "scenario/scenario_io.h"
#include "simulation/world.h"
#include "support/plugins.h"

namespace predictor {
namespace {

Scenario WithExample(const std::string& name, const std::string& parameters) {
  Scenario s = LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name, {});
  s.cobot.controller = test::Plugin("joint_impedance", parameters);
  return s;
}

TEST(PluginExamples, AreSmoothInTheShippedScenarios) {
  for (const char* name : {"single_arm.yaml", "box_9kg.yaml"}) {
    const Scenario s = WithExample(name, "joint_stiffness=200 damping_rate=100");
    EXPECT_TRUE(World(s).JudgeController().is_stable()) << name;
    Emulator emulator(s);
    SummaryBuilder summary(s);
    int flips = 0;  // changes of a torque's sign from a large value to a large value
    std::array<double, kMaxCobotJoints> before = {};
    Simulate(&emulator, 5, [&](const TickRecord& record) {
      summary.Add(record);
      for (std::size_t j = 0; j < before.size(); ++j) {
        const double now = record.cobot_torque[j];
        flips += now * before[j] < 0 && std::fmin(std::fabs(now), std::fabs(before[j])) > 1;
        before[j] = now;
      }
    });
    EXPECT_EQ(flips, 0) << name;
    EXPECT_TRUE(summary.stops().stops().empty()) << name;
    EXPECT_EQ(summary.summary().Get<double>("cobot_limits.effort_ticks"), 0) << name;
    EXPECT_EQ(summary.summary().Get<double>("cobot_limits.velocity_ticks"), 0) << name;
  }
}

// In a model in continuous time, a controller that saturates in both directions looks stable.
TEST(PluginExamples, ThatChatterAreUnfitAndCounted) {
  const Scenario s = WithExample("single_arm.yaml", "joint_stiffness=200 damping_rate=4000");
  CheckOptions options;
  options.search = false;
  const CheckReport report = Check(s, options);
  ASSERT_FALSE(report.fit());
  EXPECT_NE(report.problems[0].find("The cobot's controller is unstable at joint panda_joint"),
            std::string::npos)
      << report.problems[0];
  EXPECT_NE(report.problems[0].find("Reduce the damping"), std::string::npos);
  Emulator emulator(s);
  SummaryBuilder summary(s);
  Simulate(&emulator, 0.2, [&](const TickRecord& record) { summary.Add(record); });
  EXPECT_GT(summary.summary().Get<double>("cobot_limits.effort_ticks"), 10);
  EXPECT_NE(SummaryTable(summary.summary()).find("ticks at an effort limit"), std::string::npos);
}

}  // namespace
}  // namespace predictor
