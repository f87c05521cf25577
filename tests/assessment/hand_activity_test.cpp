#include "assessment/hand_activity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/samples.h"
#include "assessment/user_limits.h"
#include "core/error.h"
#include "ergonomics/hand_activity.h"
#include "evaluation/statistics_samples.h"

namespace predictor::assessment {
namespace {

// The force of both hands [N] is a function of time.
Assessment JudgeForce(double duration, const std::function<double(double)>& force,
                      std::optional<double> effort = {}) {
  const SampleCollector run = Collect(PersonScenario(), duration, [&](std::uint64_t tick) {
    return RecordOf(tick, 1.0, force(1e-3 * static_cast<double>(tick)));
  });
  AssessOptions options{.intervals = false};
  options.work.grip_effort = effort;
  return Assess(PersonScenario(), 9, run, options);
}

// 20 N for the first second of each period of 2.5 s.
double Periodic(double t) { return std::fmod(t, 2.5) < 1 ? 20 : 1; }

TEST(HandActivity, FollowsFromFrequencyAndDutyOfTheForce) {
  const Assessment a = JudgeForce(10, Periodic, 4);
  ASSERT_EQ(a.hand_activity.size(), 2U);
  for (const HandActivity& hand : a.hand_activity) {
    EXPECT_EQ(hand.exertions, 4U);
    EXPECT_NEAR(hand.frequency, 0.4, 1e-3);
    EXPECT_NEAR(hand.duty, 0.4, 0.005);
    EXPECT_NEAR(hand.peak_force, 20, 1e-9);
    EXPECT_NEAR(hand.level, ergonomics::HandActivityLevel(0.4, 0.4), 0.02);
    EXPECT_TRUE(hand.studied);
    EXPECT_EQ(hand.normalized_force, 4);
    EXPECT_NEAR(hand.ratio, 4 / (10 - hand.level), 1e-12);
  }
}

TEST(HandActivity, AShortPauseAndNoiseDoNotEndAnExertion) {
  const auto exertions = [](const std::function<double(double)>& force) {
    return JudgeForce(6, force).hand_activity[0].exertions;
  };
  const auto with_pause = [](double pause) {
    return [=](double t) { return t > 2 && t < 2 + pause ? 0.0 : 20.0; };
  };
  EXPECT_EQ(exertions(with_pause(0.3)), 1U);
  EXPECT_EQ(exertions(with_pause(0.8)), 2U);
  EXPECT_EQ(exertions([](double t) { return 5 + std::sin(40 * t); }), 1U);
  EXPECT_EQ(exertions([](double) { return 4.0; }), 0U);
  EXPECT_EQ(JudgeForce(6, [](double) { return 4.0; }).hand_activity[0].ratio, 0);
}

TEST(HandActivity, WithoutAStatedGripTheRatioIsALowerBound) {
  const Assessment a = JudgeForce(10, Periodic);
  const HandActivity& left = a.hand_activity[0];
  std::vector<double> uses;
  const auto values = [&](const std::string& path) {
    return std::ranges::find(a.quantities, path,
                             [](const QuantityResult& q) { return std::string(q.kind->path); })
        ->values;
  };
  const auto elbow = values("strength.left_elbow"), shoulder = values("strength.left_shoulder");
  ASSERT_EQ(left.exerts.size(), a.times.size());
  for (std::size_t i = 0; i < a.times.size(); ++i)
    if (left.exerts[i]) uses.push_back(std::max(elbow[i], shoulder[i]));
  EXPECT_FALSE(left.stated);
  EXPECT_NEAR(left.normalized_force, 10 * Quantile(uses, 0.9), 1e-9);
  EXPECT_GT(left.normalized_force, 0);
  EXPECT_NE(AssessmentText(a).find("so the ratio is at least"), std::string::npos);
  EXPECT_TRUE(std::ranges::any_of(a.not_evaluable, [](const NotEvaluable& gap) {
    return gap.what.find("hand activity") != std::string::npos;
  }));
}

TEST(HandActivity, IsInEveryOutput) {
  const Assessment a = JudgeForce(10, Periodic, 4);
  for (const std::string& text : {AssessmentText(a), AssessmentPage(a, "1")}) {
    EXPECT_NE(text.find("Hand activity, ACGIH (standard)"), std::string::npos);
    EXPECT_NE(text.find("left hand: 4 exertions above 5 N"), std::string::npos);
  }
  const auto json = nlohmann::json::parse(AssessmentJson(a));
  ASSERT_EQ(json["hand_activity"].size(), 2U);
  EXPECT_EQ(json["hand_activity"][1]["hand"], "right");
  EXPECT_EQ(json["hand_activity"][1]["exertions"], 4);
  EXPECT_EQ(json["hand_activity"][1]["normalized_peak_force_origin"], "stated");
  const std::string csv = AssessmentCsv(a);
  EXPECT_NE(csv.find(",hands.left.exerts,hands.left.activity_level,hands.left.activity_ratio,"),
            std::string::npos);
}

TEST(HandActivity, IsComparedWithTheLimitsOfAFile) {
  const std::string head = "edition,my edition\nquantity,limit,unit,allowed_s,clause\n";
  const auto verdict = [&](Assessment a, const std::string& limit) {
    JudgeUserLimits(
        ParseUserLimits(head + "hands.left.activity_ratio," + limit + ",,0,action\n", "l.csv"), &a);
    EXPECT_EQ(a.limits.size(), 1U);
    EXPECT_NE(Sentence(a.limits.at(0)).find("my edition"), std::string::npos);
    return a.limits.at(0).verdict;
  };
  EXPECT_EQ(verdict(JudgeForce(10, Periodic, 4), "0.56"), Verdict::kExceeded);  // 4 / (10 - 3.3)
  EXPECT_EQ(verdict(JudgeForce(10, Periodic, 4), "0.78"), Verdict::kKept);
  EXPECT_EQ(verdict(JudgeForce(10, Periodic), "0.78"), Verdict::kUncertain);  // a lower bound
  EXPECT_THROW(ParseUserLimits(head + "hands.left.activity_ratio,0.5,,3,\n", "l.csv"), InputError);
}

// The numbers of the shipped file are those of the worksheet of 2002.
TEST(HandActivity, ShippedLimitsAreThoseOfTheWorksheet) {
  const UserLimits limits =
      ReadUserLimits(std::string(PREDICTOR_SOURCE_DIR) + "/assets/hand_activity_limits.csv");
  EXPECT_NE(limits.edition.find("2001"), std::string::npos);
  ASSERT_EQ(limits.rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(limits.rows[i].kind->hand, static_cast<int>(i / 2));
    EXPECT_EQ(limits.rows[i].value, i % 2 == 0 ? 0.56 : 0.78);
  }
}

}  // namespace
}  // namespace predictor::assessment
