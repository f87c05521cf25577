// Tests the continuation of a stopped run, and that it does not use data that must stay hidden.
#include "analysis/continuation/continuation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/norm.h"
#include "stopped_people.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

using Json = nlohmann::json;

constexpr const char* kPush =
    "operator.script=[{action: grip, start: 0, duration: 0.5}, {action: push, start: 2, duration: "
    "0.6, force: [55, 0, 0], rise_time: 0.12}";

StoppedPerson Pusher(const std::string& more = "") {
  StoppedPerson person;
  person.what = "push";
  person.scenario = Load("box_9kg.yaml", {kPush + more + "]", "duration=4"});
  return person;
}

ContinueOptions Few(int draws, const StoppedPerson& person) {
  ContinueOptions options;
  options.draws = draws;
  options.horizon = 0.5;
  options.reference = true;
  options.joint_loads = false;
  options.recorded_operator = person.Maker();
  return options;
}

double LargestForce(const TickRecord& record) {
  double force = 0;
  for (const HandRecord& hand : record.hands)
    if (hand.present != 0) force = std::max(force, Norm(hand.wrench.data()));
  return force;
}

// If no limit acts from the start, the continuation repeats the simulated operator's run.
TEST(Continuation, OfTheSimulatedOperatorIsTheRunWithoutLimits) {
  StoppedPerson person;  // moves slowly, so that the speed cap does not act before the stop
  person.scenario =
      Load("box_9kg.yaml", {"events=[{event: brakes_close, trigger: {after: 3}}]", "duration=8"});
  const auto stopped = RunToStop(person);
  ASSERT_TRUE(stopped);
  const Continuation c = Continue(*stopped, ArmDistribution::Prior(HandSpec()), Few(1, person));
  Scenario free = person.scenario;
  SafetySpec& s = free.safety;
  s.force = s.torque = s.coupling = s.coupling_torque = s.tracking = s.tracking_rotation = 1e6;
  s.relative_slack = s.relative_slack_rotation = s.handle_speed = s.handle_rotation_speed = 1e6;
  const std::unique_ptr<Emulator> emulator = EmulatorOf(person, free);
  std::vector<double> forces;
  Simulate(emulator.get(), 8, [&](const TickRecord& record) {
    if (record.tick >= stopped->stop().tick && forces.size() < 500)
      forces.push_back(LargestForce(record));
  });
  ASSERT_EQ(forces.size(), 500U);
  EXPECT_EQ(c.reference->peak_force, *std::ranges::max_element(forces));
  for (std::size_t i = 0; i < 50; ++i)
    EXPECT_EQ(c.reference->force[i],
              *std::max_element(forces.begin() + static_cast<long>(10 * i),
                                forces.begin() + static_cast<long>(10 * i + 10)))
        << i;
  EXPECT_GT(c.reference->peak_force, 31);
}

// Two operators act alike until the stop and differently after it. The predictions for the two
// operators must be identical bit for bit.
TEST(Continuation, DoesNotUseTheOperatorsHiddenIntention) {
  const StoppedPerson one = Pusher();
  const auto stop = RunToStop(one);
  ASSERT_TRUE(stop);
  const StoppedPerson other = Pusher(Formatted(
      ", {action: push, start: %.3f, duration: 0.5, force: [-90, 40, 0], rise_time: 0.06}",
      stop->stop().run_time + 0.02));
  const auto again = RunToStop(other);
  ASSERT_TRUE(again);
  ASSERT_EQ(again->stop().tick, stop->stop().tick);
  const ArmDistribution arms = ArmDistribution::Prior(HandSpec());
  const Continuation a = Continue(*stop, arms, Few(4, one));
  const Continuation b = Continue(*again, arms, Few(4, other));
  EXPECT_NE(a.reference->force, b.reference->force);
  for (std::size_t k = 0; k < a.runs.size(); ++k) EXPECT_EQ(a.runs[k].force, b.runs[k].force) << k;
}

TEST(Continuation, IsTheSameOnAnyNumberOfThreads) {
  const StoppedPerson person = Pusher();
  const auto stop = RunToStop(person);
  ASSERT_TRUE(stop);
  ContinueOptions options = Few(6, person);
  const ArmDistribution arms = ArmDistribution::Prior(HandSpec());
  options.workers = 1;
  const Continuation one = Continue(*stop, arms, options);
  options.workers = 3;
  const Continuation three = Continue(*stop, arms, options);
  for (std::size_t k = 0; k < one.runs.size(); ++k)
    EXPECT_EQ(one.runs[k].force, three.runs[k].force);
}

TEST(Continuation, JudgesTheJointsOfABody) {
  const StoppedPerson person = Pusher();
  const auto stop = RunToStop(person);
  ASSERT_TRUE(stop);
  ContinueOptions options = Few(3, person);
  options.joint_loads = true;
  const Continuation c = Continue(*stop, ArmDistribution::Prior(HandSpec()), options);
  EXPECT_EQ(c.no_joint_use, "");
  for (const ContinuedRun& run : c.runs) {
    EXPECT_GT(run.joint_use, 0.01);
    EXPECT_LT(run.joint_use, 3);
  }
  StoppedRun without = *stop;
  without.scenario.operator_.stance.reset();
  const Continuation unknown = Continue(without, ArmDistribution::Prior(HandSpec()), options);
  EXPECT_NE(unknown.no_joint_use, "");
  EXPECT_TRUE(std::isnan(unknown.runs.front().joint_use));
}

// Checks that each required key exists and that each key is described.
void ExpectMatches(const Json& value, const Json& schema) {
  for (const Json& key : schema.value("required", Json::array()))
    EXPECT_TRUE(value.contains(key.get<std::string>())) << key;
  if (value.is_object() && schema.contains("properties"))
    for (const auto& [key, inner] : value.items()) {
      ASSERT_TRUE(schema["properties"].contains(key)) << key;
      ExpectMatches(inner, schema["properties"][key]);
    }
  if (value.is_array() && schema.contains("items"))
    for (const Json& entry : value) ExpectMatches(entry, schema["items"]);
}

// If another fault ends a continued run, the largest force of this run is a lower bound.
TEST(Continuation, CountsRunsThatEndedByAFaultAsBounds) {
  Continuation c;
  for (int k = 1; k <= 19; ++k) {
    ContinuedRun& run = c.runs.emplace_back();
    run.peak_force = 30 + k;
    run.ending = k > 10 ? Ending::kFault : Ending::kSettles;
  }
  const Interval90 range = c.IntervalOf(&ContinuedRun::peak_force);
  EXPECT_EQ(range.low.value, 31);  // the first of 19, since 0.05 (19 + 1) = 1
  EXPECT_FALSE(range.low.at_least);
  EXPECT_EQ(range.median.value, 40);
  EXPECT_TRUE(range.high.at_least);
  EXPECT_EQ(c.CountOf(Ending::kFault), 9);
}

TEST(Continuation, ConformsToItsSchema) {
  const StoppedPerson person = Pusher();
  const auto stop = RunToStop(person);
  ASSERT_TRUE(stop);
  const Continuation c = Continue(*stop, ArmDistribution::Prior(HandSpec()), Few(3, person));
  const Json json = Json::parse(ContinuationJson(c, "a.mcap"));
  const Json schema = Json::parse(ContinuationSchema());
  ExpectMatches(json, schema);
  EXPECT_EQ(json["draws"].size(), 3U);
  const std::string text = ContinuationText(c);
  EXPECT_NE(text.find("at least 30"), std::string::npos) << text;
  EXPECT_NE(ContinuationPage(c, "a.mcap", "1").find("Without the stop"), std::string::npos);
}

// ---- the run up to its stop --------------------------------------------------------------------

TEST(StopFinder, FindsOnlyStopsByALimit) {
  StopFinder finder(1000);
  TickRecord record{};
  record.ran = 1;
  record.tick = 1;
  EXPECT_FALSE(finder.Add(record));
  record.cause = StopCause::kOperator;
  EXPECT_FALSE(finder.Add(record));
  EXPECT_EQ(finder.other(), StopCause::kOperator);
  record.cause = StopCause::kNone;
  for (int i = 0; i < 2000; ++i) finder.Add(record);
  record.cause = StopCause::kForce;
  EXPECT_TRUE(finder.Add(record));
  EXPECT_EQ(finder.past().size(), 500U);
  EXPECT_EQ(finder.past().back().cause, StopCause::kForce);
}

TEST(StoppedRun, OfRealArmsOrInDirectModeIsRefused) {
  Scenario direct = Load("box_9kg.yaml", {"mode=direct"});
  EXPECT_THROW(CheckContinuable(direct), InputError);
  Scenario real = Load("box_9kg.yaml");
  real.device.type = "real";
  EXPECT_THROW(CheckContinuable(real), InputError);
  EXPECT_NO_THROW(CheckContinuable(Load("box_9kg.yaml")));
}

// ---- the possible operators --------------------------------------------------------------------

TEST(ArmDistribution, DrawsHaveTheGivenMoments) {
  ArmDistribution::Vector mean;
  mean << 400, 180, 150, 0.3, 1.6, 0.4, 0.06;
  ArmDistribution::Matrix c = ArmDistribution::Matrix::Zero();
  c.diagonal() << 6400, 900, 900, 0.004, 0.06, 0.01, 0.0001;
  c(0, 1) = c(1, 0) = 1500;  // 400 N/m and 180 N/m grow together
  c(0, 5) = c(5, 0) = -4;
  const auto arms = ArmDistribution::FromMoments(mean, c, HandSpec(), "test");
  RandomStream random(3, "arms");
  constexpr int kSamples = 40000;
  ArmDistribution::Vector sum = ArmDistribution::Vector::Zero();
  double product = 0, with_gain = 0;
  for (int i = 0; i < kSamples; ++i) {
    const ArmImpedance arm = arms.Draw(&random);
    ArmDistribution::Vector x;
    x << arm.stiffness, arm.damping_ratio, arm.mass, arm.reflex_gain, arm.reflex_delay;
    sum += x / kSamples;
    product += (x[0] - 400) * (x[1] - 180) / kSamples;
    with_gain += (x[0] - 400) * (x[5] - 0.4) / kSamples;
  }
  // The tolerance of the means is five standard errors, and the tolerance of the covariances is 10
  // %.
  EXPECT_TRUE(
      ((sum - mean).cwiseAbs().array() < 5 * (c.diagonal() / kSamples).cwiseSqrt().array()).all())
      << sum.transpose();
  EXPECT_NEAR(product, 1500, 150);
  EXPECT_NEAR(with_gain, -4, 0.4);
  EXPECT_LT(arms.Percentile(0, 0.05), arms.Percentile(0, 0.5));
}

TEST(ArmDistribution, PriorIsAroundTheHand) {
  HandSpec hand;
  const auto arms = ArmDistribution::Prior(hand);
  RandomStream random(1, "arms");
  std::vector<double> stiffness;
  for (int i = 0; i < 4001; ++i) stiffness.push_back(arms.Draw(&random).stiffness[0]);
  EXPECT_NEAR(Median(stiffness), hand.stiffness[0], 15);
  // The documented standard deviation is the square root of 0.35² + 0.2².
  EXPECT_NEAR(std::log(Quantile(stiffness, 0.95) / hand.stiffness[0]), 1.645 * 0.4031, 0.05);
}

TEST(ArmDistribution, RefusesInvalidFiles) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() / "arm.json";
  const auto refuses = [&](const std::string& text, const std::string& why) {
    std::ofstream(file) << text;
    try {
      ArmDistribution::Read(file, HandSpec());
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  const std::string head = R"({"predictor_arm": 1, "source": "x", )";
  refuses("no json", "JSON");
  refuses(R"({"predictor_arm": 2})", "version");
  refuses(head + R"("parameters": ["strength"], "mean": [1], "covariance": [[1]]})", "strength");
  refuses(head + R"("parameters": ["mass"], "mean": [-1], "covariance": [[1]]})", "positive");
  refuses(head + R"("parameters": ["mass"], "mean": [1], "covariance": [[-1]]})", "covariance");
  refuses(head + R"("parameters": ["mass"], "mean": [1, 2], "covariance": [[1]]})", "length");
  refuses(head + R"("parameters": ["mass"], "mean": ["a"], "covariance": [[1]]})", "read");
  EXPECT_THROW(ArmDistribution::Read(folder.path() / "none.json", HandSpec()), InputError);
  std::ofstream(file) << head + R"("parameters": ["mass"], "mean": [3], "covariance": [[1e-6]]})";
  RandomStream random(1, "arms");
  EXPECT_NEAR(ArmDistribution::Read(file, HandSpec()).Draw(&random).mass, 3, 0.01);
}

// The test simulates a hand that follows the assumed law with a known drive. The estimate must find
// this drive and its trend.
TEST(EstimatedHand, FindsTheDriveOfAHandThatFollowsItsLaw) {
  constexpr double kStep = 0.001, kAmplitude = 0.02, kRate = 12;
  OperatorDraw person;
  person.arm = {{300, 150, 100}, 0.3, 1.2, 0.5, 0.05, 4, 0.1};
  person.trend_time = 0.1;
  person.change = 1;
  person.end = HUGE_VAL;
  person.sight_delay = 0.2;
  const Vector3 K = person.arm.stiffness, D = person.arm.Damping();
  const Vector3 axis(1, 0.5, -0.5), u0(5, -3, 20), slope(40, 0, -15);
  const auto at = [&](double t) { return Vector3(kAmplitude * std::sin(kRate * t) * axis); };
  const auto speed = [&](double t) {
    return Vector3(kAmplitude * kRate * std::cos(kRate * t) * axis);
  };
  std::vector<TickRecord> past(501);
  for (std::size_t i = 0; i < past.size(); ++i) {
    const double t = kStep * (static_cast<double>(i) - 500), late = t - person.arm.reflex_delay;
    const auto z = [&](double s) {
      return Vector3(K.cwiseProduct(at(s)) + D.cwiseProduct(speed(s)));
    };
    const Vector3 a = -kRate * kRate * at(t);
    Eigen::Map<Vector3>(past[i].hands[0].wrench.data()) =
        u0 + slope * t - z(t) - person.arm.reflex_gain * z(late) - person.arm.mass * a;
    past[i].hands[0].present = past[i].hands[0].gripping = 1;
    past[i].hands[0].real = {ToRecord(Pose{at(t), Quaternion::Identity()}), {}};
    Eigen::Map<Vector3>(past[i].hands[0].real.twist.data()) = speed(t);
  }
  EstimatedHand hand;
  hand.Begin(past, 0, kStep, kStep, {}, person);
  ASSERT_TRUE(hand.holds());
  // Displacement and force are measured relative to their values in the first record.
  const Vector3 offset = (1 + person.arm.reflex_gain) * K.cwiseProduct(at(-0.5));
  EXPECT_LT((hand.drive().head<3>() + offset - u0).norm(), 0.6) << hand.drive().transpose();
  EXPECT_LT((hand.trend().head<3>() - slope).norm(), 8) << hand.trend().transpose();
  EstimatedHand absent;
  absent.Begin(past, 1, kStep, kStep, {}, person);
  EXPECT_FALSE(absent.holds());
}

}  // namespace
}  // namespace predictor
