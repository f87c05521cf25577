#include "assessment/live_person.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "assessment/assessment.h"
#include "assessment/measured_emg.h"
#include "assessment/samples.h"
#include "core/error.h"

namespace predictor::assessment {
namespace {

// The hands rise by 0.3 m and return within 2 s, with a force that changes.
TickRecord LiftedRecord(std::uint64_t tick) {
  const double t = 1e-3 * static_cast<double>(tick);
  const double up = 0.5 - 0.5 * std::cos(std::numbers::pi * t);
  return RecordOf(tick, 0.85 + 0.3 * up, 15 + 25 * up);
}

struct Recorded {
  Scenario scenario = PersonScenario();
  SampleCollector run;
  PersonSetup setup;
  NominalChain nominal;
  explicit Recorded(double duration)
      : run(Collect(scenario, duration, LiftedRecord)),
        setup(SetupOf(scenario, run.first())),
        nominal(RunNominal(setup, run.samples(), {}, [](double) {})) {}
};

// Returns all states during a run and the state after it.
std::vector<PersonState> Follow(LivePerson* person, double duration) {
  std::vector<PersonState> states;
  const auto ticks = static_cast<std::uint64_t>(std::lround(1e3 * duration));
  for (std::uint64_t tick = 1; tick <= ticks; ++tick)
    if (person->Add(LiftedRecord(tick))) states.push_back(person->state());
  TickRecord over = LiftedRecord(ticks + 1);
  over.ran = 0;
  if (person->Add(over)) states.push_back(person->state());
  return states;
}

const GaugeState& Gauge(const PersonState& state, PersonGauge gauge) {
  return state.gauges[static_cast<std::size_t>(gauge)];
}

// In a recording this short, the live chain already knows all samples, so it must perform the same
// computation as the recorded chain.
TEST(LiveChain, IsExactOverAShortPart) {
  const Recorded recorded(0.4);
  NominalChain nominal = recorded.nominal;
  std::vector<MeasuredEmg> none;
  AddMuscles(recorded.setup, recorded.run.samples(), nullptr, &none, &nominal);
  LiveChain live(recorded.setup, {});
  for (const PersonSample& sample : recorded.run.samples()) live.Add(sample);
  std::size_t i = 0;
  for (JudgedSample judged; live.Next(true, &judged); ++i) {
    const Frame& frame = nominal.frames[i];
    for (std::size_t h = 0; h < kHands; ++h) {
      EXPECT_GT(frame.muscles[h].values[kLargestActivation], 0.05);
      EXPECT_EQ(judged.frame.muscles[h].values, frame.muscles[h].values);
    }
    EXPECT_EQ(judged.frame.loads.torque, frame.loads.torque);
    EXPECT_EQ(judged.frame.loads.l5s1.compression, frame.loads.l5s1.compression);
    EXPECT_EQ(judged.frame.rula.grand, frame.rula.grand);
  }
  EXPECT_EQ(i, recorded.nominal.frames.size());
}

// Postures and measured forces need no later sample, so they are exact. Loads may differ by the
// effect of samples that the filter receives after kLiveDelay.
TEST(LiveChain, AgreesWithTheRecordedChainInALongRun) {
  const Recorded recorded(4);
  LiveChain live(recorded.setup, {});
  std::size_t judged_count = 0;
  double compression = 0, use = 0;
  for (std::size_t i = 0; i < recorded.run.samples().size(); ++i) {
    live.Add(recorded.run.samples()[i]);
    EXPECT_EQ(live.newest().q, recorded.nominal.postures[i].q);
    for (JudgedSample judged; live.Next(false, &judged); ++judged_count) {
      const Frame& frame = recorded.nominal.frames[judged_count];
      EXPECT_EQ(judged.sample.body.time, recorded.run.samples()[judged_count].body.time);
      EXPECT_EQ(judged.force_rate, ForceRates(recorded.run.samples(), judged_count));
      compression = std::max(compression, std::abs(judged.frame.loads.l5s1.compression -
                                                   frame.loads.l5s1.compression));
      use = std::max(use, std::abs(judged.frame.shoulder_use[0] - frame.shoulder_use[0]));
    }
    EXPECT_EQ(judged_count, i < kLiveDelay ? 0 : i + 1 - kLiveDelay);
  }
  EXPECT_LT(compression, 5);  // of about 1500 N
  EXPECT_LT(use, 0.005);      // of about 0.3
}

TEST(LivePerson, EndsWithTheDamageAndFatigueOfTheRecordedRun) {
  const Recorded recorded(6);
  const Assessment a = Assess(recorded.scenario, 9, recorded.run, {.intervals = false});
  LivePerson live(recorded.scenario, {});
  const PersonState last = Follow(&live, 6).back();
  ASSERT_EQ(a.damage.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(a.damage[i].per_run, 0);
    EXPECT_NEAR(last.parts[i].damage / a.damage[i].per_run, 1, 0.01) << i;
    EXPECT_NEAR(last.parts[i].day_share / a.damage[i].day_share, 1, 0.01) << i;
  }
  // Only LiFFT states up to which load it is valid.
  EXPECT_GT(a.damage[0].load_over_range, 0);
  EXPECT_NEAR(last.parts[0].load_over_range / a.damage[0].load_over_range, 1, 0.01);
  EXPECT_TRUE(std::isnan(last.parts[1].load_over_range));
  ASSERT_EQ(a.fatigue.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(a.fatigue[i].compartments.capacity, 1);
    EXPECT_NEAR(last.parts[i + 1].capacity, a.fatigue[i].compartments.capacity, 1e-4) << i;
  }
}

// The posture is still, so the live chain need not estimate any motion and must give the same
// muscle activations.
TEST(LivePerson, HasTheMusclesOfTheRecordedRun) {
  const Scenario scenario = PersonScenario();
  const auto still = [](std::uint64_t tick) { return RecordOf(tick, 1, 20); };
  const Assessment a = Assess(scenario, 9, Collect(scenario, 0.5, still), {.intervals = false});
  LivePerson live(scenario, {});
  for (std::uint64_t tick = 1; tick <= 500; ++tick) live.Add(still(tick));
  const std::map<std::string, PersonGauge> gauges = {
      {"muscles.left.largest", PersonGauge::kLeftActivation},
      {"muscles.right.largest", PersonGauge::kRightActivation},
      {"muscles.left.softest_n_per_m", PersonGauge::kLeftStiffness},
      {"muscles.right.softest_n_per_m", PersonGauge::kRightStiffness}};
  std::size_t found = 0;
  for (const QuantityResult& q : a.quantities) {
    const auto named = gauges.find(q.kind->path);
    if (named == gauges.end()) continue;
    const GaugeState& gauge = Gauge(live.state(), named->second);
    EXPECT_GT(gauge.value, 0) << named->first;
    EXPECT_NEAR(gauge.value / q.values.back(), 1, 1e-3) << named->first;
    EXPECT_FALSE(std::isfinite(gauge.low)) << "of one posture alone";
    ++found;
  }
  EXPECT_EQ(found, gauges.size());
}

// In a still posture, the intervals must be the same too.
TEST(LivePerson, HasTheIntervalsOfTheRecordedRun) {
  const Scenario scenario = PersonScenario();
  const auto still = [](std::uint64_t tick) { return RecordOf(tick, 1, 20); };
  const SampleCollector run = Collect(scenario, 0.5, still);
  const Assessment a = Assess(scenario, 9, run, {});
  LivePerson live(scenario, {});
  for (std::uint64_t tick = 1; tick <= 500; ++tick) live.Add(still(tick));
  const PersonState& state = live.state();
  for (const QuantityResult& q : a.quantities) {
    if (std::string(q.kind->path) != "lower_back.compression_n") continue;
    const GaugeState& gauge = Gauge(state, PersonGauge::kCompression);
    EXPECT_NEAR(gauge.value, q.values.back(), 0.05);
    EXPECT_NEAR(gauge.low, q.low[1], 0.05);
    EXPECT_NEAR(gauge.high, q.high[1], 0.05);
  }
  EXPECT_NEAR(state.interval_time, a.sampled_times[1], 1e-9);
  for (std::size_t i = 0; i < kPersonScores; ++i) {
    EXPECT_EQ(state.scores[i].score, a.worksheets[i].values.back());
    std::array<double, kMaxClasses> expected = {};
    for (std::size_t score = 1; score < a.worksheets[i].probability.size(); ++score)
      expected[static_cast<std::size_t>(Worksheets()[i].action(static_cast<int>(score)).level -
                                        1)] += a.worksheets[i].probability[score];
    for (std::size_t level = 0; level < kMaxClasses; ++level)
      EXPECT_NEAR(state.scores[i].probability[level], expected[level], 1e-5);
  }
}

TEST(LivePerson, DrawsTheBodyThatHoldsTheHandles) {
  LivePerson live(PersonScenario(), {});
  const PersonState state = Follow(&live, 0.5)[40];
  EXPECT_EQ(state.status, PersonStatus::kJudged);
  EXPECT_NEAR(state.run_time - state.load_time, 0.1, 1e-9);
  const auto point = [&](BodyPoint p) {
    const auto& x = state.points[static_cast<std::size_t>(p)];
    return Vector3(x[0], x[1], x[2]);
  };
  const double height = FromRecord(LiftedRecord(state.tick).hands[0].real.pose).p.z();
  EXPECT_LT((point(BodyPoint::kLeftHand) - Vector3(0.5, -0.15, height)).norm(), 0.13);
  EXPECT_LT((point(BodyPoint::kRightHand) - Vector3(0.5, 0.15, height)).norm(), 0.13);
  EXPECT_NEAR(point(BodyPoint::kLeftAnkle).x(), 0.95, 1e-6);
  EXPECT_NEAR(point(BodyPoint::kLeftToes).z(), kGround, 1e-6);
  EXPECT_LT(point(BodyPoint::kEyes).x(), point(BodyPoint::kHead).x());  // the person faces -x
}

TEST(LivePerson, StatesWhyNothingIsJudged) {
  LivePerson live(PersonScenario(), {});
  TickRecord record = RecordOf(1, 1, 20);
  record.ran = 0;
  EXPECT_FALSE(live.Add(record));
  EXPECT_EQ(live.state().status, PersonStatus::kWaiting);
  std::uint64_t tick = 1;
  const auto add = [&](int count, double height, int gripping) {
    for (int k = 0; k < count; ++k) {
      record = RecordOf(++tick, height, 20);
      for (HandRecord& hand : record.hands) hand.gripping = static_cast<std::uint8_t>(gripping);
      live.Add(record);
    }
  };
  add(300, 1, 1);
  EXPECT_EQ(live.state().status, PersonStatus::kJudged);
  EXPECT_TRUE(std::isfinite(Gauge(live.state(), PersonGauge::kCompression).value));
  add(100, 1, 0);
  EXPECT_EQ(live.state().status, PersonStatus::kNoHand);
  EXPECT_FALSE(std::isfinite(Gauge(live.state(), PersonGauge::kCompression).value));
  EXPECT_LT(live.state().parts[1].capacity, 1);  // the earlier load still counts
  add(100, -0.1, 1);
  EXPECT_EQ(live.state().status, PersonStatus::kBelowGround);
  add(100, 1, 1);
  EXPECT_EQ(live.state().status, PersonStatus::kJudged);
}

TEST(LivePerson, FollowsAReplay) {
  LivePerson live(PersonScenario(), {});
  for (std::uint64_t tick = 1; tick <= 500; ++tick) live.Add(LiftedRecord(tick));
  EXPECT_NEAR(live.state().since, 0.006, 1e-9);
  EXPECT_FALSE(live.Add(LiftedRecord(500)));  // paused
  for (std::uint64_t tick = 101; tick <= 200; ++tick) live.Add(LiftedRecord(tick));
  EXPECT_EQ(live.state().tick, 200u);
  EXPECT_NEAR(live.state().since, 0.106, 1e-9);
  EXPECT_EQ(live.state().status, PersonStatus::kJudged);
}

TEST(LivePerson, NeedsABodyAndAPlace) {
  Scenario scenario = PersonScenario();
  scenario.operator_.body.reset();
  EXPECT_THROW(LivePerson(scenario, {}), InputError);
  scenario.operator_.body = BodySpec{.height = 5, .mass = 75, .sex = Sex::kMale};
  EXPECT_THROW(LivePerson(scenario, {}), InputError);
}

TEST(Warnings, BeginAndEndWithTimeAndTwoThresholds) {
  WarningKeeper keeper;
  Frame frame;
  frame.loads.balance.margin = 0.1;
  frame.reached = true;
  double time = 0;
  const auto on_after = [&](double compression, double duration) {
    frame.loads.l5s1.compression = compression;
    std::uint16_t bits = 0;
    for (const double end = time + duration; time < end - 1e-9;)
      bits = keeper.Update(frame, time += 0.01);
    return (bits & 1U << static_cast<unsigned>(PersonWarning::kCompression)) != 0;
  };
  EXPECT_FALSE(on_after(3500, 0.1));   // short
  EXPECT_FALSE(on_after(3300, 0.02));  // interrupted
  EXPECT_FALSE(on_after(3500, 0.1));
  EXPECT_TRUE(on_after(3500, 0.02));
  EXPECT_TRUE(on_after(3200, 5));  // between the thresholds
  EXPECT_TRUE(on_after(3000, 1));
  EXPECT_FALSE(on_after(3000, 0.02));
}

// A warning about the balance must appear for low values.
TEST(Warnings, KnowInWhichDirectionAValueIsBad) {
  WarningKeeper keeper;
  Frame frame;
  frame.reached = true;
  frame.loads.balance.margin = -0.01;
  keeper.Update(frame, 0);
  const std::uint16_t bits = keeper.Update(frame, 0.2);
  EXPECT_EQ(bits, 1U << static_cast<unsigned>(PersonWarning::kBalance));
}

}  // namespace
}  // namespace predictor::assessment
