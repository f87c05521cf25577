// Tests metrics of the virtual cobot: its limits, the late answers of its controller, and the
// fastest joint of a simulation that diverged.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "evaluation/summary.h"

namespace predictor {
namespace {

Scenario WithPanda() {
  Scenario s;
  s.name = "panda";
  s.cobot.model = "package://example-robot-data/robots/panda_description/urdf/panda.urdf";
  s.cobot.remove_links = {"panda_hand"};
  s.cobot.end_effector = "panda_link8";
  return s;
}

TickRecord Running(int joint, double v, double torque) {
  TickRecord r{};
  r.state = RunState::kRun;
  r.ran = 1;
  r.cobot_dof = 7;
  r.cobot_v[static_cast<std::size_t>(joint)] = v;
  r.cobot_torque[static_cast<std::size_t>(joint)] = torque;
  return r;
}

// The URDF limits the Panda's joint 1 to 87 N·m and 2.175 rad/s, and joint 7 to 12 N·m and
// 2.61 rad/s.
TEST(CobotLimits, CountTheTicksAtTheLimitsOfTheModel) {
  SummaryBuilder builder(WithPanda());
  builder.Add(Running(0, 2.1, 86));
  builder.Add(Running(6, -2.5, -11.9));
  EXPECT_EQ(SummaryTable(builder.summary()).find("Cobot's joints"), std::string::npos);
  builder.Add(Running(0, 2.1, 87));
  builder.Add(Running(6, 0, -12));
  builder.Add(Running(6, -2.7, 0));
  TickRecord paused = Running(6, 9, 12);
  paused.ran = 0;
  builder.Add(paused);
  EXPECT_EQ(builder.summary().Get<double>("cobot_limits.effort_ticks"), 2);
  EXPECT_EQ(builder.summary().Get<double>("cobot_limits.velocity_ticks"), 1);
  const std::string table = SummaryTable(builder.summary());
  EXPECT_NE(table.find("2 ticks at an effort limit, 1 ticks above a velocity limit"),
            std::string::npos)
      << table;
}

TEST(CobotLimits, CountWithTheEffortLimitOfTheScenario) {
  Scenario s = WithPanda();
  s.cobot.effort_limit = {5};
  SummaryBuilder builder(s);
  builder.Add(Running(3, 0, -5));
  builder.Add(Running(3, 0, -4.9));
  EXPECT_EQ(builder.summary().Get<double>("cobot_limits.effort_ticks"), 1);
}

TEST(CobotLimits, OfAMissingModelAreUnknown) {
  Scenario s = WithPanda();
  s.cobot.model = "nowhere.urdf";
  SummaryBuilder builder(s);
  builder.Add(Running(0, 9, 900));
  const auto json = nlohmann::json::parse(SummaryJson(builder.summary()));
  EXPECT_TRUE(json["cobot_limits"]["effort_ticks"].is_null());
  EXPECT_EQ(SummaryTable(builder.summary()).find("effort limit"), std::string::npos);
}

TEST(ControllerAnswers, CountTheLateOnesOfAProcess) {
  Scenario s;
  s.cobot.controller.type = "process";
  SummaryBuilder builder(s);
  TickRecord record = Running(0, 0, 0);
  for (int k = 0; k < 5; ++k) builder.Add(record);
  EXPECT_EQ(SummaryTable(builder.summary()).find("answers late"), std::string::npos);
  record.controller = static_cast<std::uint8_t>(ControllerOutcome::kFellBack);
  for (int k = 0; k < 3; ++k) builder.Add(record);
  EXPECT_NE(SummaryTable(builder.summary()).find("3 of 8 answers late"), std::string::npos);
  EXPECT_EQ(builder.summary().Get<std::uint64_t>("controller.late"), 3U);
}

// Returns the summary of a run that the simulation stops.
Summary StoppedBy(Quantity quantity, double value, double limit) {
  SummaryBuilder builder(WithPanda());
  TickRecord stop = Running(6, -95, 0);
  stop.cobot_v[2] = 3;
  stop.state = RunState::kStopping;
  stop.cause = StopCause::kPhysics;
  stop.cause_hand = -1;
  stop.cause_quantity = quantity;
  stop.cause_value = value;
  stop.cause_limit = limit;
  builder.Add(stop);
  return builder.summary();
}

void ExpectText(const Summary& summary, const std::string& text) {
  const std::string table = SummaryTable(summary);
  EXPECT_NE(table.find(text), std::string::npos) << text << "\n" << table;
}

TEST(StopByPhysics, NamesTheJointAndARemedyThatFits) {
  const Summary diverged = StoppedBy(Quantity::kAngularSpeed, 200, 100);
  ExpectText(diverged, "by cause 'physics': largest speed: ");
  ExpectText(diverged, "The fastest joint of the cobot was its joint 7.");
  ExpectText(diverged, "Run `predictor check`. Reduce the damping");
  EXPECT_EQ(nlohmann::json::parse(SummaryJson(diverged))["stop"]["fastest_joint"], 7);
}

TEST(StopByPhysics, StatesTheAccelerationOrThatTheStepHasNoFiniteResult) {
  ExpectText(StoppedBy(Quantity::kAngularAcceleration, 2.5e6, 1e6),
             "by cause 'physics': largest acceleration: 2500000 rad/s², limit 1000000 rad/s².");
  ExpectText(StoppedBy(Quantity::kAcceleration, 2.5e6, 1e6),
             "by cause 'physics': largest acceleration: 2500000 m/s², limit 1000000 m/s².");
  const Summary not_finite = StoppedBy(Quantity::kNotFinite, std::nan(""), 0);
  ExpectText(not_finite, "by cause 'physics': the simulation step has no finite result.");
  ExpectText(not_finite, "Explanation: the simulation diverged.");
  EXPECT_TRUE(nlohmann::json::parse(SummaryJson(not_finite))["stop"]["value"].is_null());
}

// Recordings of earlier versions contain such stops without a quantity.
TEST(StopByPhysics, WithoutAQuantityIsExplained) {
  const Summary earlier = StoppedBy(Quantity::kNone, std::nan(""), 0);
  ExpectText(earlier, "by cause 'physics'.");
  ExpectText(earlier, "Explanation: the simulation diverged.");
}

TEST(StopByPhysics, OfAControllerSaysWhatWasCounted) {
  const Summary not_finite = StoppedBy(Quantity::kCount, 7, 0);
  ExpectText(not_finite, "by cause 'physics': number of torques that are not finite: 7.");
  EXPECT_EQ(SummaryTable(not_finite).find("limit 0"), std::string::npos);
  EXPECT_EQ(SummaryTable(not_finite).find("fastest joint"), std::string::npos);
  const Summary allocates = StoppedBy(Quantity::kAllocations, 2, 0);
  ExpectText(allocates, "by cause 'physics': number of calls of malloc, free and the like: 2.");
  EXPECT_EQ(SummaryTable(allocates).find("fastest joint"), std::string::npos);
  const Summary late = StoppedBy(Quantity::kTime, 0.102, 0.1);
  ExpectText(late, "by cause 'physics': no answer for 102 ms, limit 100 ms.");
  ExpectText(late, "Explanation: the cobot's controller ended, or did not answer in time.");
  EXPECT_TRUE(nlohmann::json::parse(SummaryJson(late))["stop"]["fastest_joint"].is_null());
}

}  // namespace
}  // namespace predictor
