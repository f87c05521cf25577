#include "assessment/user_limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/samples.h"
#include "core/error.h"

namespace predictor::assessment {
namespace {

const std::string kHead = "edition,my standard\nquantity,limit,unit,allowed_s,clause\n";

using Force = std::function<double(double time)>;

Assessment Judge(const Force& force, bool intervals = false) {
  const Scenario scenario = PersonScenario();
  const SampleCollector run = Collect(scenario, 1, [&](std::uint64_t tick) {
    return RecordOf(tick, 1.0, force(1e-3 * static_cast<double>(tick)));
  });
  return Assess(scenario, 9, RunOf(run), {.intervals = intervals});
}
Assessment Steady(double force, bool intervals = false) {
  return Judge([&](double) { return force; }, intervals);
}

LimitResult Compare(Assessment a, const std::string& row) {
  JudgeUserLimits(ParseUserLimits(kHead + row + "\n", "limits.csv"), &a);
  EXPECT_EQ(a.limits.size(), 1u);
  return a.limits.at(0);
}

TEST(UserLimits, AreReadInSiUnits) {
  const UserLimits limits = ParseUserLimits(
      "# comment\n" + kHead + "trunk.flexion_rad,60,deg,4,5.3\nbalance.margin_m, 2 ,cm,0,\n" +
          "trunk.side_bend_rad,0.5,rad,0,\nstrength.left_elbow,50,%,0,\n",
      "limits.csv");
  EXPECT_EQ(limits.edition, "my standard");
  ASSERT_EQ(limits.rows.size(), 4u);
  EXPECT_STREQ(limits.rows[0].kind->path, "trunk.flexion_rad");
  EXPECT_NEAR(limits.rows[0].value, 60 * std::numbers::pi / 180, 1e-12);
  EXPECT_EQ(limits.rows[0].allowed, 4);
  EXPECT_EQ(limits.rows[0].clause, "5.3");
  EXPECT_NEAR(limits.rows[1].value, 0.02, 1e-12);
  EXPECT_EQ(limits.rows[2].value, 0.5);
  EXPECT_EQ(limits.rows[3].value, 0.5);
}

void ExpectError(const std::string& row, const std::string& words) {
  try {
    ParseUserLimits(kHead + row + "\n", "limits.csv");
    ADD_FAILURE() << "no error: " << row;
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("limits.csv:3"), std::string::npos) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
}

TEST(UserLimits, RefuseWhatCannotBeCompared) {
  ExpectError("trunk.flexon_rad,60,deg,0,", "Did you mean trunk.flexion_rad?");
  ExpectError("trunk.flexion_rad,60,N,0,", "is in rad or °");
  ExpectError("trunk.flexion_rad,60 deg,deg,0,", "without a unit");
  ExpectError("trunk.flexion_rad,nan,deg,0,", "limit is \"nan\"");
  ExpectError("trunk.flexion_rad,60,deg,-1,", "allowed_s is \"-1\"");
  ExpectError("trunk.flexion_rad,60,deg,0", "5 columns");
  EXPECT_THROW(ReadUserLimits("/nowhere/limits.csv"), InputError);
}

TEST(UserLimits, OfAMeasuredForceDependOnItsValueAndTime) {
  const Assessment a = Steady(20);
  const LimitResult over = Compare(a, "hands.left.force_n,15,N,0,");
  EXPECT_EQ(over.verdict, Verdict::kExceeded);
  EXPECT_NEAR(over.worst, 20, 1e-9);
  EXPECT_NEAR(over.share, 1, 1e-9);
  EXPECT_NEAR(over.longest, a.held, 0.011);
  EXPECT_FALSE(over.surely);
  EXPECT_EQ(Compare(a, "hands.left.force_n,25,N,0,").verdict, Verdict::kKept);
  EXPECT_EQ(Compare(a, "hands.left.force_n,15,N,2,").verdict, Verdict::kKept);
}

// The force is high from 0 to 0.4 s and from 0.7 to 1 s.
TEST(UserLimits, CountTheLongestUninterruptedTime) {
  const Assessment a = Judge([](double t) { return t <= 0.4 || t > 0.7 ? 20.0 : 10.0; });
  const LimitResult r = Compare(a, "hands.left.force_n,15,N,0.5,");
  EXPECT_NEAR(r.longest, 0.4, 0.011);
  EXPECT_NEAR(r.share, 0.7, 0.02);
  EXPECT_EQ(r.verdict, Verdict::kKept);
  EXPECT_EQ(Compare(a, "hands.left.force_n,15,N,0.35,").verdict, Verdict::kExceeded);
}

// A limit inside the interval can be neither kept nor exceeded for certain.
TEST(UserLimits, OfAModelledValueDependOnItsInterval) {
  const Assessment a = Steady(30, true);
  const auto q = std::ranges::find_if(a.quantities, [](const QuantityResult& x) {
    return std::string(x.kind->path) == "lower_back.compression_n";
  });
  ASSERT_NE(q, a.quantities.end());
  const double low = std::ranges::min(q->low), high = std::ranges::max(q->high);
  ASSERT_LT(low, high);
  const auto at = [&](double limit) {
    return Compare(a, "lower_back.compression_n," + std::to_string(limit) + ",N,0,");
  };
  const LimitResult inside = at((low + high) / 2);
  EXPECT_EQ(inside.verdict, Verdict::kUncertain);
  EXPECT_EQ(*inside.surely, 0);
  EXPECT_GT(*inside.possibly, 0.5);
  EXPECT_EQ(at(low - 1).verdict, Verdict::kExceeded);
  EXPECT_EQ(at(high + 1).verdict, Verdict::kKept);
}

// Low values of the balance margin are bad.
TEST(UserLimits, OfTheBalanceAreLowerLimits) {
  const Assessment a = Steady(20);
  EXPECT_EQ(Compare(a, "balance.margin_m,-1,m,0,").verdict, Verdict::kKept);
  const LimitResult strict = Compare(a, "balance.margin_m,1,m,0,");
  EXPECT_EQ(strict.verdict, Verdict::kExceeded);
  EXPECT_NEAR(strict.share, 1, 1e-9);
}

TEST(UserLimits, OfAMissingHandAreNotEvaluable) {
  Scenario scenario = PersonScenario();
  scenario.right_handle.reset();
  const SampleCollector run = Collect(scenario, 1, [](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1.0, 20);
    record.hands[1] = {};
    return record;
  });
  Assessment a = Assess(scenario, 9, RunOf(run), {.intervals = false});
  const std::size_t gaps = a.not_evaluable.size();
  JudgeUserLimits(ParseUserLimits(kHead + "hands.right.force_n,15,N,0,\n", "limits.csv"), &a);
  EXPECT_TRUE(a.limits.empty());
  ASSERT_EQ(a.not_evaluable.size(), gaps + 1);
  EXPECT_NE(a.not_evaluable.back().what.find("right force (my standard)"), std::string::npos);
}

TEST(UserLimits, AreShownWithTheirEdition) {
  Assessment a = Steady(20);
  JudgeUserLimits(ParseUserLimits(kHead + "hands.left.force_n,15,N,0,4.2\n", "limits.csv"), &a);
  for (const std::string& shown : {AssessmentText(a), AssessmentPage(a, "1.0")}) {
    EXPECT_NE(shown.find("Limits of your files (standard)"), std::string::npos);
    EXPECT_NE(shown.find("left force (my standard, 4.2), limit 15.0 N: exceeded. Worst 20.0 N."),
              std::string::npos);
  }
}

TEST(UserLimits, ShippedTemplateIsComplete) {
  const UserLimits limits =
      ReadUserLimits(std::string(PREDICTOR_SOURCE_DIR) + "/assets/limits_template.csv");
  EXPECT_GE(limits.rows.size(), 5u);
  EXPECT_NE(limits.edition.find("replace"), std::string::npos);
}

}  // namespace
}  // namespace predictor::assessment
