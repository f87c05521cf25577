// Tests that the live evaluation uses the streams of other systems as the evaluation of a recording
// does.
#include "assessment/live_streams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "assessment/assessment.h"
#include "assessment/live_person.h"
#include "assessment/measured_body.h"
#include "assessment/samples.h"
#include "core/error.h"

namespace predictor::assessment {
namespace {

tracks::StreamDescription Electrode() {
  tracks::StreamDescription stream{.name = "EMG", .rate = 1000};
  stream.map =
      "stream: EMG\n"
      "emg:\n"
      "  - {channel: E1, arm: right, muscles: [triceps_long, triceps_lateral], mvc: 1}\n";
  stream.channels = {"E1"};
  stream.units = {"mV"};
  return stream;
}

tracks::StreamDescription Tracker() {
  tracks::StreamDescription stream{.name = "tracker", .rate = 100};
  stream.channels = {"left_elbow.p.x", "left_elbow.p.y", "left_elbow.p.z"};
  stream.units = {"m", "m", "m"};
  return stream;
}

// The device sends each position 50 ms after it measured it.
tracks::StreamDescription LateTracker() {
  tracks::StreamDescription stream{.name = "tracker", .rate = 100};
  stream.map =
      "stream: tracker\n"
      "offset: -0.05\n"
      "left_elbow: {position: [LE]}\n";
  stream.channels = {"LE.x", "LE.y", "LE.z"};
  stream.units = {"m", "m", "m"};
  return stream;
}

StreamSample Sample(std::uint64_t tick, std::initializer_list<double> values) {
  StreamSample sample{.wall_ns = kBegin + kMilli * tick};
  sample.count = static_cast<std::uint32_t>(values.size());
  std::ranges::copy(values, sample.values.begin());
  return sample;
}

// A tone whose amplitude changes slowly, so an evaluation that uses it at a wrong time gets another
// result.
StreamSample Voltage(std::uint64_t tick) {
  const double t = 1e-3 * static_cast<double>(tick);
  const double amplitude = 0.3 + 0.15 * std::sin(2 * std::numbers::pi * t);
  return Sample(tick, {amplitude * std::sin(2 * std::numbers::pi * 120 * t)});
}

// The elbow moves outwards.
StreamSample Elbow(std::uint64_t tick) {
  return Sample(tick, {0.75, -0.25 - 1e-4 * static_cast<double>(tick), 0.15});
}

using Source = StreamSample (*)(std::uint64_t tick);

// Evaluates the ticks 1 to `last` and returns all states. Each sample arrives at its time.
std::vector<PersonState> FollowStream(const tracks::StreamDescription& stream, Source source,
                                      std::uint64_t every, std::uint64_t last) {
  LivePerson live(PersonScenario(), {}, std::span(&stream, 1));
  std::vector<PersonState> states;
  for (std::uint64_t tick = 1; tick <= last; ++tick) {
    if (source != nullptr && tick % every == 0)
      live.streams().Take(source(tick), TickAt(tick).wall_ns);
    if (live.Add(TickAt(tick))) states.push_back(live.state());
  }
  return states;
}

// Returns what a recording of the ticks 1 to `last` contains.
tracks::BodyTrack RecordedTrack(const tracks::StreamDescription& stream, Source source,
                                std::uint64_t every, std::uint64_t last) {
  tracks::StreamTrack track(stream);
  for (std::uint64_t tick = every; tick <= last; tick += every) {
    const StreamSample sample = source(tick);
    track.Take(1e-3 * static_cast<double>(tick - 1),  // the recording starts at tick 1
               std::span(sample.values).first(sample.count));
  }
  track.Convert();
  tracks::BodyTrack recorded = track.track();
  recorded.of_the_run = true;
  return recorded;
}

Assessment AssessStream(const tracks::StreamDescription& stream, Source source, std::uint64_t every,
                        std::uint64_t last) {
  AssessOptions options;
  options.tracks = {RecordedTrack(stream, source, every, last)};
  options.intervals = false;
  return Assess(PersonScenario(), 9,
                RunOf(Collect(PersonScenario(), 1e-3 * static_cast<double>(last), TickAt)),
                options);
}

const QuantityResult& ResultOf(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q;
  throw std::out_of_range(path);
}

double GaugeOf(const PersonState& state, PersonGauge gauge) {
  return state.gauges[static_cast<std::size_t>(gauge)].value;
}

const InputState& InputOf(const PersonState& state, PersonInput input) {
  return state.inputs[static_cast<std::size_t>(input)];
}

TEST(LiveStreams, MoveTheElbowAsInTheRecordedRun) {
  const std::vector<PersonState> with = FollowStream(Tracker(), Elbow, 10, 600),
                                 without = FollowStream(Tracker(), nullptr, 10, 600);
  const Assessment a = AssessStream(Tracker(), Elbow, 10, 600);
  ASSERT_EQ(a.measured.parts.size(), 1u);
  EXPECT_GT(a.measured.parts[0].share, 0.97);
  const QuantityResult& recorded = ResultOf(a, "strength.left_shoulder");
  for (std::size_t i = 3; i + kLiveDelay < with.size(); ++i) {
    const PersonState& state = with[i + kLiveDelay];
    EXPECT_EQ(InputOf(state, PersonInput::kLeftElbow).status, InputStatus::kMeasured) << i;
    EXPECT_NEAR(GaugeOf(state, PersonGauge::kLeftShoulderUse), recorded.values[i], 2e-3) << i;
  }
  EXPECT_EQ(InputOf(without.back(), PersonInput::kLeftElbow).status, InputStatus::kMissing);
  double largest = 0;  // effect of the stream
  for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i)
    largest = std::max(largest, std::abs(GaugeOf(with[i], PersonGauge::kLeftShoulderUse) -
                                         GaugeOf(without[i], PersonGauge::kLeftShoulderUse)));
  EXPECT_GT(largest, 0.01);
}

TEST(LiveStreams, MoveTheActivationsAsInTheRecordedRun) {
  const std::vector<PersonState> with = FollowStream(Electrode(), Voltage, 1, 1500),
                                 without = FollowStream(Electrode(), nullptr, 1, 1500);
  const Assessment a = AssessStream(Electrode(), Voltage, 1, 1500);
  const QuantityResult& recorded = ResultOf(a, "muscles.right.largest");
  double difference = 0;
  // The filter has settled after 0.75 s, and is known until 1/6 s before the end.
  for (std::size_t i = 75; i + kLiveDelayWithEmg < with.size(); ++i) {
    const PersonState& state = with[i + kLiveDelayWithEmg];
    EXPECT_EQ(InputOf(state, PersonInput::kRightEmg).status, InputStatus::kMeasured) << i;
    EXPECT_NEAR(GaugeOf(state, PersonGauge::kRightActivation), recorded.values[i], 0.02) << i;
    difference =
        std::max(difference,
                 std::abs(GaugeOf(state, PersonGauge::kRightActivation) -
                          GaugeOf(without[i + kLiveDelayWithEmg], PersonGauge::kRightActivation)));
  }
  EXPECT_GT(difference, 0.1);
  EXPECT_EQ(InputOf(without.back(), PersonInput::kRightEmg).status, InputStatus::kMissing);
  EXPECT_EQ(InputOf(with.back(), PersonInput::kLeftEmg).status, InputStatus::kNone);
}

TEST(LiveStreams, AddTheOffsetOnceAsInTheRecordedRun) {
  const tracks::StreamDescription stream = LateTracker();
  const SampleCollector run = Collect(PersonScenario(), 0.6, TickAt);
  const PersonSetup setup = SetupOf(PersonScenario(), RunOf(run).handles);
  const tracks::BodyTrack track = RecordedTrack(stream, Elbow, 10, 600);
  std::vector<PersonSample> recorded = run.samples();
  AddTracks(std::span(&track, 1), setup, 0, &recorded);
  LiveStreams live(std::span(&stream, 1));
  for (std::uint64_t tick = 10; tick <= 600; tick += 10)
    live.Take(Elbow(tick), TickAt(tick).wall_ns);
  std::size_t measured = 0;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    PersonSample sample = run.samples()[i];
    PersonState state;
    const double clock = Seconds(TickAt(1).wall_ns) + sample.by_clock;
    live.Update(clock, sample.body.time, &state);
    live.AddTo(clock, setup, &sample, &state);
    const auto &now = sample.body.p_WElbow[0], &afterwards = recorded[i].body.p_WElbow[0];
    ASSERT_EQ(now.has_value(), afterwards.has_value()) << i;
    if (!now) continue;
    ++measured;
    EXPECT_NEAR((*now - *afterwards).norm(), 0, 1e-9) << i;
    // The position at this time was sent at a later tick.
    const double sent = 1e3 * (sample.by_clock + 0.05) + 1;
    EXPECT_NEAR(now->y(), -0.25 - 1e-4 * sent, 1e-9) << i;
  }
  EXPECT_GE(measured, 50u);  // of 60; what was measured in the last 50 ms is sent after the end
}

TEST(LiveStreams, WaitForWhatADeviceSendsLate) {
  const tracks::StreamDescription late = LateTracker(), prompt = Tracker();
  LiveStreams streams(std::span(&late, 1)), others(std::span(&prompt, 1));
  const std::uint64_t now = TickAt(100).wall_ns;
  streams.Take(Elbow(100), now);  // measured at tick 50
  others.Take(Elbow(100), now);
  EXPECT_FALSE(streams.IsAwaited(TickAt(45).wall_ns, now));
  EXPECT_TRUE(streams.IsAwaited(TickAt(55).wall_ns, now));
  EXPECT_TRUE(streams.IsAwaited(TickAt(95).wall_ns, now));
  EXPECT_FALSE(others.IsAwaited(TickAt(95).wall_ns, now));
  EXPECT_FALSE(streams.IsAwaited(TickAt(95).wall_ns, TickAt(1000).wall_ns));  // the stream ended
}

tracks::StreamDescription HeadTracker() {
  tracks::StreamDescription stream{.name = "head", .rate = 100};
  stream.channels = {"head.p.x", "head.p.y", "head.p.z"};
  stream.units = {"m", "m", "m"};
  return stream;
}

TEST(LiveStreams, GiveNoHeadWhileMostHeadsAreImpossible) {
  const Source wrong_at_first = [](std::uint64_t tick) {
    return Sample(tick, {0.85, 0, tick <= 300 ? 3.75 : 0.75});
  };
  const Source right = [](std::uint64_t tick) { return Sample(tick, {0.85, 0, 0.75}); };
  const auto wrong = FollowStream(HeadTracker(), wrong_at_first, 10, 500),
             good = FollowStream(HeadTracker(), right, 10, 500),
             modelled = FollowStream(HeadTracker(), nullptr, 10, 500);
  for (std::size_t i = 1; i < wrong.size(); ++i) {
    EXPECT_EQ(good[i].head, HeadSource::kMeasured) << i;
    EXPECT_EQ(wrong[i].head, HeadSource::kImpossible) << i;
    EXPECT_EQ(wrong[i].points, modelled[i].points) << i;
  }
}

TEST(LiveStreams, AreMissingWhileNothingIsEvaluated) {
  tracks::StreamDescription stream = Tracker();
  stream.channels.emplace_back("pulse");
  stream.units.emplace_back("1/min");
  LivePerson live(PersonScenario(), {}, std::span(&stream, 1));
  const auto status = [&live](PersonInput input) { return InputOf(live.state(), input).status; };
  for (std::uint64_t tick = 1; tick <= 400; ++tick) {
    TickRecord record = TickAt(tick);
    for (HandRecord& hand : record.hands) hand.gripping = tick <= 300 ? 1 : 0;
    if (tick % 10 == 0) live.streams().Take(Sample(tick, {0.75, -0.25, 0.15, 70}), record.wall_ns);
    live.Add(record);
    if (tick != 300) continue;
    EXPECT_EQ(status(PersonInput::kLeftElbow), InputStatus::kMeasured);
    EXPECT_EQ(status(PersonInput::kRightElbow), InputStatus::kNone);
  }
  ASSERT_EQ(live.state().status, PersonStatus::kNoHand);
  EXPECT_EQ(status(PersonInput::kLeftElbow), InputStatus::kMissing);
  EXPECT_EQ(status(PersonInput::kRightElbow), InputStatus::kNone);
  EXPECT_EQ(status(PersonInput::kHeartRate), InputStatus::kMeasured);
  EXPECT_EQ(live.state().heart_rate, 70);
  TickRecord over = TickAt(401);
  over.ran = 0;
  ASSERT_TRUE(live.Add(over));
  EXPECT_EQ(status(PersonInput::kHeartRate), InputStatus::kMissing);
  EXPECT_TRUE(std::isnan(live.state().heart_rate));
}

// Returns the problems of an electromyogram without the samples of the ticks `from` to `to`.
std::vector<std::string> ProblemsOf(Source source, std::uint64_t last, std::uint64_t from = 0,
                                    std::uint64_t to = 0) {
  const tracks::StreamDescription stream = Electrode();
  LivePerson live(PersonScenario(), {}, std::span(&stream, 1));
  for (std::uint64_t tick = 1; tick <= last; ++tick) {
    if (tick < from || tick > to) live.streams().Take(source(tick), TickAt(tick).wall_ns);
    live.Add(TickAt(tick));
  }
  return live.streams().TakeProblems();
}

TEST(LiveStreams, ReportAnElectromyogramOnlyIfItsProblemLasts) {
  const Source constant = [](std::uint64_t tick) { return Sample(tick, {0.1}); };
  EXPECT_TRUE(ProblemsOf(Voltage, 1600, 700, 1000).empty());
  EXPECT_TRUE(ProblemsOf(constant, 1500).empty());
  const std::vector<std::string> problems = ProblemsOf(constant, 2600);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].find("the same value throughout"), std::string::npos) << problems[0];
}

TEST(LiveStreams, RefuseWhatIsMeasuredTwice) {
  const std::vector<tracks::StreamDescription> trackers = {Tracker(), Tracker()},
                                               electrodes = {Electrode(), Electrode()};
  EXPECT_THROW(LiveStreams{trackers}, InputError);
  EXPECT_THROW(LiveStreams{electrodes}, InputError);
}

}  // namespace
}  // namespace predictor::assessment
