#include "rig/random_process.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace predictor {
namespace {

struct Moments {
  double mean, deviation;
};

Moments Of(const std::vector<double>& x) {
  double mean = 0, square = 0;
  for (const double value : x) mean += value;
  mean /= static_cast<double>(x.size());
  for (const double value : x) square += (value - mean) * (value - mean);
  return {mean, std::sqrt(square / static_cast<double>(x.size()))};
}

double Correlation(const std::vector<double>& x, std::size_t lag) {
  double sum = 0, square = 0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) sum += x[i] * x[i + lag];
  for (const double value : x) square += value * value;
  return sum / square;
}

TEST(OrnsteinUhlenbeck, IsStationaryWithUnitDeviationAndExponentialCorrelation) {
  for (const double dt : {0.001, 0.01}) {
    const double time_constant = 0.1;
    OrnsteinUhlenbeck process(time_constant, RandomStream(7, "ou"));
    std::vector<double> x(1000000);
    for (double& value : x) value = process.Step(dt);
    // About n dt / (2 τ) samples are independent. This number is 5000 for the smaller dt and 50000
    // for the larger one. The tolerance is four standard errors.
    const double independent = static_cast<double>(x.size()) * dt / (2 * time_constant);
    EXPECT_NEAR(Of(x).mean, 0, 4 / std::sqrt(independent));
    EXPECT_NEAR(Of(x).deviation, 1, 4 / std::sqrt(2 * independent));
    for (const double t : {0.05, 0.1, 0.2}) {
      const auto lag = static_cast<std::size_t>(std::lround(t / dt));
      EXPECT_NEAR(Correlation(x, lag), std::exp(-t / time_constant), 6 / std::sqrt(independent));
    }
  }
}

TEST(OrnsteinUhlenbeck, StartsInItsStationaryDistribution) {
  double square = 0;
  const int n = 4000;
  for (int seed = 0; seed < n; ++seed) {
    OrnsteinUhlenbeck process(1.0, RandomStream(static_cast<std::uint64_t>(seed), "ou"));
    const double x = process.Step(0.001);
    square += x * x / n;
  }
  EXPECT_NEAR(square, 1, 4 * std::sqrt(2.0 / n));
}

TEST(NarrowBandNoise, HasUnitDeviationAndItsPowerAtItsFrequency) {
  const double dt = 0.001, time_constant = 0.5;
  NarrowBandNoise noise(10, time_constant, RandomStream(1, "tremor"));
  std::vector<double> x(1000000);
  for (double& value : x) value = noise.Step(dt);
  const double independent = static_cast<double>(x.size()) * dt / (2 * time_constant);
  EXPECT_NEAR(Of(x).deviation, 1, 4 / std::sqrt(2 * independent));
  EXPECT_NEAR(Correlation(x, 100), std::exp(-0.1 / time_constant), 0.05);   // a period of 10 Hz
  EXPECT_NEAR(Correlation(x, 50), -std::exp(-0.05 / time_constant), 0.05);  // half a period
}

}  // namespace
}  // namespace predictor
