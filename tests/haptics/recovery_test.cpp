// Tests recovery's motion at random states of two arms. The motion must remove the violation, yield
// to the hand, and be slow.
#include "haptics/recovery.h"

#include <gtest/gtest.h>

#include "support/allocation_guard.h"
#include "two_arms.h"

namespace predictor {
namespace {

class RecoveryTest : public testing::Test {
 protected:
  RecoveryTest() : recovery_(two_.scenario_, two_.models_), random_(1, "recovery") {}

  // Moves all joints well inside their limits. The elbows may be anywhere.
  void Inside() {
    two_.Draw(&random_);
    for (int i = 0; i < kHands; ++i) {
      for (int j = 0; j < 7; ++j)
        two_.q_[i][j] = std::clamp(two_.q_[i][j], two_.limits_[i].lower[j] + 0.1,
                                   two_.limits_[i].upper[j] - 0.1);
      Update(i);
    }
  }
  void Update(int i) {
    two_.data_[static_cast<std::size_t>(i)].UpdateKinematics(*two_.models_[i], two_.q_[i],
                                                             two_.v0_);
  }
  std::array<JointVector, kHands> Step() {
    std::array<JointVector, kHands> v;
    recovery_.Step(two_.arms_, wrench_, &v);
    return v;
  }
  Twist HandleTwist(int i, const JointVector& v) {
    Jacobian J;
    two_.data_[static_cast<std::size_t>(i)].FrameJacobian(*two_.models_[i], two_.handles_[i], &J);
    return J * v;
  }
  // Moves the arms at the commanded velocity until there is no violation. Returns the duration [s].
  double Follow(double patience) {
    constexpr double kStep = 0.01;
    double t = 0;
    for (; t < patience && recovery_.Find(two_.arms_) != Beyond::kNothing; t += kStep) {
      const auto v = Step();
      for (int i = 0; i < kHands; ++i) {
        two_.q_[i] += kStep * v[i];
        Update(i);
      }
    }
    return t;
  }

  TwoArms two_;
  Recovery recovery_;
  RandomStream random_;
  std::array<HandWrench, kHands> wrench_;
};

TEST_F(RecoveryTest, FindsViolations) {
  int joints = 0, links = 0, nothing = 0;
  for (int k = 0; k < 3000; ++k) {
    two_.Draw(&random_);
    bool beyond = false;
    const double keeps = two_.scenario_.rendering.joint_security - Recovery::kJointMargin;
    for (int i = 0; i < kHands; ++i)
      for (int j = 0; j < 7; ++j)
        beyond |= two_.q_[i][j] < two_.limits_[i].lower[j] + keeps ||
                  two_.q_[i][j] > two_.limits_[i].upper[j] - keeps;
    const double elbows =
        (two_.data_[0].FramePose(*two_.models_[0], two_.models_[0]->Frame("panda_link4")).p -
         two_.data_[1].FramePose(*two_.models_[1], two_.models_[1]->Frame("panda_link4")).p)
            .norm();
    const Beyond found = recovery_.Find(two_.arms_);
    EXPECT_EQ(found, beyond                                                ? Beyond::kJoint
                     : elbows < two_.scenario_.rendering.security_distance ? Beyond::kLinks
                                                                           : Beyond::kNothing);
    joints += found == Beyond::kJoint;
    links += found == Beyond::kLinks;
    nothing += found == Beyond::kNothing;
  }
  EXPECT_GT(joints, 10);
  EXPECT_GT(links, 2);
  EXPECT_GT(nothing, 10);
}

// A joint within its security distance counts as beyond its limit, and links within
// rendering.security_distance count as too near. Rendering moves no joint into this zone and cannot
// move a joint out of the zone, so RECOVERY must do so. The message names the joint and its allowed
// range.
TEST_F(RecoveryTest, AJointNearerToItsLimitThanRenderingKeepsIsBeyond) {
  const double security = two_.scenario_.rendering.joint_security;
  for (int k = 0; k < 50; ++k) {
    Inside();
    if (recovery_.Find(two_.arms_) != Beyond::kNothing) continue;
    const int arm = static_cast<int>(random_.Next() % 2),
              joint = static_cast<int>(random_.Next() % 7);
    const bool low = random_.Uniform() < 0.5;
    const auto stand = [&](double from_limit) {
      two_.q_[arm][joint] = low ? two_.limits_[arm].lower[joint] + from_limit
                                : two_.limits_[arm].upper[joint] - from_limit;
      Update(arm);
    };
    stand(1.01 * security);
    EXPECT_NE(recovery_.Find(two_.arms_), Beyond::kJoint);
    stand(0.9 * security);
    const BeyondPlace at = recovery_.Where(two_.arms_);
    EXPECT_EQ(at.what, Beyond::kJoint);
    EXPECT_EQ(at.arm, arm);
    EXPECT_EQ(at.joint, joint);
    EXPECT_EQ(at.value, two_.q_[arm][joint]);
    EXPECT_DOUBLE_EQ(at.low, two_.limits_[arm].lower[joint] + security);
    EXPECT_DOUBLE_EQ(at.high, two_.limits_[arm].upper[joint] - security);
    EXPECT_LT(Follow(30), 30);
    EXPECT_EQ(recovery_.Find(two_.arms_), Beyond::kNothing);
  }
}

TEST_F(RecoveryTest, NanIsBeyond) {
  Inside();
  two_.q_[1][2] = std::nan("");
  EXPECT_EQ(recovery_.Find(two_.arms_), Beyond::kJoint);
}

TEST_F(RecoveryTest, LeadsJointsBackAndMovesNoOther) {
  for (int k = 0; k < 50; ++k) {
    Inside();
    const int arm = static_cast<int>(random_.Next() % 2),
              joint = static_cast<int>(random_.Next() % 7);
    const bool low = random_.Uniform() < 0.5;
    const double by = 0.001 + 0.2 * random_.Uniform();
    two_.q_[arm][joint] =
        low ? two_.limits_[arm].lower[joint] - by : two_.limits_[arm].upper[joint] + by;
    Update(arm);
    const auto v = Step();
    EXPECT_GT(low ? v[arm][joint] : -v[arm][joint], 0);
    EXPECT_NEAR(v[0].norm() + v[1].norm(), std::abs(v[arm][joint]), 1e-15);
    EXPECT_LT(Follow(30), 30);
    EXPECT_NE(recovery_.Find(two_.arms_), Beyond::kJoint);
  }
}

TEST_F(RecoveryTest, LeadsLinksApart) {
  int tried = 0;
  for (int k = 0; k < 20'000 && tried < 10; ++k) {
    Inside();
    if (recovery_.Find(two_.arms_) != Beyond::kLinks) continue;
    ++tried;
    EXPECT_LT(Follow(30), 30);
  }
  EXPECT_EQ(tried, 10);
}

// The power that flows from the hand into the handle must not be negative in any posture.
TEST_F(RecoveryTest, YieldsToTheHand) {
  int moved = 0;
  for (int k = 0; k < 500; ++k) {
    Inside();
    if (recovery_.Find(two_.arms_) != Beyond::kNothing) continue;
    for (HandWrench& wrench : wrench_) {
      wrench.present = true;
      for (int i = 0; i < 6; ++i) wrench.F_H_W[i] = (i < 3 ? 20 : 2) * random_.Normal();
    }
    const auto v = Step();
    for (int i = 0; i < kHands; ++i) {
      EXPECT_GE(wrench_[i].F_H_W.dot(HandleTwist(i, v[i])), 0);
      const bool pressed = wrench_[i].F_H_W.head<3>().norm() > Recovery::kForce;
      EXPECT_EQ(v[i].norm() > 0, pressed);
      moved += pressed;
    }
  }
  EXPECT_GT(moved, 100);
}

// Joints are beyond their limits or links are too near, and a hand is trapped. The recovery motion
// must not increase the pressure on the hand.
TEST_F(RecoveryTest, NeverMovesAgainstAHandThatIsLoaded) {
  int back = 0, yields = 0;
  for (int k = 0; k < 400; ++k) {
    two_.Draw(&random_);
    if (recovery_.Find(two_.arms_) == Beyond::kNothing) continue;
    for (HandWrench& hand : wrench_) hand = {};
    const auto free = Step();
    for (int i = 0; i < kHands; ++i) {
      wrench_[i].present = true;
      for (double& x : wrench_[i].F_H_W) x = 15 * random_.Normal();
    }
    const auto loaded = Step();
    for (int i = 0; i < kHands; ++i) {
      if (wrench_[i].F_H_W.head<3>().norm() < 10) continue;
      EXPECT_GE(wrench_[i].F_H_W.dot(HandleTwist(i, loaded[i])), -1e-9);
      (wrench_[i].F_H_W.dot(HandleTwist(i, free[i])) < 0 ? yields : back) += 1;
    }
  }
  EXPECT_GT(back, 50);
  EXPECT_GT(yields, 50);
}

TEST_F(RecoveryTest, StandsWithinTheLimits) {
  Inside();
  while (recovery_.Find(two_.arms_) != Beyond::kNothing) Inside();
  for (HandWrench& wrench : wrench_) wrench = {true, 0.9 * Recovery::kForce * Wrench::Unit(1)};
  const auto v = Step();
  EXPECT_EQ(v[0].norm(), 0);
  EXPECT_EQ(v[1].norm(), 0);
}

TEST_F(RecoveryTest, IsSlow) {
  double fastest = 0;
  for (int k = 0; k < 1000; ++k) {
    two_.Draw(&random_);
    for (HandWrench& wrench : wrench_) wrench = {true, 300 * Wrench::Random()};
    const auto v = Step();
    for (int i = 0; i < kHands; ++i) {
      const Twist V = HandleTwist(i, v[i]);
      fastest = std::max(fastest, V.head<3>().norm());
      EXPECT_LE(V.head<3>().norm(), Recovery::kHandleSpeed * (1 + 1e-12));
      EXPECT_LE(V.tail<3>().norm() * Recovery::kLength, Recovery::kHandleSpeed * (1 + 1e-12));
      EXPECT_LE(v[i].cwiseAbs().maxCoeff(), Recovery::kJointSpeed * (1 + 1e-12));
    }
  }
  EXPECT_GT(fastest, 0.9 * Recovery::kHandleSpeed);
}

TEST_F(RecoveryTest, DoesNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  two_.Draw(&random_);
  std::array<JointVector, kHands> v;
  const test::AllocationGuard guard;
  recovery_.Step(two_.arms_, wrench_, &v);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace predictor
