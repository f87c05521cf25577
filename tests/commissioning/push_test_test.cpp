#include "commissioning/push_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "support/allocation_guard.h"
#include "support/constants.h"

namespace predictor::commissioning {
namespace {

// A sensor that reads R · force when someone pushes the handle, with noise and the sway of a hand.
class Pusher {
 public:
  explicit Pusher(const Matrix3& R = Matrix3::Identity(), bool swapped = false)
      : R_(R), swapped_(swapped), random_(1, "push") {}

  void Push(const Vector3& force, double time) {
    for (int k = 0; k < static_cast<int>(time / kDt + 0.5); ++k) {
      Vector3 noisy = R_ * force;
      for (double& f : noisy) f += 0.15 * random_.Normal();
      noisy += 0.08 * force.norm() * Vector3(std::sin(0.01 * k), std::cos(0.012 * k), 0.5);
      Wrench own = Wrench::Zero(), other = Wrench::Zero();
      (swapped_ ? other : own).head<3>() = noisy;
      test.Update(own, other, kDt);
    }
  }
  // Performs the whole test as instructed.
  void Obey() {
    for (int axis = 0; axis < 3; ++axis) {
      Push(Vector3::Zero(), 0.5);
      Push(12 * Vector3::Unit(axis), 0.8);
    }
  }
  PushTest test;

 private:
  Matrix3 R_;
  bool swapped_;
  RandomStream random_;
};

// Returns all mountings with permuted and inverted axes.
std::vector<Matrix3> AllMountings() {
  std::vector<Matrix3> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3 R = Matrix3::Zero();
      for (int i = 0; i < 3; ++i)
        R(order[static_cast<std::size_t>(i)], i) = (signs >> i & 1) != 0 ? -1 : 1;
      all.push_back(R);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

TEST(PushTest, PassesOnlyWhereEachPushReadsAsPushed) {
  int passed = 0;
  for (const Matrix3& R : AllMountings()) {
    Pusher pusher(R);
    pusher.Obey();
    ASSERT_TRUE(pusher.test.done());
    EXPECT_EQ(pusher.test.passed(), R.isIdentity()) << R;
    EXPECT_EQ(pusher.test.Refusal().empty(), R.isIdentity());
    passed += pusher.test.passed();
    for (int i = 0; i < 3; ++i) {
      const AxisReading& reading = pusher.test.readings()[static_cast<std::size_t>(i)];
      EXPECT_EQ(R(reading.axis, i), reading.negative ? -1 : 1);
    }
  }
  EXPECT_EQ(passed, 1);
}

std::string RefusalFor(const Matrix3& R, bool swapped = false) {
  Pusher pusher(R, swapped);
  pusher.Obey();
  return pusher.test.Refusal();
}

TEST(PushTest, NamesTheLikelyError) {
  const Matrix3 I = Matrix3::Identity();
  Matrix3 mirrored = I;
  mirrored(1, 1) = -1;
  const std::string one = RefusalFor(mirrored);
  EXPECT_NE(one.find("along +y reads -y: mirrored"), std::string::npos) << one;
  EXPECT_NE(one.find("no mounting can cause"), std::string::npos) << one;
  EXPECT_EQ(one.find("along +x"), std::string::npos) << one;
  const std::string all = RefusalFor(-I);
  EXPECT_NE(all.find("All signs are reversed"), std::string::npos) << all;
  const Matrix3 quarter = Eigen::AngleAxisd(M_PI / 2, Vector3::UnitZ()).toRotationMatrix();
  const std::string turned = RefusalFor(quarter);
  EXPECT_NE(turned.find("rotated by 90° about +z"), std::string::npos) << turned;
  const Matrix3 upside_down = Eigen::AngleAxisd(M_PI, Vector3::UnitX()).toRotationMatrix();
  EXPECT_NE(RefusalFor(upside_down).find("rotated by 180° about"), std::string::npos)
      << RefusalFor(upside_down);
  const std::string other = RefusalFor(I, true);
  EXPECT_NE(other.find("at the other handle"), std::string::npos) << other;
  EXPECT_NE(other.find("swapped"), std::string::npos) << other;
}

TEST(PushTest, ReportsForEachPushWhetherTheReadingsDiffer) {
  Matrix3 mirrored = Matrix3::Identity();
  mirrored(1, 1) = -1;
  Pusher pusher(mirrored);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(pusher.test.Wrong(axis), "");  // no push yet
  pusher.Obey();
  EXPECT_EQ(pusher.test.Wrong(0), "");
  EXPECT_EQ(pusher.test.Wrong(1), "The push along +y reads -y: mirrored.");
  EXPECT_EQ(pusher.test.Wrong(2), "");
  Pusher swapped(Matrix3::Identity(), true);
  swapped.Push(Vector3::Zero(), 0.5);
  swapped.Push({12, 0, 0}, 0.8);
  EXPECT_EQ(swapped.test.Wrong(0), "The push along +x reads +x at the other handle.");
  EXPECT_EQ(swapped.test.Wrong(1), "");
}

TEST(PushTest, ATurnByLessThanAQuarterIsNotClear) {
  Pusher pusher(Eigen::AngleAxisd(M_PI / 4, Vector3::UnitZ()).toRotationMatrix());
  pusher.Push(Vector3::Zero(), 0.2);
  pusher.Push({12, 0, 0}, 3);
  EXPECT_EQ(pusher.test.axis(), 0);
  EXPECT_EQ(pusher.test.hint(), PushTest::Hint::kStraighter);
}

TEST(PushTest, CountsOnlyClearPushesThatLast) {
  struct Case {
    Vector3 force;
    double time;
    bool counts;
  };
  for (const Case& c :
       {Case{{4, 0, 0}, 2, false}, Case{{6.5, 0, 0}, 0.7, true}, Case{{30, 0, 0}, 2, false},
        Case{{20, 0, 0}, 0.7, true}, Case{{12, 0, 0}, 0.25, false}, Case{{12, 6, 0}, 2, false},
        Case{{-12, 0, 0}, 0.7, true}}) {
    Pusher pusher;
    pusher.Push(Vector3::Zero(), 0.2);
    pusher.Push(c.force, c.time);
    EXPECT_EQ(pusher.test.axis(), c.counts ? 1 : 0) << c.force.transpose() << " for " << c.time;
  }
}

// A push must last long enough in one direction. If the direction changes, its time starts again
// from zero.
TEST(PushTest, CountsTheTimeOfOneDirectionOnly) {
  Pusher pusher;
  pusher.Push(Vector3::Zero(), 0.2);
  pusher.Push({12, 0, 0}, 0.2);
  pusher.Push({0, 12, 0}, 0.25);
  EXPECT_EQ(pusher.test.axis(), 0);
  pusher.Push({0, 12, 0}, 0.1);
  EXPECT_EQ(pusher.test.axis(), 1);
  EXPECT_STREQ(Name(pusher.test.readings()[0]), "+y");
}

TEST(PushTest, WaitsUntilTheHandleIsFreeBeforeEachPush) {
  Pusher pusher;
  pusher.Push({12, 0, 0}, 2);  // a hand is on the handle from the start
  EXPECT_EQ(pusher.test.axis(), 0);
  EXPECT_EQ(pusher.test.hint(), PushTest::Hint::kLetGo);
  pusher.Push(Vector3::Zero(), 0.1);
  pusher.Push({12, 0, 0}, 5);  // counts only once
  EXPECT_EQ(pusher.test.axis(), 1);
  EXPECT_FALSE(pusher.test.passed());
}

TEST(PushTest, WaitsUntilTheOtherHandleIsFreeToo) {
  PushTest test;
  Wrench own = Wrench::Zero(), other = Wrench::Zero();
  other[1] = 8;  // a person leans on it
  for (int k = 0; k < 1000; ++k) test.Update(own, other, kDt);
  EXPECT_EQ(test.hint(), PushTest::Hint::kLetGo);
  own[0] = 12;
  for (int k = 0; k < 1000; ++k) test.Update(own, other, kDt);
  EXPECT_EQ(test.axis(), 0);
}

TEST(PushTest, IgnoresInvalidNumbers) {
  PushTest test;
  Wrench F = Wrench::Zero();
  for (int k = 0; k < 100; ++k) test.Update(F, F, kDt);
  F[0] = std::nan("");
  for (int k = 0; k < 1000; ++k) test.Update(F, Wrench::Zero(), kDt);
  EXPECT_EQ(test.axis(), 0);
}

TEST(PushTest, DoesNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  Pusher pusher;
  test::AllocationGuard guard;
  pusher.Obey();
  EXPECT_EQ(guard.count(), 0);
  EXPECT_TRUE(pusher.test.passed());
}

}  // namespace
}  // namespace predictor::commissioning
