#include "core/sincos.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/random.h"

namespace predictor {
namespace {

constexpr double kError = 2.3e-16;

void ExpectAsTheLibrary(double angle) {
  double sine = 0, cosine = 0;
  SinesAndCosines(&angle, 1, &sine, &cosine);
  EXPECT_NEAR(static_cast<double>(sine - sinl(angle)), 0, kError) << angle;
  EXPECT_NEAR(static_cast<double>(cosine - cosl(angle)), 0, kError) << angle;
}

TEST(SinesAndCosines, AgreeWithTheLibrarysLongOnes) {
  RandomStream random(1, "angles");
  for (const double range : {1e-6, 0.8, 3.2, 20.0, 1e4})
    for (int i = 0; i < 20000; ++i) ExpectAsTheLibrary(range * (2 * random.Uniform() - 1));
}

TEST(SinesAndCosines, AgreeBesideEachEighthOfATurn) {
  for (int k = -200; k <= 200; ++k) {
    const double angle = k * std::atan(1.0);
    for (const double beside : {std::nextafter(angle, -1e9), angle, std::nextafter(angle, 1e9)})
      ExpectAsTheLibrary(beside);
  }
}

// If an angle's sine depended on the other angles, a robot's motion would depend on its number of
// joints.
TEST(SinesAndCosines, DoNotDependOnTheOtherAngles) {
  RandomStream random(2, "angles");
  for (int n = 1; n <= 16; ++n) {
    std::vector<double> angles, sines(16), cosines(16);
    for (int i = 0; i < n; ++i) angles.push_back(20 * random.Uniform() - 10);
    SinesAndCosines(angles.data(), n, sines.data(), cosines.data());
    for (std::size_t i = 0; i < angles.size(); ++i) {
      double sine = 0, cosine = 0;
      SinesAndCosines(&angles[i], 1, &sine, &cosine);
      EXPECT_EQ(sines[i], sine) << n;
      EXPECT_EQ(cosines[i], cosine) << n;
    }
  }
}

TEST(SinesAndCosines, OfNoFiniteAngleAreNoNumbers) {
  for (const double angle : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    double sine = 0, cosine = 0;
    SinesAndCosines(&angle, 1, &sine, &cosine);
    EXPECT_TRUE(std::isnan(sine));
    EXPECT_TRUE(std::isnan(cosine));
  }
}

}  // namespace
}  // namespace predictor
