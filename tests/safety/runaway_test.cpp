#include "safety/runaway.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/minimum_jerk.h"
#include "core/random.h"
#include "support/constants.h"

namespace predictor {
namespace {

constexpr double kCap = 0.25;
constexpr double kThreshold = 30;  // force threshold that stops every run that reaches it [N]

// A mass held by a hand that aims at another position. The sign is 1 if the sensor is mounted
// correctly, and −1 if the sensor is mirrored.
class Hand {
 public:
  Hand(double stiffness, double mass, double spring, std::uint64_t seed)
      : stiffness_(stiffness), mass_(mass), spring_(spring), random_(seed, "hand") {}
  // Returns the delay of the alarm [s] after both thresholds are exceeded, or −1 without an alarm.
  // `intent` is the hand's target position [m].
  template <class Intent>
  double Run(double sign, double duration, const Intent& intent) {
    RunawayDetector detector(kCap, kDt);
    double x = 0, v = 0;
    for (double t = 0; t < duration; t += kDt) {
      const double noise = 0.1 * random_.Normal();
      tremor_ += (noise - tremor_) * 0.06;
      const double true_force = stiffness_ * (intent(t) - x) - damping_ * v + 3 * tremor_;
      const double felt = sign * true_force + 0.05 * random_.Normal();
      v += (felt - spring_ * x - 4 * v) / mass_ * kDt;
      v = std::clamp(v, -kCap, kCap);
      x += v * kDt;
      fastest = std::max(fastest, std::abs(v));
      if (fast_ < 0 && std::abs(v) > detector.threshold() && std::abs(felt) > detector.kForce)
        fast_ = t;
      force = std::abs(felt);
      if (force > kThreshold) return -1;
      if (detector.Update(Vector3(felt, 0, 0), Vector3(v, 0, 0))) return t - fast_;
    }
    return -1;
  }
  double fastest = 0, force = 0;

 private:
  double stiffness_, mass_, spring_, damping_ = 10;
  RandomStream random_;
  double tremor_ = 0, fast_ = -1;
};

// Returns the growth rate λ [1/s], which solves m λ² − (10 − 4) λ − (stiffness − 5) = 0 with the
// values of Hand.
double Growth(double stiffness, double mass) {
  return (3 + std::sqrt(9 + mass * (stiffness - 5))) / mass;
}

// If the motion grows too fast for this detector, the force soon reaches its own threshold.
TEST(Runaway, OfAMirroredSensorIsSeenSoonAfterTheHandleIsFast) {
  int seen = 0;
  for (const double stiffness : {100.0, 200.0, 400.0})
    for (const double mass : {3.0, 6.0, 10.0, 16.0})
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Hand hand(stiffness, mass, 5, seed);
        const double late =
            hand.Run(-1, 8, [](double t) { return 0.1 * MinimumJerk((t - 1) / 3); });
        EXPECT_TRUE(late >= 0 || hand.force > kThreshold) << stiffness << " " << mass;
        const double growth = Growth(stiffness, mass);
        if (growth < RunawayDetector::kMinGrowth + 1 || growth > RunawayDetector::kMaxGrowth - 1)
          continue;
        ++seen;
        EXPECT_GE(late, 0) << stiffness << " " << mass;
        EXPECT_LE(late, 0.110) << stiffness << " " << mass;
        EXPECT_LT(hand.force, 20) << stiffness << " " << mass;
      }
  EXPECT_GE(seen, 25);
}

// While carrying the object, the person pushes as suddenly as people can, up to the force threshold
// and the speed cap.
TEST(Runaway, IsNotASuddenPush) {
  for (const double push : {8.0, 14.0, 20.0})
    for (const double rise : {0.04, 0.06, 0.08, 0.10, 0.12})
      for (const double mass : {3.0, 6.0, 10.0})
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
          Hand hand(250, mass, 5, seed);
          const double at = 1.3 + 0.1 * static_cast<double>(seed);
          const auto intent = [&](double t) {
            const double pushed = MinimumJerk((t - at) / rise) - MinimumJerk((t - at - 0.4) / rise);
            return 0.25 * MinimumJerk((t - 1) / 2) + push / 250 * pushed;
          };
          EXPECT_LT(hand.Run(1, 4, intent), 0)
              << push << " N in " << rise << " s, " << mass << " kg";
        }
}

// The person carries and lifts the object against a spring as briskly as the cap allows.
TEST(Runaway, IsNotAPersonsMotion) {
  for (const double distance : {0.05, 0.1, 0.13, 0.16, 0.25})
    for (const double duration : {0.5, 0.8, 1.0, 1.25, 2.0, 4.0})
      for (const double spring : {5.0, 150.0, 500.0})
        for (const double mass : {3.0, 6.0, 10.0})
          for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            if (distance * 1.875 / duration > kCap) continue;
            Hand hand(250, mass, spring, seed);
            EXPECT_LT(hand.Run(1, 3 + duration,
                               [&](double t) {
                                 return distance * (MinimumJerk((t - 1) / duration) -
                                                    MinimumJerk((t - 2 - duration) / duration));
                               }),
                      0)
                << distance << " m in " << duration << " s, " << spring << " N/m, " << mass
                << " kg";
          }
}

}  // namespace
}  // namespace predictor
