#include "safety/warnings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "support/constants.h"

namespace predictor {
namespace {

class WarningsTest : public testing::Test {
 protected:
  WarningsTest() : warnings_({0.2, 0.2}, kDt), random_(1, "warnings") {
    input_.present = {true, true};
    input_.sample = &sample_;
  }
  // Passes the packets of the left hand's sensor during `time` [s], some of which are lost or
  // refused.
  void Pass(double time, int each_lost = 0, int each_refused = 0) {
    for (int k = 0; k < static_cast<int>(time / kDt); ++k) {
      ++tick_;
      LinkCounts& link = sample_.arms[0].sensor_link;
      const bool lost = each_lost > 0 && tick_ % each_lost == 0;
      ++(lost ? link.lost : link.taken);
      if (each_refused > 0 && tick_ % each_refused == 0) ++link.refused;
      for (int i = 0; i < 3; ++i) input_.wrench[0].F_H_W[i] = force_[i] + 0.05 * random_.Normal();
      force_ += drift_ * kDt;
      warnings_.Update(input_);
    }
  }
  bool Has(Warning warning, std::size_t hand = 0) const {
    return (warnings_.bits(hand) >> static_cast<unsigned>(warning) & 1U) != 0;
  }

  Warnings warnings_;
  RandomStream random_;
  DeviceSample sample_;
  WarningInput input_;
  Vector3 force_ = Vector3::Zero(), drift_ = Vector3::Zero();
  long tick_ = 0;
};

TEST_F(WarningsTest, MoreThanOnePercentLostIsReported) {
  Pass(3, 125);  // 0.8 %
  EXPECT_EQ(warnings_.bits(0), 0);
  Pass(3, 67);  // 1.5 %
  EXPECT_TRUE(Has(Warning::kSensorLoss));
  EXPECT_NEAR(warnings_.values(0)[static_cast<int>(Warning::kSensorLoss)], 0.015, 0.003);
  EXPECT_EQ(warnings_.bits(1), 0);
  Pass(3, 125);  // less than half of the limit
  EXPECT_TRUE(Has(Warning::kSensorLoss));
  Pass(3);
  EXPECT_EQ(warnings_.bits(0), 0);
}

TEST_F(WarningsTest, ASingleLossIsNotReported) {
  Pass(2);
  ++sample_.arms[0].sensor_link.lost;
  Pass(2);
  EXPECT_EQ(warnings_.bits(0), 0);
}

TEST_F(WarningsTest, RefusalsAreReported) {
  Pass(1);
  ++sample_.arms[1].arm_link.refused;
  warnings_.Update(input_);
  EXPECT_TRUE(Has(Warning::kRefused, 1));
  EXPECT_EQ(warnings_.bits(0), 0);
  Pass(3);
  EXPECT_EQ(warnings_.bits(1), 0);
}

TEST_F(WarningsTest, ADriftAtRestIsReported) {
  input_.rests = true;
  Pass(11);
  EXPECT_EQ(warnings_.bits(0), 0);
  drift_ = Vector3(0, 1.8 / 60, 0);
  Pass(11);
  EXPECT_FALSE(Has(Warning::kBiasDrift));
  drift_ = Vector3(0, 0, 2.2 / 60);
  Pass(2 * Warnings::kDriftTime + 0.1);
  EXPECT_TRUE(Has(Warning::kBiasDrift));
  EXPECT_NEAR(warnings_.values(0)[static_cast<int>(Warning::kBiasDrift)], 2.2, 0.2);
  drift_.setZero();
  Pass(2 * Warnings::kDriftTime + 0.1);
  EXPECT_EQ(warnings_.bits(0), 0);
}

// Warnings that an arm itself reports must be shown unchanged.
TEST_F(WarningsTest, OfPowerAreAsTheArmSays) {
  sample_.arms[1].keeps_power = sample_.arms[0].no_power_off = true;
  Pass(kDt);
  EXPECT_TRUE(Has(Warning::kKeepsPower, 1));
  EXPECT_FALSE(Has(Warning::kKeepsPower, 0));
  EXPECT_TRUE(Has(Warning::kNoPowerOff, 0));
  EXPECT_FALSE(Has(Warning::kNoPowerOff, 1));
  sample_.arms[1].keeps_power = sample_.arms[0].no_power_off = false;
  Pass(kDt);
  EXPECT_EQ(warnings_.bits(0) | warnings_.bits(1), 0);
}

TEST_F(WarningsTest, MotionAndAHandAreNotDrift) {
  drift_ = Vector3(0.2, 0, 0);
  Pass(12);  // not at rest
  EXPECT_FALSE(Has(Warning::kBiasDrift));
  input_.rests = true;
  drift_.setZero();
  for (int k = 0; k < 15'000; ++k) {  // a person holds the handle
    force_[0] = 1.5 * std::sin(0.002 * k) + 0.0002 * k;
    Pass(kDt);
  }
  EXPECT_FALSE(Has(Warning::kBiasDrift));
}

}  // namespace
}  // namespace predictor
