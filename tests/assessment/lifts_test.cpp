#include "assessment/lifts.h"

#include <gtest/gtest.h>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/samples.h"

namespace predictor::assessment {
namespace {

// Returns the lifts that are found if the hands' height changes as `height` states. The two hands
// together carry 98.1 N.
std::vector<Lift> LiftsIn(
    double duration, const std::function<double(double)>& height,
    const std::function<bool(double)>& holds = [](double) { return true; }) {
  const Scenario scenario = PersonScenario();
  const SampleCollector run = Collect(scenario, duration, [&](std::uint64_t tick) {
    const double t = 1e-3 * static_cast<double>(tick);
    TickRecord record = RecordOf(tick, height(t), 49.05);
    for (HandRecord& hand : record.hands) hand.gripping = holds(t) ? 1 : 0;
    return record;
  });
  const PersonSetup setup = SetupOf(scenario, RunOf(run).handles);
  return LiftsOf(run.samples(), setup.stance, 18, Sex::kMale);
}

// The height rises from 0.7 to 1.1 m within two seconds.
double OneLift(double t) {
  const double s = std::clamp((t - 1) / 2, 0.0, 1.0);
  return 0.7 + 0.4 * s * s * s * (10 + s * (6 * s - 15));
}

TEST(Lifts, HaveOriginDestinationAndTheCarriedWeight) {
  const std::vector<Lift> lifts = LiftsIn(6, OneLift);
  ASSERT_EQ(lifts.size(), 1U);
  EXPECT_NEAR(lifts[0].origin.height, 0.7, 0.011);
  EXPECT_NEAR(lifts[0].destination.height, 1.1, 0.011);
  EXPECT_NEAR(lifts[0].origin.horizontal, 0.45, 1e-9);
  EXPECT_NEAR(lifts[0].origin.asymmetry, 0, 1e-9);
  EXPECT_NEAR(lifts[0].vertical_force, 98.1, 1e-9);
}

// The recommended weight limit was calculated by hand for ten lifts a minute (one in 6 s) during
// less than an hour:
// 23 kg · 25/45 · (1 − 0.003·|70 − 75|) · (0.82 + 4.5/40) · 0.45.
TEST(Lifts, AreJudgedByNioshsEquation) {
  const std::vector<Lift> lifts = LiftsIn(6, OneLift);
  ASSERT_EQ(lifts.size(), 1U);
  const double limit = 23 * (25.0 / 45) * (1 - 0.003 * 5) * (0.82 + 4.5 / 40) * 0.45;
  EXPECT_NEAR(lifts[0].niosh.carried.index, 10 / limit, 0.02);
  EXPECT_NEAR(lifts[0].niosh.unassisted.index, 18 / limit, 0.03);
}

TEST(Lifts, AreRisesThatEndInAReversalAndNotNoise) {
  const auto twice = [](double t) {
    return t < 3 ? OneLift(t) : t < 6 ? OneLift(6 - t) : OneLift(t - 6);
  };
  EXPECT_EQ(LiftsIn(12, twice).size(), 2U);
  EXPECT_TRUE(LiftsIn(4, [](double t) { return 1 + 0.02 * std::sin(10 * t); }).empty());
  EXPECT_TRUE(LiftsIn(4, [](double t) { return 1.2 - 0.1 * t; }).empty());  // lowered
}

TEST(Lifts, EndWhenTheHandsRelease) {
  const auto holds = [](double t) { return t < 1.5 || t > 3.5; };
  EXPECT_EQ(LiftsIn(6, OneLift, holds).size(), 0U);  // it had risen by 0.04 m, and rests later
}

// The hands carry a load only around the middle of the lift.
Assessment JudgeOneLift(double force) {
  const Scenario scenario = PersonScenario();
  const SampleCollector run = Collect(scenario, 6, [&](std::uint64_t tick) {
    const double t = 1e-3 * static_cast<double>(tick);
    return RecordOf(tick, OneLift(t), force * std::exp(-8 * (t - 2) * (t - 2)));
  });
  return Assess(scenario, 9, run, {.intervals = false});
}

// A run with a single load causes the damage of its lift.
TEST(Lifts, CauseTheDamageOfTheirLargestMoment) {
  const Assessment a = JudgeOneLift(60);
  ASSERT_EQ(a.lifts.size(), 1U);
  ASSERT_TRUE(a.lifts[0].moment);
  EXPECT_GT(*a.lifts[0].moment, 15);
  EXPECT_LT(*a.lifts[0].moment, 2 * 60 * 0.5);  // the hands are at most 0.5 m from the disc
  ASSERT_EQ(a.damage[0].tool, "LiFFT");
  EXPECT_NEAR(*a.lifts[0].day_share / a.damage[0].day_share, 1, 0.01);
  EXPECT_NE(AssessmentText(a).find("This lift uses"), std::string::npos);
  EXPECT_EQ(AssessmentText(a).find("beyond the range"), std::string::npos);
}

TEST(Lifts, BeyondTheRangeOfLifftAreMarkedEverywhere) {
  const Assessment a = JudgeOneLift(400);
  ASSERT_GT(*a.lifts.at(0).moment, 100);
  const std::string text = AssessmentText(a), page = AssessmentPage(a, "1.0");
  for (const char* words :
       {"beyond the range of the method", "extrapolated: the largest load is"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words;
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
  const std::string json = AssessmentJson(a);
  EXPECT_NE(json.find(R"("outside_lifft": true)"), std::string::npos);
  EXPECT_NE(json.find(R"("outside_range": true)"), std::string::npos);
}

// The middle of the hands jumps when one hand lets go, but nothing was lifted.
TEST(Lifts, AreNotMadeByAChangeOfHands) {
  const Scenario scenario = PersonScenario();
  const SampleCollector run = Collect(scenario, 4, [&](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1, 20);
    record.hands[1].real.pose.p[2] += 0.2;
    if (tick > 2000) record.hands[0].gripping = 0;
    return record;
  });
  EXPECT_TRUE(
      LiftsOf(run.samples(), SetupOf(scenario, RunOf(run).handles).stance, 9, Sex::kMale).empty());
}

}  // namespace
}  // namespace predictor::assessment
