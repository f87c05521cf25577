#include "assessment/lifts.h"

#include <gtest/gtest.h>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/samples.h"

namespace predictor::assessment {
namespace {

constexpr LiftingWork kWork = {18, Sex::kMale};

bool Always(double) { return true; }

// Returns a run in which the hands' height changes as `height` states. The two hands together carry
// 98.1 N.
SampleCollector MovedRun(double duration, const std::function<double(double)>& height,
                         const std::function<bool(double)>& holds = Always) {
  return Collect(PersonScenario(), duration, [&](std::uint64_t tick) {
    const double t = 1e-3 * static_cast<double>(tick);
    TickRecord record = RecordOf(tick, height(t), 49.05);
    for (HandRecord& hand : record.hands) hand.gripping = holds(t) ? 1 : 0;
    return record;
  });
}

// Returns the lifts, or the lowerings, of such a run.
std::vector<Lift> MovesIn(double duration, const std::function<double(double)>& height,
                          bool lowered, const std::function<bool(double)>& holds = Always,
                          const LiftingWork& work = kWork) {
  const SampleCollector run = MovedRun(duration, height, holds);
  const PersonSetup setup = SetupOf(PersonScenario(), RunOf(run).handles);
  std::vector<Lift> lifts = LiftsOf(run.samples(), setup.stance, work);
  std::erase_if(lifts, [&](const Lift& lift) { return lift.lowered != lowered; });
  return lifts;
}

std::vector<Lift> LiftsIn(double duration, const std::function<double(double)>& height,
                          const std::function<bool(double)>& holds = Always) {
  return MovesIn(duration, height, false, holds);
}

// The height rises from 0.7 to 1.1 m within two seconds.
double OneLift(double t) {
  const double s = std::clamp((t - 1) / 2, 0.0, 1.0);
  return 0.7 + 0.4 * s * s * s * (10 + s * (6 * s - 15));
}

// Up, down, and up again.
double Twice(double t) { return t < 3 ? OneLift(t) : t < 6 ? OneLift(6 - t) : OneLift(t - 6); }

TEST(Lifts, HaveOriginDestinationAndTheCarriedWeight) {
  const std::vector<Lift> lifts = LiftsIn(6, OneLift);
  ASSERT_EQ(lifts.size(), 1U);
  EXPECT_NEAR(lifts[0].origin.height, 0.7, 1e-9);
  EXPECT_NEAR(lifts[0].destination.height, 1.1, 1e-9);
  EXPECT_NEAR(lifts[0].origin.horizontal, 0.45, 1e-9);
  EXPECT_NEAR(lifts[0].origin.asymmetry, 0, 1e-9);
  EXPECT_NEAR(lifts[0].vertical_force, 98.1, 1e-9);
}

// A rise of 6 cm is a lift of 6 cm, although it begins and ends slowly. It is shorter than the
// lifts that LM-MMH's study examined, so no share of people follows.
TEST(Lifts, AShortLiftHasItsWholeHeightButNoShareOfPeople) {
  const auto height = [](double t) { return 1 + 0.15 * (OneLift(t) - 0.7); };
  const std::vector<Lift> lifts = LiftsIn(6, height);
  ASSERT_EQ(lifts.size(), 1U);
  EXPECT_NEAR(lifts[0].destination.height - lifts[0].origin.height, 0.06, 1e-9);
  ASSERT_TRUE(lifts[0].acceptable.outside);
  const std::string text = Sentence(lifts[0]);
  EXPECT_NE(text.find("outside the range of LM-MMH"), std::string::npos) << text;
  EXPECT_EQ(text.find("is acceptable to"), std::string::npos) << text;
  const Assessment a = Assess(PersonScenario(), 9, MovedRun(6, height), {.intervals = false});
  EXPECT_NE(AssessmentJson(a).find(R"("share_that_accepts": null)"), std::string::npos);
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
  EXPECT_EQ(LiftsIn(12, Twice).size(), 2U);
  EXPECT_TRUE(LiftsIn(4, [](double t) { return 1 + 0.02 * std::sin(10 * t); }).empty());
  EXPECT_TRUE(LiftsIn(4, [](double t) { return 1.2 - 0.1 * t; }).empty());  // lowered
}

// Between the two lifts, the object is lowered by the same distance.
TEST(Lifts, LoweringsAreJudgedByTheEquationForLowering) {
  const std::vector<Lift> moves = MovesIn(12, Twice, true);
  ASSERT_EQ(moves.size(), 1U);
  EXPECT_NEAR(moves[0].origin.height, 1.1, 1e-5);
  EXPECT_NEAR(moves[0].destination.height, 0.7, 1e-5);
  const ergonomics::VerticalHandling task = {
      .reach = 0.45, .mid_height = 0.9, .travel = 0.4, .frequency = 5};
  const double lower = ergonomics::AcceptableLower(task, Sex::kMale).mean;
  EXPECT_NEAR(moves[0].acceptable.mean / lower, 1, 0.02);
  EXPECT_LT(ergonomics::AcceptableLift(task, Sex::kMale).mean / lower, 0.95);
  const auto sinking = [](double t) { return 1.2 - 0.1 * t; };
  EXPECT_EQ(MovesIn(4, sinking, true).size(), 1U);
  EXPECT_TRUE(MovesIn(6, OneLift, true).empty());
}

// At ten lifts a minute below 0.75 m, table 5 of the manual gives 0.45 for one hour and 0.26 for
// two hours. A poor coupling has the factor 0.9.
TEST(Lifts, DependOnTheDurationAndTheCouplingOfTheWork) {
  const auto index = [](const LiftingWork& work) {
    return MovesIn(6, OneLift, false, Always, work).at(0).niosh.carried.index;
  };
  const double usual = index(kWork);
  LiftingWork longer = kWork, poor = kWork;
  longer.duration = ergonomics::LiftDuration::kModerate;
  poor.coupling = ergonomics::Coupling::kPoor;
  EXPECT_NEAR(index(longer) / usual, 0.45 / 0.26, 1e-9);
  EXPECT_NEAR(index(poor) / usual, 1 / 0.9, 1e-9);
}

// A job of several equal tasks is a single task at the sum of their frequencies.
TEST(Lifts, EqualLiftsAreAJobWithTheIndexOfOneTask) {
  const std::vector<Lift> lifts = LiftsIn(12, Twice);
  const LiftingJob job = JobOf(lifts, 0.2);
  EXPECT_EQ(job.lifts, 2U);
  EXPECT_NEAR(job.carried / lifts[0].niosh.carried.index, 1, 0.01);
  EXPECT_NEAR(job.unassisted / lifts[0].niosh.unassisted.index, 1, 0.01);
  // Two runs with the same lifts are the same job.
  std::vector<Lift> both = lifts;
  both.insert(both.end(), lifts.begin(), lifts.end());
  EXPECT_NEAR(JobOf(both, 0.4).carried / job.carried, 1, 0.01);
  both[0].one_hand = true;
  EXPECT_EQ(JobOf(both, 0.4).lifts, 3U);
  EXPECT_EQ(JobOf({}, 1).carried, 0);
}

TEST(Lifts, AHandExertsItselfAtEachGripAndMove) {
  const auto exertions = [](double duration, const std::function<double(double)>& height,
                            const std::function<bool(double)>& holds) {
    const SampleCollector run = MovedRun(duration, height, holds);
    const PersonSetup setup = SetupOf(PersonScenario(), RunOf(run).handles);
    const std::vector<Lift> lifts = LiftsOf(run.samples(), setup.stance, kWork);
    return ExertionsOf(run.samples(), 0, lifts);
  };
  const auto still = [](double) { return 1.0; };
  EXPECT_EQ(exertions(4, still, Always), 1U);
  EXPECT_EQ(exertions(4, still, [](double t) { return t < 1 || t > 3; }), 2U);
  EXPECT_EQ(exertions(4, still, [](double) { return false; }), 0U);
  EXPECT_EQ(exertions(12, Twice, Always), 3U);
}

// DUET needs the effort of the grip.
TEST(Lifts, AStatedGripEnablesDuet) {
  const SampleCollector run = MovedRun(12, Twice);
  const auto judge = [&](std::optional<double> effort) {
    AssessOptions options{.intervals = false};
    options.work.grip_effort = effort;
    return Assess(PersonScenario(), 9, run, options);
  };
  const auto of_hand = [](const DamageResult& d) { return d.tool == "DUET"; };
  const Assessment stated = judge(4), unknown = judge({});
  EXPECT_EQ(std::ranges::count_if(stated.damage, of_hand), 2);
  const auto left = std::ranges::find_if(stated.damage, of_hand);
  EXPECT_NEAR(left->per_run, 3 * ergonomics::HandDamage(4), 1e-15);
  EXPECT_EQ(std::ranges::count_if(unknown.damage, of_hand), 0);
  EXPECT_TRUE(std::ranges::any_of(unknown.not_evaluable, [](const NotEvaluable& gap) {
    return gap.why.find("--grip-effort") != std::string::npos;
  }));
  EXPECT_NE(AssessmentText(stated).find("exerts itself 3 times"), std::string::npos);
}

TEST(Lifts, AStandingPersonDoesNotPush) {
  const SampleCollector run = Collect(PersonScenario(), 2, [](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1, 5);
    for (HandRecord& hand : record.hands) hand.real.pose.p[1] += tick > 1000 ? 0.3 : 0;
    return record;
  });
  const PersonSetup setup = SetupOf(PersonScenario(), RunOf(run).handles);
  EXPECT_NEAR(HorizontalTravel(run.samples(), setup.stance), 0.3, 1e-9);
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
  EXPECT_TRUE(LiftsOf(run.samples(), SetupOf(scenario, RunOf(run).handles).stance, {9, Sex::kMale})
                  .empty());
}

}  // namespace
}  // namespace predictor::assessment
