#include "assessment/muscle_use.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/samples.h"

namespace predictor::assessment {
namespace {

Assessment JudgeAt(double height, double force, bool right = true) {
  Scenario scenario = PersonScenario();
  const SampleCollector run = Collect(scenario, 0.5, [&](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, height, force);
    if (!right) record.hands[1].gripping = 0;
    return record;
  });
  return Assess(scenario, 9, run, {.intervals = false});
}

const QuantityResult& Row(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q;
  throw std::out_of_range(path);
}

bool Mentions(const std::vector<std::string>& lines, const std::string& words) {
  return std::ranges::any_of(
      lines, [&](const std::string& line) { return line.find(words) != std::string::npos; });
}

bool HasGap(const Assessment& a, const std::string& words) {
  return std::ranges::any_of(a.not_evaluable, [&](const NotEvaluable& gap) {
    return gap.what.find(words) != std::string::npos;
  });
}

TEST(MuscleUse, AHeavierLoadNeedsMoreOfTheElbowFlexors) {
  const Assessment light = JudgeAt(1.0, 10), heavy = JudgeAt(1.0, 60);
  for (const char* side : {"left", "right"}) {
    const std::string path = std::string("muscles.") + side + ".";
    EXPECT_GT(Row(heavy, path + "elbow_flexors").mean,
              Row(light, path + "elbow_flexors").mean + 0.05);
    EXPECT_GT(Row(heavy, path + "largest").mean, Row(light, path + "largest").mean);
    EXPECT_GT(Row(heavy, path + "mean").mean, 0);
    EXPECT_LE(Row(heavy, path + "largest").max, 1);
    EXPECT_GT(Row(heavy, path + "stiffest_n_per_m").mean,
              Row(heavy, path + "softest_n_per_m").mean);
    EXPECT_GT(Row(heavy, path + "stiffest_n_per_m").mean,
              Row(light, path + "stiffest_n_per_m").mean);
    EXPECT_LT(Row(light, path + "reserve_nm").max, kReserveLimit);
    EXPECT_EQ(Row(light, path + "too_weak").mean, 0);
  }
  EXPECT_FALSE(Mentions(light.warnings, "cannot produce"));
}

TEST(MuscleUse, OnlyTheFilesContainTheUncertainLargestStiffness) {
  const Assessment a = JudgeAt(1.0, 30);
  const std::string label = "hand's largest stiffness [N/m]";
  EXPECT_EQ(AssessmentText(a).find(label), std::string::npos);
  EXPECT_EQ(AssessmentPage(a, "1.0").find(label), std::string::npos);
  EXPECT_NE(AssessmentText(a).find("hand's smallest stiffness [N/m]"), std::string::npos);
  for (const std::string& file : {AssessmentJson(a), AssessmentCsv(a)})
    EXPECT_NE(file.find("muscles.left.stiffest_n_per_m"), std::string::npos);
}

TEST(MuscleUse, BothArmsOfASymmetricTaskDoTheSame) {
  const Assessment a = JudgeAt(1.0, 30);
  for (const char* value : {"largest", "mean", "rotator_cuff", "forearm", "softest_n_per_m"})
    EXPECT_NEAR(Row(a, std::string("muscles.left.") + value).mean,
                Row(a, std::string("muscles.right.") + value).mean,
                1e-3 * std::abs(Row(a, std::string("muscles.left.") + value).mean) + 1e-4)
        << value;
}

// The output must report a torque that no arm can hold.
TEST(MuscleUse, TorquesBeyondTheMusclesAreReported) {
  const Assessment a = JudgeAt(1.0, 700);
  EXPECT_EQ(Row(a, "muscles.left.too_weak").mean, 1);
  EXPECT_GT(Row(a, "muscles.left.reserve_nm").mean, 10);
  EXPECT_TRUE(Mentions(a.warnings, "100.0 % of the time, the muscles of the left arm cannot"));
}

TEST(MuscleUse, RaisedArmsHaveNoConclusionsAboutTheShoulder) {
  const Assessment a = JudgeAt(1.85, 10);
  ASSERT_GT(Row(a, "arms.left.elevation_rad").min, std::numbers::pi / 2);
  for (const char* value : {"largest", "shoulder_flexors", "rotator_cuff", "reserve_nm"})
    EXPECT_TRUE(std::isnan(Row(a, std::string("muscles.left.") + value).mean)) << value;
  EXPECT_TRUE(std::isfinite(Row(a, "muscles.left.elbow_extensors").mean));
  // Neither the strength nor the damage and the fatigue of the shoulder have values.
  EXPECT_TRUE(std::isnan(Row(a, "strength.left_shoulder").mean));
  EXPECT_TRUE(std::isfinite(Row(a, "strength.left_elbow").mean));
  ASSERT_EQ(a.damage.size(), 1U);
  EXPECT_EQ(a.damage[0].part, "lower back");
  ASSERT_EQ(a.fatigue.size(), 2U);
  for (const FatigueResult& f : a.fatigue) EXPECT_NE(f.joint.find("elbow"), std::string::npos);
  for (const char* gap :
       {"damage of the left shoulder (Shoulder Tool)", "fatigue of the right shoulder"})
    EXPECT_TRUE(HasGap(a, gap)) << gap;
  EXPECT_TRUE(HasGap(a, "muscles and stiffness of this arm, for 100.0 % of the time"));
  const auto json = nlohmann::json::parse(AssessmentJson(a));
  EXPECT_TRUE(json.at("quantities").at("muscles.left.largest").at("mean").is_null());
  EXPECT_NE(AssessmentText(a).find("–"), std::string::npos);
  EXPECT_EQ(AssessmentCsv(a).find("nan"), std::string::npos);
  EXPECT_EQ(AssessmentPage(a, "").find(">nan"), std::string::npos);
}

TEST(MuscleUse, AFreeArmHasNoValues) {
  const Assessment a = JudgeAt(1.0, 20, false);
  EXPECT_TRUE(std::isfinite(Row(a, "muscles.left.largest").mean));
  EXPECT_TRUE(std::isnan(Row(a, "muscles.right.largest").mean));
}

}  // namespace
}  // namespace predictor::assessment
