// Tests the operating rules that a run gets from its scenario.
#include "scenario/operating_rules.h"

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "scenario/checks.h"

namespace predictor {
namespace {

TEST(OperatingRules, OfASimulatedRigLetTheProgramAndThePageCommand) {
  Scenario scenario;
  scenario.environment.gravity = 1.62;
  const OperatingRules rules = RulesFor(scenario);
  EXPECT_TRUE(rules.auto_start);
  EXPECT_TRUE(rules.remote_start);
  EXPECT_TRUE(rules.may_switch_scenario);
  EXPECT_TRUE(rules.may_stiffen);
  EXPECT_FALSE(rules.needs_enabling);
  EXPECT_FALSE(rules.needs_person);
  EXPECT_FALSE(rules.external_device);
  EXPECT_EQ(rules.handle_gravity, 1.62);
}

TEST(OperatingRules, OfRealArmsProtectThePersonAtTheHandles) {
  Scenario scenario;
  scenario.device.type = "real";
  scenario.environment.gravity = 1.62;
  const OperatingRules rules = RulesFor(scenario);
  EXPECT_FALSE(rules.auto_start);
  EXPECT_FALSE(rules.remote_start);
  EXPECT_FALSE(rules.may_switch_scenario);
  EXPECT_FALSE(rules.may_stiffen);
  EXPECT_TRUE(rules.needs_enabling);
  EXPECT_TRUE(rules.needs_person);
  EXPECT_TRUE(rules.aligns_hands_free);
  EXPECT_TRUE(rules.rechecks_alignment);
  EXPECT_TRUE(rules.keeps_tightened_thresholds);
  EXPECT_TRUE(rules.watches_headsets);
  EXPECT_TRUE(rules.single_use_access_code);
  EXPECT_TRUE(rules.external_device);
  EXPECT_TRUE(rules.arms_move_between_ticks);
  EXPECT_TRUE(rules.cuts_power_of_moving_arms);
  EXPECT_TRUE(rules.needs_repairs);
  EXPECT_TRUE(rules.distrusts_libraries);
  EXPECT_TRUE(rules.always_separates_elbows);
  EXPECT_TRUE(rules.sensors_always_have_noise);
  EXPECT_TRUE(rules.detects_runaway);
  EXPECT_EQ(rules.max_handle_speed, 0.5);
  EXPECT_EQ(rules.handle_gravity, kStandardGravity);
}

// A recording contains the torque once per tick.
TEST(OperatingRules, LetAForeignControllerRunAtTheRateOfTheSteps) {
  Scenario scenario;
  scenario.cobot.controller = {"process", {}};
  scenario.rate = 500;
  Problems problems;
  CheckScenario(scenario, {}, &problems);
  try {
    problems.ThrowIfAny();
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what()).find("rate is 500 Hz, but cobot.controller.type \"process\""),
        std::string::npos)
        << error.what();
  }
}

// The scenario names real arms, but direct mode does not use them.
TEST(OperatingRules, OfDirectModeAreThoseWithoutArms) {
  Scenario scenario;
  scenario.device.type = "real";
  scenario.mode = Mode::kDirect;
  EXPECT_FALSE(RulesFor(scenario).needs_enabling);
  EXPECT_TRUE(RulesFor(scenario).auto_start);
}

}  // namespace
}  // namespace predictor
