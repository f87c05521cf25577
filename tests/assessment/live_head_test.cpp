// Tests that the live evaluation uses the measured head as the evaluation of a recording does.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "assessment/assessment.h"
#include "assessment/live_person.h"
#include "assessment/samples.h"

namespace predictor::assessment {
namespace {

// The head moves, so an evaluation that uses it at a wrong time gets another result.
HeadRecord HeadAt(std::uint64_t tick) {
  HeadRecord head;
  head.wall_ns = kBegin + kMilli * tick;
  head.p = {0.75 - 2e-4 * static_cast<double>(tick), 0, kGround + 1.55};
  head.q = {0, 0, 0, 1};  // looks along -x
  return head;
}

std::vector<HeadRecord> Heads(std::uint64_t first, std::uint64_t last) {
  std::vector<HeadRecord> heads;
  for (std::uint64_t tick = first; tick <= last; tick += 25) heads.push_back(HeadAt(tick));
  return heads;
}

// Evaluates the ticks 1 to `last` and returns all states. The heads are known before the ticks.
std::vector<PersonState> Follow(const std::vector<HeadRecord>& heads, std::uint64_t last) {
  LivePerson live(PersonScenario(), {});
  for (const HeadRecord& head : heads) live.head().Take(head, head.wall_ns);
  std::vector<PersonState> states;
  for (std::uint64_t tick = 1; tick <= last; ++tick)
    if (live.Add(TickAt(tick))) states.push_back(live.state());
  return states;
}

Assessment AssessWith(const std::vector<HeadRecord>& heads, double duration) {
  tracks::BodyTrack track;
  track.source = "the headset";
  track.of_the_run = true;
  track.head.emplace();
  const std::uint64_t first = TickAt(1).wall_ns;  // the recording starts at tick 1
  for (const HeadRecord& head : heads)
    AppendMeasured(head, 1e-9 * (static_cast<double>(head.wall_ns) - static_cast<double>(first)),
                   &*track.head);
  AssessOptions options;
  options.tracks = {track};
  return Assess(PersonScenario(), 9, RunOf(Collect(PersonScenario(), duration, TickAt)), options);
}

const QuantityResult& QuantityOf(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q;
  throw std::out_of_range(path);
}

TEST(LiveHead, GivesThePostureAndTheIntervalsOfTheRecordedRun) {
  const auto heads = Heads(0, 600);
  const Assessment a = AssessWith(heads, 0.6);
  ASSERT_EQ(a.measured.parts.size(), 2u);
  EXPECT_EQ(a.measured.parts[0].share, 1);
  const std::vector<PersonState> states = Follow(heads, 600), modelled = Follow({}, 600);
  ASSERT_EQ(states.size(), 60u);
  const auto flexion = [](const PersonState& state) {
    return state.gauges[static_cast<std::size_t>(PersonGauge::kTrunkFlexion)];
  };
  const QuantityResult& recorded = QuantityOf(a, "trunk.flexion_rad");
  for (std::size_t i = 0; i + kLiveDelay < states.size(); ++i) {
    const PersonState& state = states[i + kLiveDelay];
    EXPECT_EQ(state.head, HeadSource::kMeasured);
    EXPECT_NEAR(flexion(state).value, recorded.values[i], 2e-3) << i;
  }
  // The measured head differs clearly from the modelled one, and the intervals are narrower.
  EXPECT_GT(std::abs(flexion(states.back()).value - flexion(modelled.back()).value), 0.02);
  EXPECT_NEAR(states.back().interval_time, a.sampled_times[1], 1e-9);
  EXPECT_NEAR(flexion(states.back()).low, recorded.low[1], 2e-3);
  EXPECT_NEAR(flexion(states.back()).high, recorded.high[1], 2e-3);
  EXPECT_LT(flexion(states.back()).high - flexion(states.back()).low,
            flexion(modelled.back()).high - flexion(modelled.back()).low);
}

// The loop does not make up for missed ticks, so the number of ticks is not the time.
TEST(LiveHead, IsRelatedToTheTicksByTheClock) {
  constexpr std::uint64_t kMissed = 400;
  const auto late = [](std::uint64_t tick) {
    TickRecord record = TickAt(tick);
    if (tick > 1) record.wall_ns += kMilli * kMissed;
    return record;
  };
  LivePerson live(PersonScenario(), {});
  for (const HeadRecord& head : Heads(kMissed, kMissed + 100)) live.head().Take(head, head.wall_ns);
  for (std::uint64_t tick = 1; tick <= 100; ++tick) live.Add(late(tick));
  EXPECT_EQ(live.state().head, HeadSource::kMeasured);
  const SampleCollector run = Collect(PersonScenario(), 0.1, late);
  EXPECT_NEAR(run.samples().back().recorded, 0.095, 1e-9);
  EXPECT_NEAR(run.samples().back().by_clock, 0.495, 1e-9);
}

TEST(LiveHead, IsModelledInAGapAndAfterTheLastHead) {
  auto heads = Heads(0, 200);
  for (const HeadRecord& head : Heads(275, 400)) heads.push_back(head);
  for (const PersonState& state : Follow(heads, 600)) {
    const double middle = static_cast<double>(state.tick) - 4;  // see PersonState::run_time
    const bool measured = middle <= 200 || (middle >= 275 && middle <= 400);
    EXPECT_EQ(state.head, measured ? HeadSource::kMeasured : HeadSource::kModelled) << middle;
  }
}

TEST(LiveHead, IsNotUsedWhileMostHeadsAreImpossible) {
  auto heads = Heads(0, 600);
  for (HeadRecord& head : heads)
    if (head.wall_ns < kBegin + 300 * kMilli) head.p[2] += 3;
  auto registered = heads;
  for (HeadRecord& head : registered)
    if (head.wall_ns >= kBegin + 300 * kMilli) head.registration.yaw = 0.1;
  const auto modelled = Follow({}, 500), states = Follow(heads, 500);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(states[i].head, HeadSource::kImpossible) << i;
    EXPECT_EQ(states[i].points, modelled[i].points) << i;
  }
  // A new registration gives the headset a new chance. Here the heads arrive with their ticks.
  LivePerson live(PersonScenario(), {});
  for (std::uint64_t tick = 1; tick <= 400; ++tick) {
    for (const HeadRecord& head : registered)
      if (head.wall_ns == kBegin + kMilli * (tick + 24)) live.head().Take(head, head.wall_ns);
    live.Add(TickAt(tick));
    if (tick == 250) {
      EXPECT_EQ(live.state().head, HeadSource::kImpossible);
    }
  }
  EXPECT_EQ(live.state().head, HeadSource::kMeasured);
}

TEST(LiveHead, IsAwaitedOnlyWhileItMayArrive) {
  LiveHead head;
  const auto at = [](std::uint64_t tick) { return kBegin + kMilli * tick; };
  EXPECT_FALSE(head.IsAwaited(at(100), at(100)));  // no headset
  head.Take(HeadAt(100), at(100));
  EXPECT_FALSE(head.IsAwaited(at(100), at(200)));  // it is here
  EXPECT_TRUE(head.IsAwaited(at(101), at(101)));
  EXPECT_TRUE(head.IsAwaited(at(101), at(399)));
  EXPECT_FALSE(head.IsAwaited(at(101), at(401)));  // too late
  head.Take(HeadAt(90), at(100));                  // older than the previous one
  EXPECT_FALSE(head.IsAwaited(at(100), at(200)));
  HeadRecord bad = HeadAt(500);
  bad.p[0] = NAN;
  head.Take(bad, at(500));
  head.Take(HeadAt(2000), at(500));  // from a far future
  EXPECT_TRUE(head.IsAwaited(at(101), at(399)));
}

}  // namespace
}  // namespace predictor::assessment
