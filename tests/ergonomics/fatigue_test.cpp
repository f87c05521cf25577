// Compares the closed forms of the fatigue models with integration and with measured endurance.
#include "ergonomics/fatigue.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "support/allocation_guard.h"

namespace predictor::ergonomics {
namespace {

constexpr FatigueJoint kAllJoints[] = {
    FatigueJoint::kAnkle, FatigueJoint::kKnee, FatigueJoint::kTrunk,  FatigueJoint::kShoulder,
    FatigueJoint::kElbow, FatigueJoint::kGrip, FatigueJoint::kGeneral};

// Returns the relative error of the closed form. The closed form assumes that the active share
// equals the load, but in the model this share is smaller by F / LD (LD = 10 1/s).
double ActivationError(const FatigueRates& rates) { return 2 * rates.fatigue / 10; }

TEST(ThreeCompartments, FollowTheClosedFormUnderConstantLoad) {
  for (const FatigueJoint joint : kAllJoints) {
    const FatigueRates rates = FatigueRatesOf(joint);
    for (const double load : {0.2, 0.5, 0.8}) {
      const double time = 0.7 * EnduranceTime(load, rates);
      const Compartments m = Fatigued({load, 1 - load, 0}, load, time, rates);
      const double expected = FatiguedShareUnderConstantLoad(load, time, rates);
      EXPECT_NEAR(m.fatigued / expected, 1, ActivationError(rates)) << NameOf(joint) << load;
    }
  }
}

TEST(ThreeCompartments, FailAtTheEnduranceTime) {
  for (const FatigueJoint joint : kAllJoints) {
    const FatigueRates rates = FatigueRatesOf(joint);
    for (const double load : {0.3, 0.6, 0.9}) {
      const double endurance = EnduranceTime(load, rates);
      const Compartments start = {load, 1 - load, 0};
      EXPECT_GT(Fatigued(start, load, 0.99 * endurance, rates).capacity(), load);
      EXPECT_LT(Fatigued(start, load, 1.01 * endurance, rates).capacity(), load);
    }
  }
}

// At full effort, the strength falls to R / (F + R). Any load below this strength can be held
// indefinitely.
TEST(ThreeCompartments, EndAtTheStrengthThatRecoveryKeepsUp) {
  for (const FatigueJoint joint : kAllJoints) {
    const FatigueRates rates = FatigueRatesOf(joint);
    const double kept = rates.recovery / (rates.fatigue + rates.recovery);
    const Compartments m = Fatigued({}, 1, 20 / rates.recovery, rates);
    EXPECT_NEAR(m.active / kept, 1, ActivationError(rates)) << NameOf(joint);
    EXPECT_TRUE(std::isinf(EnduranceTime(0.999 * kept, rates)));
    EXPECT_FALSE(std::isinf(EnduranceTime(1.001 * kept, rates)));
  }
}

TEST(ThreeCompartments, RecoverByTheRestMultiplier) {
  const FatigueRates rates = FatigueRatesOf(FatigueJoint::kShoulder);
  const Compartments m = Fatigued({0, 0.4, 0.6}, 0, 30, rates);
  EXPECT_NEAR(m.fatigued, 0.6 * std::exp(-15 * 0.00168 * 30), 1e-9);
}

TEST(ThreeCompartments, KeepTheirSumAndRange) {
  RandomStream random(1, "compartments");
  for (const FatigueJoint joint : kAllJoints) {
    Compartments m;
    for (int i = 0; i < 500; ++i) {
      const double load = random.Uniform() < 0.3 ? 0 : 1.2 * random.Uniform();
      m = Fatigued(m, load, 20 * random.Uniform(), FatigueRatesOf(joint));
      EXPECT_NEAR(m.active + m.resting + m.fatigued, 1, 1e-10);
      for (const double share : {m.active, m.resting, m.fatigued}) {
        EXPECT_GE(share, -1e-6);
        EXPECT_LE(share, 1 + 1e-6);
      }
    }
  }
}

TEST(ThreeCompartments, DoNotDependOnTheStep) {
  const FatigueRates rates = FatigueRatesOf(FatigueJoint::kElbow);
  Compartments small;
  for (int i = 0; i < 10000; ++i) small = Fatigued(small, 0.4, 0.01, rates);
  const Compartments large = Fatigued({}, 0.4, 100, rates);
  EXPECT_NEAR(large.active, small.active, 1e-5);
  EXPECT_NEAR(large.fatigued, small.fatigued, 1e-5);
}

// The model agrees with measured endurance within a factor of two, which validates its
// coefficients. At loads above 70 % of the strength, the model's endurance falls to 0, but the
// measured endurance does not.
TEST(ThreeCompartments, AgreeWithMeasuredEnduranceWithinAFactorOfTwo) {
  for (const FatigueJoint joint : kAllJoints)
    for (const double load : {0.2, 0.3, 0.5, 0.7}) {
      const double ratio =
          EnduranceTime(load, FatigueRatesOf(joint)) / MeasuredEnduranceTime(load, joint);
      EXPECT_GT(ratio, 0.5) << NameOf(joint) << load;
      EXPECT_LT(ratio, 2) << NameOf(joint) << load;
    }
}

// Two points of each curve of Frey-Law & Avin 2010 were computed by hand from its coefficients.
TEST(MeasuredEndurance, IsThePublishedPowerLaw) {
  struct Point {
    FatigueJoint joint;
    double at_20, at_60;  // [s]
  };
  for (const Point& p :
       {Point{FatigueJoint::kAnkle, 955.7, 99.4}, Point{FatigueJoint::kKnee, 399.4, 50.6},
        Point{FatigueJoint::kTrunk, 876.0, 72.3}, Point{FatigueJoint::kShoulder, 282.6, 37.8},
        Point{FatigueJoint::kElbow, 630.3, 55.6}, Point{FatigueJoint::kGrip, 447.7, 76.4},
        Point{FatigueJoint::kGeneral, 530.6, 60.3}}) {
    EXPECT_NEAR(MeasuredEnduranceTime(0.2, p.joint), p.at_20, 0.05) << NameOf(p.joint);
    EXPECT_NEAR(MeasuredEnduranceTime(0.6, p.joint), p.at_60, 0.05) << NameOf(p.joint);
  }
}

// The paper states this order: "the ankle was most fatigue-resistant, followed by the trunk,
// hand/grip, elbow, knee and finally the shoulder".
TEST(MeasuredEndurance, HasThePublishedOrderAtHalfStrength) {
  const auto at = [](FatigueJoint joint) { return MeasuredEnduranceTime(0.5, joint); };
  EXPECT_GT(at(FatigueJoint::kAnkle), at(FatigueJoint::kTrunk));
  EXPECT_GT(at(FatigueJoint::kTrunk), at(FatigueJoint::kGrip));
  EXPECT_GT(at(FatigueJoint::kGrip), at(FatigueJoint::kElbow));
  EXPECT_GT(at(FatigueJoint::kElbow), at(FatigueJoint::kKnee));
  EXPECT_GT(at(FatigueJoint::kKnee), at(FatigueJoint::kShoulder));
}

TEST(Rohmert, HasItsKnownPoints) {
  EXPECT_NEAR(RohmertEnduranceTime(1), 60 * 0.1, 1e-9);
  EXPECT_NEAR(RohmertEnduranceTime(0.5), 60 * 1.1, 1e-9);
  EXPECT_TRUE(std::isinf(RohmertEnduranceTime(0.15)));
}

TEST(Capacity, IsTheLoadAtTheEnduranceTime) {
  for (const double load : {0.1, 0.5, 0.9})
    EXPECT_NEAR(Capacity(1, load, CapacityEnduranceTime(load)), load, 1e-12);
  EXPECT_NEAR(CapacityEnduranceTime(0.5), 60 * std::log(2) / 0.5, 1e-9);
}

// The test integrates the differential equations in small Euler steps.
TEST(Capacity, SolvesItsDifferentialEquation) {
  const CapacityRates rates;
  double worked = 1, rested = 0.5;
  constexpr double kStep = 1e-3;
  for (int i = 0; i < 30'000; ++i) {
    worked -= kStep * rates.fatigue * worked * 0.4;
    rested += kStep * rates.recovery * (1 - rested);
  }
  EXPECT_NEAR(Capacity(1, 0.4, 30), worked, 1e-5);
  EXPECT_NEAR(Capacity(0.5, 0, 30), rested, 1e-4);
}

TEST(TrialFatigue, IsCompleteAfterTheTrial) {
  const TrialFatigue trial = {0.4, 90, 0.1, 0.5};
  EXPECT_NEAR(TrialFatigueAfter(0, 0.4, 90, trial), 0.993, 1e-12);
  EXPECT_NEAR(TrialFatigueAfter(0, 0.8, 45, trial), 0.993, 1e-12);  // the effort counts
  double v = 0.2;
  constexpr double kStep = 1e-3;
  for (int i = 0; i < 10'000; ++i) v += kStep * (1 - v) * 0.3 / trial.Effort();
  EXPECT_NEAR(TrialFatigueAfter(0.2, 0.3, 10, trial), v, 1e-4);
  EXPECT_LT(TrialFatigueAfter(0.5, 0.05, 10, trial), 0.5);
  EXPECT_NEAR(TrialFatigueAfter(0.5, 0, 10, trial), 0.5 * std::exp(-0.5 * 10 / trial.Effort()),
              1e-12);
}

TEST(FatigueModels, DoNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  const test::AllocationGuard guard;
  const Compartments m = Fatigued({}, 0.5, 1, FatigueRatesOf(FatigueJoint::kElbow));
  const double sum = m.capacity() + Capacity(1, 0.5, 1) + TrialFatigueAfter(0, 0.5, 1, {});
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace predictor::ergonomics
