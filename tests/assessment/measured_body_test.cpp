#include "assessment/measured_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/person_chain.h"
#include "assessment/samples.h"
#include "core/error.h"
#include "person/body_model.h"

namespace predictor::assessment {
namespace {

constexpr double kDuration = 2;  // [s]

SampleCollector MadeRun() {
  return Collect(PersonScenario(), kDuration,
                 [](std::uint64_t tick) { return RecordOf(tick, 1.0, 20); });
}

// The true positions of the eyes and elbows in the nominal posture, in the frame W.
struct Truth {
  Pose head;
  std::array<Vector3, kHands> elbows;
};
Truth TruthOf(const SampleCollector& run) {
  const PersonSetup setup = SetupOf(PersonScenario(), RunOf(run).handles);
  const NominalChain chain = RunNominal(setup, Held(run.samples()), {}, [](double) {});
  const person::BodyModel model(setup.body);
  const person::Placement at = person::Place(model, chain.postures.back().q);
  Truth truth;
  truth.head = setup.stance.X_WS * at.FrameOf(person::kNeckTwist) *
               Pose{model.anthropometry().eyes, Quaternion::Identity()};
  for (int hand = 0; hand < kHands; ++hand)
    truth.elbows[static_cast<std::size_t>(hand)] =
        setup.stance.X_WS *
        at.p[static_cast<std::size_t>(person::Of(hand, person::ArmJoint::kElbowFlexion))];
  return truth;
}

// Returns the track of a point that does not move, sampled at 100 Hz. The times of the samples are
// from a clock that is ahead by `shift` [s].
tracks::PartTrack Resting(const Vector3& p, double shift = 0) {
  tracks::PartTrack part;
  for (double t = -0.5; t < kDuration + 0.5; t += 0.01) {
    part.times.push_back(t + shift);
    part.p.push_back(p);
  }
  return part;
}

tracks::BodyTrack TrackOf(const Truth& truth, bool head, bool elbows) {
  tracks::BodyTrack track;
  track.source = "body.csv";
  if (head) {
    track.head = Resting(truth.head.p);
    track.head->q.assign(track.head->p.size(), truth.head.q);
  }
  if (elbows)
    for (std::size_t h = 0; h < kHands; ++h) track.elbows[h] = Resting(truth.elbows[h]);
  return track;
}

Assessment JudgeWith(const std::vector<tracks::BodyTrack>& tracks, bool intervals = false) {
  AssessOptions options;
  options.intervals = intervals;
  options.tracks = tracks;
  return Assess(PersonScenario(), 9, RunOf(MadeRun()), options);
}

double WidthOf(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q.mean_interval->high - q.mean_interval->low;
  throw std::out_of_range(path);
}

// Measurements of the body replace assumptions about it.
TEST(MeasuredBody, NarrowsTheIntervals) {
  const Truth truth = TruthOf(MadeRun());
  const Assessment hands = JudgeWith({}, true);
  const Assessment head = JudgeWith({TrackOf(truth, true, false)}, true);
  const Assessment elbows = JudgeWith({TrackOf(truth, false, true)}, true);
  EXPECT_LT(WidthOf(head, "trunk.flexion_rad"), 0.8 * WidthOf(hands, "trunk.flexion_rad"));
  EXPECT_LT(WidthOf(head, "strength.left_shoulder"),
            0.8 * WidthOf(hands, "strength.left_shoulder"));
  EXPECT_LT(WidthOf(elbows, "arms.left.abduction_rad"), WidthOf(hands, "arms.left.abduction_rad"));
  ASSERT_EQ(head.measured.parts.size(), 2u);
  EXPECT_EQ(head.measured.parts[0].share, 1);
  // The measurement is the nominal posture itself.
  EXPECT_LT(*head.measured.parts[0].misfit, 0.005);
}

// Two rows that are far apart measure nothing between them.
TEST(MeasuredBody, WarnsAboutAMeasurementThatIsAlmostNeverThere) {
  const auto warns = [](const Assessment& a) {
    return std::ranges::any_of(a.warnings, [](const std::string& warning) {
      return warning.find("is measured for only") != std::string::npos;
    });
  };
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack rare = TrackOf(truth, true, false);
  EXPECT_FALSE(warns(JudgeWith({rare})));
  rare.head->times = {-0.4, kDuration + 0.4};
  rare.head->p.resize(2);
  rare.head->q.resize(2);
  EXPECT_TRUE(warns(JudgeWith({rare})));
}

// Without a measured rotation, the model bends the neck comfortably.
TEST(MeasuredBody, UsesAPositionWithoutRotation) {
  Truth truth = TruthOf(MadeRun());
  truth.head.q = truth.head.q * RotationFromVector({0, 0.6, 0});  // looks down
  tracks::BodyTrack turned = TrackOf(truth, true, false), position = turned;
  position.head->q.clear();
  const auto neck = [](const Assessment& a) {
    for (const QuantityResult& q : a.quantities)
      if (std::string(q.kind->path) == "neck.flexion_rad") return q.mean;
    return std::nan("");
  };
  EXPECT_GT(neck(JudgeWith({turned})), neck(JudgeWith({position})) + 0.3);
  EXPECT_NEAR(neck(JudgeWith({position})), neck(JudgeWith({})), 0.1);
}

TEST(MeasuredBody, StatesHowLongItWasMeasured) {
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack track = TrackOf(truth, true, true);
  for (std::size_t i = 0; i < track.head->times.size(); ++i)
    if (track.head->times[i] > 1.5) track.head->p[i].setConstant(NAN);
  for (Quaternion& q : track.head->q) q.coeffs().setConstant(NAN);
  const Assessment a = JudgeWith({track});
  EXPECT_NEAR(a.measured.parts[0].share, 0.75, 0.02);
  EXPECT_EQ(a.measured.parts[1].share, 0);
  const std::string text = AssessmentText(a);
  for (const char* words : {" % of the time), the head rotation (0 % of the time)",
                            "left elbow: measured for 100.0 %", "body.csv"})
    EXPECT_NE(text.find(words), std::string::npos) << words << text;
  EXPECT_NE(AssessmentPage(a, "1").find("measured for 100.0 %"), std::string::npos);
}

TEST(MeasuredBody, IsShiftedByTheOffsetOfItsClock) {
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack track;
  track.source = "body.csv";
  track.head = Resting(truth.head.p, 1'700'000'000);
  track.clock = tracks::TrackClock::kUnix;
  AssessOptions options;
  options.intervals = false;
  options.tracks = {track};
  options.start_unix = 1'700'000'000;
  EXPECT_EQ(Assess(PersonScenario(), 9, RunOf(MadeRun()), options).measured.parts[0].share, 1);
  options.start_unix = 0;
  EXPECT_THROW(Assess(PersonScenario(), 9, RunOf(MadeRun()), options), InputError);
}

std::string Refusal(const std::vector<tracks::BodyTrack>& tracks) {
  try {
    JudgeWith(tracks);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MeasuredBody, RefusesImpossibleBodies) {
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack track = TrackOf(truth, true, false);
  for (Vector3& p : track.head->p) p *= 1000;  // millimetres
  EXPECT_NE(Refusal({track}).find("impossible for a person of 1.75 m"), std::string::npos);
  EXPECT_NE(Refusal({track}).find("unit"), std::string::npos);
  tracks::BodyTrack twice = TrackOf(truth, true, false);
  EXPECT_NE(Refusal({twice, twice}).find("also measured in"), std::string::npos);
  // The elbows in this test were measured at another place and are too far from the handles.
  tracks::BodyTrack far = TrackOf(truth, false, true);
  for (Vector3& p : far.elbows[1]->p) p += Vector3(0.8, 0.8, 0.3);
  EXPECT_NE(Refusal({far}).find("farther than a forearm"), std::string::npos) << Refusal({far});
}

TEST(MeasuredBody, LeavesOutSingleImpossiblePositions) {
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack track = TrackOf(truth, true, false);
  for (std::size_t i = 0; i < track.head->p.size(); i += 10) track.head->p[i].z() += 5;
  const Assessment a = JudgeWith({track});
  ASSERT_FALSE(a.warnings.empty());
  EXPECT_NE(a.warnings[0].find("are impossible and are left out"), std::string::npos);
  EXPECT_LT(a.measured.parts[0].share, 1);
  EXPECT_GT(a.measured.parts[0].share, 0.5);
}

TEST(MeasuredBody, WarnsIfTheBodyCannotFollow) {
  Truth truth = TruthOf(MadeRun());
  truth.head.p.z() += 0.25;  // of a taller person
  const Assessment a = JudgeWith({TrackOf(truth, true, false)});
  ASSERT_FALSE(a.warnings.empty());
  EXPECT_NE(a.warnings.back().find("away from the measured head"), std::string::npos);
}

TEST(MeasuredBody, CarriesSignalsToTheOutputs) {
  tracks::BodyTrack track;
  track.source = "pulse.csv";
  track.signals = {{"pulse", "1/min", {0, 1}, {60, 70}}};
  const Assessment a = JudgeWith({track});
  ASSERT_EQ(a.measured.signals.size(), 1u);
  EXPECT_NEAR(a.measured.signals[0].share, 0.5, 0.01);
  const std::string csv = AssessmentCsv(a);
  EXPECT_EQ(csv.substr(0, csv.find('\n')).substr(csv.find("measured.pulse")),
            "measured.pulse [1/min]");
  const auto json = nlohmann::json::parse(AssessmentJson(a));
  EXPECT_EQ(json["measured"]["signals"][0]["name"], "pulse");
}

// A marker on the hand relates the two clocks.
TEST(MeasuredBody, FindsAnUnknownClockByTheHand) {
  const auto at = [](double t) {
    return Vector3(0, 0.05 * std::sin(1.3 * t) + 0.03 * std::sin(4.1 * t + 1),
                   0.06 * std::sin(2.2 * t * (1 + 0.02 * t)));
  };
  const SampleCollector run = Collect(PersonScenario(), 20, [&](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1.0, 5);
    for (HandRecord& hand : record.hands) {
      Pose X = FromRecord(hand.real.pose);
      X.p += at(1e-3 * static_cast<double>(tick));
      hand.real.pose = ToRecord(X);
    }
    return record;
  });
  tracks::BodyTrack track;
  track.source = "markers.csv";
  track.clock = tracks::TrackClock::kAuto;
  track.hands[0].emplace();
  for (double t = 0; t < 20; t += 0.01) {
    track.hands[0]->pose.times.push_back(t + 3.21);
    track.hands[0]->pose.p.emplace_back(Vector3(7, 7, 7) + at(t));
  }
  AssessOptions options;
  options.intervals = false;
  options.tracks = {track};
  const Assessment a = Assess(PersonScenario(), 9, RunOf(run), options);
  ASSERT_TRUE(a.measured.tracks[0].estimate);
  // The first tick of a recording is at 0, and a sample's time is the middle of its 10 ticks.
  EXPECT_NEAR(a.measured.tracks[0].offset, -3.21, 0.005);
}

// The user did not choose the head in the recording, so the evaluation must continue without it.
TEST(MeasuredBody, LeavesOutAnUnusableHeadOfTheRun) {
  const Truth truth = TruthOf(MadeRun());
  const Assessment hands = JudgeWith({});
  tracks::BodyTrack recorded = TrackOf(truth, true, false);
  recorded.of_the_run = true;
  const Assessment used = JudgeWith({recorded});
  EXPECT_EQ(used.measured.parts.size(), 2u);

  const auto refused = [&](const tracks::BodyTrack& track, const char* why) {
    const Assessment a = JudgeWith({track});
    EXPECT_TRUE(a.measured.parts.empty());
    EXPECT_TRUE(std::ranges::any_of(a.warnings, [why](const std::string& warning) {
      return warning.find("is not used") != std::string::npos &&
             warning.find(why) != std::string::npos;
    })) << why;
    EXPECT_EQ(a.quantities.front().mean, hands.quantities.front().mean);
  };
  tracks::BodyTrack high = recorded, late = recorded;
  for (Vector3& p : high.head->p) p.z() += 5;
  refused(high, "impossible");
  for (double& t : late.head->times) t += 100;
  refused(late, "The file covers");
}

// A file that the user gives is preferred.
TEST(MeasuredBody, PrefersAGivenHeadToThatOfTheRun) {
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack recorded = TrackOf(truth, true, false);
  recorded.source = "the headset";
  recorded.of_the_run = true;
  const Assessment a = JudgeWith({TrackOf(truth, true, false), recorded});
  ASSERT_EQ(a.measured.parts.size(), 2u);
  EXPECT_EQ(a.measured.parts[0].source, "body.csv");
}

// The headset and a stream both measure the head, and only the stream measures the elbows.
TEST(MeasuredBody, UsesTheRestOfATrackOfTheRun) {
  const Truth truth = TruthOf(MadeRun());
  tracks::BodyTrack headset = TrackOf(truth, true, false), stream = TrackOf(truth, true, true);
  headset.source = "the headset";
  stream.source = "stream trackers";
  headset.of_the_run = stream.of_the_run = true;
  const Assessment a = JudgeWith({headset, stream});
  std::vector<std::string> parts;
  for (const MeasuredPart& part : a.measured.parts)
    parts.push_back(part.what + " by " + part.source);
  EXPECT_EQ(parts, (std::vector<std::string>{"head by the headset", "head rotation by the headset",
                                             "left elbow by stream trackers",
                                             "right elbow by stream trackers"}));
  EXPECT_TRUE(std::ranges::any_of(a.warnings, [](const std::string& warning) {
    return warning.find("The head of stream trackers in the recording is not used") !=
           std::string::npos;
  }));
}

}  // namespace
}  // namespace predictor::assessment
