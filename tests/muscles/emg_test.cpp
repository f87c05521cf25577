#include "muscles/emg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "muscles/arms.h"

namespace predictor::muscles {
namespace {

std::vector<double> Sine(double frequency, double amplitude, double rate, double duration) {
  std::vector<double> values;
  for (int i = 0; i < static_cast<int>(duration * rate); ++i)
    values.push_back(amplitude * std::sin(2 * kPi * frequency * i / rate));
  return values;
}

double Middle(const std::vector<double>& values) { return values[values.size() / 2]; }

// The mean of a rectified sine is 2/π of its amplitude.
TEST(Emg, TheEnvelopeOfASineIsItsRectifiedMean) {
  const auto envelope = EmgEnvelope(Sine(100, 3, 2000, 4), {});
  EXPECT_NEAR(Middle(envelope), 3 * 2 / kPi, 0.02 * 3);
}

// Applied forward and backward, the band-pass has a gain of 1/2 at its edges and suppresses motion
// and offset.
TEST(Emg, TheBandPassRemovesOffsetAndMotion) {
  const auto gain = [](double frequency) {
    return Middle(EmgEnvelope(Sine(frequency, kPi / 2, 4000, 4), {.rate = 4000}));
  };
  EXPECT_NEAR(gain(20), 0.5, 0.02);
  EXPECT_NEAR(gain(450), 0.5, 0.02);
  EXPECT_LT(gain(2), 0.001);
  EXPECT_GT(gain(100), 0.97);
  std::vector<double> offset(4000, 5.0);
  EXPECT_LT(Middle(EmgEnvelope(offset, {})), 1e-9);
}

TEST(Emg, TheShapeBendsTheEnvelope) {
  EXPECT_EQ(ActivationOfEmg(0.4, 0), 0.4);
  EXPECT_EQ(ActivationOfEmg(-0.1, -2), 0);
  EXPECT_EQ(ActivationOfEmg(1.5, -2), 1);
  EXPECT_NEAR(ActivationOfEmg(0.5, -2), (std::exp(-1) - 1) / (std::exp(-2) - 1), 1e-15);
  EXPECT_GT(ActivationOfEmg(0.5, -3), ActivationOfEmg(0.5, -1));
  EXPECT_NEAR(ActivationOfEmg(0.5, -1e-6), 0.5, 1e-6);
}

// A burst of noise begins at 1 s. The activation must reach half of its value 40 ms later.
TEST(Emg, ActivationFollowsABurstWithTheDelay) {
  constexpr double kRate = 2000;
  RandomStream random(1, "emg");
  std::vector<double> raw;
  for (int i = 0; i < 6000; ++i) raw.push_back(i < 2000 ? 0 : 0.5 * random.Normal());
  EmgProcessing processing{.rate = kRate};
  const auto envelope = EmgEnvelope(raw, processing);
  processing.mvc = 2 * envelope[4500];
  processing.shape = 0;
  const auto activation = EmgActivation(raw, processing);
  ASSERT_EQ(activation.size(), raw.size());
  const auto half = std::ranges::find_if(activation, [](double a) { return a > 0.25; });
  EXPECT_NEAR(static_cast<double>(half - activation.begin()) / kRate, 1 + 0.04, 0.02);
  EXPECT_NEAR(activation[4500 + 80], 0.5, 1e-12);
}

TEST(Emg, RefusesImpossibleSettings) {
  const std::vector<double> raw(100, 0.0);
  EXPECT_THROW(EmgEnvelope(raw, {.rate = 800}), InputError);
  EXPECT_THROW(EmgEnvelope(raw, {.band_low = 500}), InputError);
  EXPECT_THROW(EmgEnvelope(raw, {.envelope = 30}), InputError);
  EXPECT_THROW(EmgEnvelope(raw, {.mvc = 0}), InputError);
  EXPECT_TRUE(EmgEnvelope({}, {}).empty());
}

}  // namespace
}  // namespace predictor::muscles
