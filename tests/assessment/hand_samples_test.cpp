#include <gtest/gtest.h>

#include "assessment/samples.h"

namespace predictor::assessment {
namespace {

TEST(Samples, AreMeansOfTenTicksWithTheirPeak) {
  const SampleCollector run = Collect(PersonScenario(), 0.025, [](std::uint64_t tick) {
    return RecordOf(tick, 1, static_cast<double>(tick));
  });
  ASSERT_EQ(run.samples().size(), 2U);  // the last five ticks do not form a whole sample
  const PersonSample& first = run.samples()[0];
  EXPECT_NEAR(first.body.hands[0].F_D_W[2], 5.5, 1e-12);  // the mean of 1 … 10
  EXPECT_NEAR(first.peak_force[0], 10, 1e-12);
  EXPECT_NEAR(first.body.hands[1].X_WD.p.z(), kGround + 1, 1e-12);
  EXPECT_TRUE(first.body.hands[0].present);
  EXPECT_EQ(run.first().tick, 1U);
}

TEST(Samples, DoNotContinueAcrossAPauseOrLostTicks) {
  const Scenario scenario = PersonScenario();
  SampleCollector run(scenario);
  for (std::uint64_t tick = 1; tick <= 14; ++tick) run.Add(RecordOf(tick, 1, 0));
  TickRecord pause = RecordOf(15, 1, 0);
  pause.ran = 0;
  run.Add(pause);
  for (std::uint64_t tick = 16; tick <= 35; ++tick) run.Add(RecordOf(tick, 1, 0));
  for (std::uint64_t tick = 51; tick <= 60; ++tick) run.Add(RecordOf(tick, 1, 0));
  std::vector<bool> continues;
  for (const PersonSample& sample : run.samples()) continues.push_back(sample.continues);
  EXPECT_EQ(continues, (std::vector<bool>{true, false, true, false}));
}

TEST(Samples, ShowWhichHandHolds) {
  for (const std::size_t open : {0U, 1U}) {
    const SampleCollector run = Collect(PersonScenario(), 0.01, [&](std::uint64_t tick) {
      TickRecord record = RecordOf(tick, 1, 5);
      record.hands[open].gripping = 0;
      return record;
    });
    ASSERT_EQ(run.samples().size(), 1U);
    EXPECT_FALSE(run.samples()[0].body.hands[open].present);
    EXPECT_TRUE(run.samples()[0].body.hands[1 - open].present);
  }
}

// The posture is unknown while no hand is on a handle. The next known posture must not depend on
// the last one.
TEST(Samples, ThatAreHeldLeaveOutTheTimeWithoutHands) {
  const SampleCollector run = Collect(PersonScenario(), 0.05, [](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1, 5);
    if (tick > 20 && tick <= 30) record.hands[0].gripping = record.hands[1].gripping = 0;
    return record;
  });
  ASSERT_EQ(run.samples().size(), 5U);
  EXPECT_FALSE(run.samples()[2].continues);
  const std::vector<PersonSample> held = Held(run.samples());
  ASSERT_EQ(held.size(), 4U);
  EXPECT_TRUE(held[1].continues);
  EXPECT_FALSE(held[2].continues);
  EXPECT_TRUE(held[3].continues);
}

TEST(PersonSetup, ReportsMissingDataAndTheRemedy) {
  Scenario scenario = PersonScenario();
  EXPECT_TRUE(MissingForPosture(scenario).empty());
  scenario.operator_.stance.reset();
  ASSERT_EQ(MissingForPosture(scenario).size(), 1U);
  EXPECT_NE(MissingForPosture(scenario)[0].find("Add operator.stance"), std::string::npos);
  scenario.operator_.body.reset();
  EXPECT_EQ(MissingForPosture(scenario).size(), 2U);
  EXPECT_ANY_THROW(SetupOf(scenario, RecordOf(1, 1, 0)));
}

}  // namespace
}  // namespace predictor::assessment
