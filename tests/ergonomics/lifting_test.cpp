// Compares NIOSH's lifting equation and the Liberty Mutual equations with published examples and
// with an independent transcription.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "ergonomics/lm_mmh.h"
#include "ergonomics/niosh.h"

namespace predictor::ergonomics {
namespace {

// The manual's examples are in inches and pounds. The metric form of the manual is the same
// equation with rounded units (10 in = 25 cm, 30 in = 75 cm, 51 lb = 23 kg).
constexpr double kManualInch = 0.025;       // [m]
constexpr double kManualPound = 23.0 / 51;  // [kg]

HandPlace Inches(double horizontal, double height, double asymmetry_in_degrees) {
  return {horizontal * kManualInch, height * kManualInch, Degrees(asymmetry_in_degrees)};
}

double InPounds(double kilograms) { return kilograms / kManualPound; }

// The inputs, the multipliers, the limits of figure 14 of the manual and the unrounded limits were
// verified. The horizontal distance at the destination follows from its multiplier.
TEST(Niosh, Example4PackageInspection) {
  LiftTask task;
  task.origin = Inches(10, 22, 0);
  task.destination = Inches(20, 59, 0);
  task.controlled_at_destination = true;
  task.frequency = 3;
  task.coupling = Coupling::kFair;
  const LiftAssessment lift = AssessLift(task);
  EXPECT_NEAR(lift.origin.horizontal, 1, 1e-12);
  EXPECT_NEAR(lift.origin.vertical, 0.94, 1e-12);
  EXPECT_NEAR(lift.origin.distance, 0.87, 0.005);
  EXPECT_NEAR(lift.origin.asymmetry, 1, 1e-12);
  EXPECT_NEAR(lift.origin.frequency, 0.88, 1e-12);
  EXPECT_NEAR(lift.origin.coupling, 0.95, 1e-12);
  EXPECT_NEAR(lift.destination.coupling, 1, 1e-12);
  EXPECT_NEAR(InPounds(lift.origin.Limit()), 34.8, 0.05);       // 34.9 with rounded multipliers
  EXPECT_NEAR(InPounds(lift.destination.Limit()), 15.3, 0.05);  // 15.2
  EXPECT_TRUE(lift.by_destination);
  EXPECT_EQ(lift.limit, lift.destination.Limit());
}

// The result was verified in a handbook chapter, which has 14.4 lb and 13.3 lb with rounded
// multipliers.
TEST(Niosh, Example5DishWashingMachineUnloading) {
  LiftTask task;
  task.mean_load = 20 * kManualPound;
  task.origin = Inches(20, 44, 30);
  task.destination = Inches(20, 7, -30);  // the other side
  task.controlled_at_destination = true;
  task.frequency = 5;
  const LiftAssessment lift = AssessLift(task);
  EXPECT_NEAR(lift.origin.frequency, 0.80, 1e-12);
  EXPECT_NEAR(InPounds(lift.origin.Limit()), 14.4, 0.1);
  EXPECT_NEAR(InPounds(lift.destination.Limit()), 13.3, 0.1);
  EXPECT_NEAR(lift.index, 1.5, 0.05);
}

// The limits of 16.3 lb and 14.5 lb are quoted from memory and were not verified.
TEST(Niosh, Example1LoadingPunchPressStock) {
  LiftTask task;
  task.origin = Inches(23, 15, 0);
  task.destination = Inches(23, 64, 0);
  task.controlled_at_destination = true;
  task.frequency = 0.1;
  task.coupling = Coupling::kFair;
  const LiftAssessment lift = AssessLift(task);
  // The printed multipliers give these limits. The printed multipliers are rounded to two digits
  // (10/23 to 0.44).
  EXPECT_NEAR(51 * 0.44 * 0.89 * 0.86 * 0.95, 16.3, 0.05);
  EXPECT_NEAR(51 * 0.44 * 0.75 * 0.86, 14.5, 0.05);
  constexpr double kRounding = 0.0055;
  EXPECT_NEAR(lift.origin.horizontal, 0.44, kRounding);
  EXPECT_NEAR(lift.origin.vertical, 0.89, kRounding);
  EXPECT_NEAR(lift.origin.distance, 0.86, kRounding);
  EXPECT_NEAR(lift.origin.coupling, 0.95, kRounding);
  EXPECT_NEAR(lift.destination.vertical, 0.75, kRounding);
  EXPECT_EQ(lift.destination.coupling, 1);
  EXPECT_EQ(lift.destination.frequency, 1);
  EXPECT_TRUE(lift.by_destination);
}

// Section 2.4.5 of the manual is quoted from memory and was not verified. The limits are 20, 20 and
// 15 lb for a single lift, the loads 30, 20 and 10 lb, and the frequencies 1, 2 and 4 lifts per
// minute. The composite lifting index is therefore CLI = 1.60 + 0.07 + 0.20.
TEST(Niosh, CompositeIndexOfThreeTasks) {
  const auto task = [](double limit, double load, double frequency) {
    LiftTask t;
    // At 0.6 m from the ankles and over a short distance, the height determines the limit.
    const double vertical = limit * kManualPound / kLoadConstant * 0.6 / 0.25;
    t.origin = t.destination = {0.6, 0.75 + (1 - vertical) / 0.3, 0};
    t.mean_load = t.max_load = load * kManualPound;
    t.frequency = frequency;
    return t;
  };
  std::vector<LiftTask> tasks = {task(15, 10, 4), task(20, 30, 1), task(20, 20, 2)};
  EXPECT_NEAR(CompositeLiftingIndex(tasks), 1.90, 0.05);
  const double exact =
      30 / (20 * 0.94) + 1.0 * (1 / 0.88 - 1 / 0.94) + 10.0 / 15 * (1 / 0.70 - 1 / 0.88);
  EXPECT_NEAR(CompositeLiftingIndex(tasks), exact, 1e-12);
  std::swap(tasks[0], tasks[2]);
  EXPECT_NEAR(CompositeLiftingIndex(tasks), exact, 1e-12);  // the order does not matter
  tasks.resize(1);
  EXPECT_NEAR(CompositeLiftingIndex(tasks), AssessLift(tasks[0]).index, 1e-12);
  EXPECT_EQ(CompositeLiftingIndex({}), 0);
  tasks.push_back(task(20, 20, 20));  // the frequency is too high
  EXPECT_TRUE(std::isinf(CompositeLiftingIndex(tasks)));
}

// The test checks cells from each column of the manual's table 5 (verified) and the rules of the
// table.
TEST(Niosh, FrequencyMultiplierIsThatOfTheTable) {
  using enum LiftDuration;
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(0.05, kShort, 1), 1.00);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(0.5, kShort, 0.5), 0.97);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(9, kShort, 0.5), 0.52);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(13, kShort, 0.75), 0.34);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(13, kShort, 0.74), 0);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(15, kShort, 1), 0.28);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(15.1, kShort, 1), 0);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(6, kModerate, 1), 0.50);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(11, kModerate, 1), 0.23);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(11, kModerate, 0.7), 0);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(0.2, kLong, 1), 0.85);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(8, kLong, 0.7), 0.18);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(9, kLong, 0.7), 0);
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(10, kLong, 1), 0.13);
  // Example 7 interpolates between 2 and 3 lifts a minute.
  EXPECT_DOUBLE_EQ(FrequencyMultiplier(2.4, kShort, 1), 0.91 - 0.4 * 0.03);
  for (const auto duration : {kShort, kModerate, kLong})
    for (double f = 0.1; f < 16; f += 0.1)
      EXPECT_GE(FrequencyMultiplier(f, duration, 1), FrequencyMultiplier(f + 0.1, duration, 1));
}

TEST(Niosh, RecommendsNoLoadOutsideItsRange) {
  LiftTask task;
  task.mean_load = 10;
  task.origin = {0.25, 0.75, 0};
  task.destination = {0.25, 0.75, 0};
  EXPECT_NEAR(AssessLift(task).limit, 23, 1e-12);
  const auto limit_with = [&](HandPlace origin, double destination_height) {
    LiftTask changed = task;
    changed.origin = origin;
    changed.destination.height = destination_height;
    return AssessLift(changed).limit;
  };
  // a distance below 0.25 m gives no advantage
  EXPECT_NEAR(limit_with({0.1, 0.75, 0}, 0.75), 23, 1e-12);
  EXPECT_GT(limit_with({0.63, 0.75, 0}, 0.75), 0);
  EXPECT_EQ(limit_with({0.64, 0.75, 0}, 0.75), 0);
  EXPECT_EQ(limit_with({0.25, 1.76, 0}, 1.76), 0);
  EXPECT_EQ(limit_with({0.25, -0.01, 0}, 0.75), 0);
  EXPECT_GT(limit_with({0.25, 0.75, Degrees(135)}, 0.75), 0);
  EXPECT_EQ(limit_with({0.25, 0.75, Degrees(136)}, 0.75), 0);
  EXPECT_EQ(limit_with({0.25, 0, 0}, 1.76), 0);
  task.origin.horizontal = 1;
  EXPECT_TRUE(std::isinf(AssessLift(task).index));
}

TEST(Niosh, AssistedLiftIsLabelledAsAdapted) {
  LiftTask whole;
  whole.mean_load = whole.max_load = 18;
  whole.origin = {0.4, 0.75, 0};
  whole.destination = {0.4, 1.05, 0};
  const AssistedLift lift = AssessAssistedLift(whole, 6 * 9.81);
  EXPECT_EQ(lift.carried.limit, lift.unassisted.limit);
  EXPECT_NEAR(lift.carried.index, lift.unassisted.index / 3, 1e-12);
  EXPECT_EQ(AssessAssistedLift(whole, -5).carried.index, 0);
  EXPECT_STREQ(AssistedLift::kCarriedLabel, "adapted, not NIOSH");
}

// Each equation multiplies a reference load by factors. Under the reference condition, these
// factors are 1 within the four printed digits. A wrong digit in any constant makes this test fail.
// With
// 0.6687 instead of 0.6887, the men's sustained push would be 9 % too large.
TEST(LmMmh, EachEquationReturnsItsReferenceLoad) {
  constexpr double kOnceInEightHours = 1.0 / 480, kPrinted = 1e-3;
  const VerticalHandling female = {0.20, 9.221 / (2 * 13.69), 0.25, kOnceInEightHours};
  const VerticalHandling male = {0.25, 3.296 / (2 * 1.912), 0.25, kOnceInEightHours};
  const auto expect = [](const Acceptable& a, double reference, double unit = 1) {
    EXPECT_NEAR(a.mean / unit / reference, 1, kPrinted) << reference;
    EXPECT_FALSE(a.outside);
  };
  expect(AcceptableLift(female, Sex::kFemale), 34.9);
  expect(AcceptableLift(male, Sex::kMale), 82.6);
  expect(AcceptableLower(female, Sex::kFemale), 37.0);
  expect(AcceptableLower(male, Sex::kMale), 95.9);
  using enum ForcePhase;
  constexpr double kKgf = 9.80665;
  const auto at = [](double height) { return HorizontalHandling{height, 2.1, kOnceInEightHours}; };
  const double best_initial = 0.6915 / (2 * 0.3361), best_sustained = 0.5722 / (2 * 0.2941);
  expect(AcceptablePush(at(best_initial), kInitial, Sex::kFemale), 36.9, kKgf);
  expect(AcceptablePull(at(best_initial), kInitial, Sex::kFemale), 36.9, kKgf);
  expect(AcceptablePush(at(best_sustained), kSustained, Sex::kFemale), 25.5, kKgf);
  expect(AcceptablePull(at(best_sustained), kSustained, Sex::kFemale), 25.5, kKgf);
  expect(AcceptablePush(at(1.44), kInitial, Sex::kMale), 70.3, kKgf);
  expect(AcceptablePush(at(1.44), kSustained, Sex::kMale), 65.3, kKgf);
  expect(AcceptablePull(at(0.63), kInitial, Sex::kMale), 69.8, kKgf);
  expect(AcceptablePull(at(0.63), kSustained, Sex::kMale), 61.0, kKgf);
  expect(AcceptableCarry(at(0.73), Sex::kFemale), 28.6);
  expect(AcceptableCarry(at(0.78), Sex::kMale), 74.9);
}

// Two points of each equation were computed from the public transcription exactly as it is written,
// with one expression each and the constant 0.6887.
TEST(LmMmh, AgreesWithAnIndependentTranscription) {
  constexpr double kDigits = 1e-6, kKgf = 9.80665;
  const VerticalHandling a = {0.38, 0.6, 0.5, 1}, b = {0.5, 1.2, 0.76, 6};
  EXPECT_NEAR(AcceptableLift(a, Sex::kMale).mean, 38.632857, kDigits);
  EXPECT_NEAR(AcceptableLift(b, Sex::kMale).mean, 18.617942, kDigits);
  EXPECT_NEAR(AcceptableLower(a, Sex::kMale).mean, 41.370617, kDigits);
  EXPECT_NEAR(AcceptableLower(b, Sex::kMale).mean, 21.385401, kDigits);
  EXPECT_NEAR(AcceptableLift(a, Sex::kFemale).mean, 16.333661, kDigits);
  EXPECT_NEAR(AcceptableLift(b, Sex::kFemale).mean, 8.706431, kDigits);
  EXPECT_NEAR(AcceptableLower(a, Sex::kFemale).mean, 17.316489, kDigits);
  EXPECT_NEAR(AcceptableLower(b, Sex::kFemale).mean, 9.230314, kDigits);
  using enum ForcePhase;
  const std::array<HorizontalHandling, 2> tasks = {{{0.95, 7.6, 1}, {0.7, 2.1, 0.2}}};
  struct Point {
    Acceptable (*equation)(const HorizontalHandling&, ForcePhase, Sex);
    ForcePhase phase;
    Sex sex;
    std::array<double, 2> mean;
  };
  for (const Point& point :
       {Point{AcceptablePush, kInitial, Sex::kFemale, {24.640118, 25.963822}},
        Point{AcceptablePull, kInitial, Sex::kFemale, {24.640118, 25.963822}},
        Point{AcceptablePush, kSustained, Sex::kFemale, {13.995975, 16.298407}},
        Point{AcceptablePull, kSustained, Sex::kFemale, {13.995975, 16.298407}},
        Point{AcceptablePush, kInitial, Sex::kMale, {34.771767, 49.170192}},
        Point{AcceptablePush, kSustained, Sex::kMale, {20.054580, 38.207092}},
        Point{AcceptablePull, kInitial, Sex::kMale, {29.705084, 49.066888}},
        Point{AcceptablePull, kSustained, Sex::kMale, {17.835881, 36.016646}}})
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(point.equation(tasks[i], point.phase, point.sex).mean / kKgf, point.mean[i],
                  kDigits);
  EXPECT_NEAR(AcceptableCarry(tasks[0], Sex::kFemale).mean, 16.469705, kDigits);
  EXPECT_NEAR(AcceptableCarry(tasks[1], Sex::kFemale).mean, 20.758139, kDigits);
  EXPECT_NEAR(AcceptableCarry(tasks[0], Sex::kMale).mean, 27.047353, kDigits);
  EXPECT_NEAR(AcceptableCarry(tasks[1], Sex::kMale).mean, 55.186672, kDigits);
}

TEST(LmMmh, ShareAndLoadAreInverse) {
  const Acceptable a = {20, 0.26, false};
  EXPECT_NEAR(a.ForShare(0.75), 20 * (1 - 0.6745 * 0.26), 1e-3);
  EXPECT_NEAR(a.ForShare(0.90), 20 * (1 - 1.2816 * 0.26), 1e-3);
  EXPECT_NEAR(a.ShareThatAccepts(20), 0.5, 1e-12);
  for (const double share : {0.1, 0.5, 0.75, 0.99})
    EXPECT_NEAR(a.ShareThatAccepts(a.ForShare(share)), share, 1e-9);
  EXPECT_EQ(Acceptable{}.ShareThatAccepts(1), 0);
}

TEST(LmMmh, ReportsWhatTheStudyDidNotCover) {
  EXPECT_TRUE(AcceptableLift({0.8, 1, 0.5, 1}, Sex::kMale).outside);
  EXPECT_TRUE(AcceptableLift({0.4, 1, 0.1, 1}, Sex::kMale).outside);
  EXPECT_TRUE(AcceptableLift({0.4, 1, 0.5, 30}, Sex::kMale).outside);
  EXPECT_TRUE(AcceptableCarry({1, 0.3, 1}, Sex::kFemale).outside);
  EXPECT_FALSE(AcceptableLift({0.4, 1, 0.5, 1}, Sex::kMale).outside);
  EXPECT_EQ(AcceptableLift({0.4, 1, 0.1, 1}, Sex::kMale).mean,
            AcceptableLift({0.4, 1, 0.25, 1}, Sex::kMale).mean);
}

}  // namespace
}  // namespace predictor::ergonomics
