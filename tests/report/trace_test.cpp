// Tests which samples of a long run are kept, and that their values survive the encoding in a page.
#include "report/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "report/page.h"

namespace predictor {
namespace {

float Saw(std::uint64_t tick) { return static_cast<float>(tick % 977) - 300; }

TEST(Trace, KeepsTheExtremesOfEachBin) {
  Trace trace(2, 0.001, 1e6);
  for (std::uint64_t tick = 100; tick < 2350; ++tick) {
    const float values[] = {Saw(tick), tick == 1234 ? 1e6F : std::nanf("")};
    trace.Add(tick, values);
  }
  trace.Finish();
  const Samples t = trace.Times(100), y = trace.Values(0), spike = trace.Values(1);
  ASSERT_EQ(t->size(), y->size());
  for (std::size_t i = 0; i + 1 < t->size(); i += 2) {
    double low = INFINITY, high = -INFINITY;
    const auto bin = static_cast<std::uint64_t>(std::lround(((*t)[i] + 0.1) * 1000 - 12.5));
    for (std::uint64_t tick = bin; tick < bin + 50; ++tick) {
      if (tick < 100 || tick >= 2350) continue;
      low = std::min(low, static_cast<double>(Saw(tick)));
      high = std::max(high, static_cast<double>(Saw(tick)));
    }
    if (low > high) {
      EXPECT_TRUE(std::isnan((*y)[i]));
      continue;
    }
    EXPECT_EQ(std::min((*y)[i], (*y)[i + 1]), low) << bin;
    EXPECT_EQ(std::max((*y)[i], (*y)[i + 1]), high) << bin;
    const bool there = bin <= 1234 && 1234 < bin + 50;
    EXPECT_EQ((*spike)[i] == 1e6, there) << bin;
  }
  EXPECT_TRUE(trace.complete());
}

TEST(Trace, OfALongRunKeepsEveryTickWhereItMattersAndNoMore) {
  constexpr double kDetail = 60;
  Trace trace(1, 0.001, kDetail);
  std::size_t worst = 0;
  for (std::uint64_t tick = 0; tick < 600'000; ++tick) {
    const float value = Saw(tick);
    if (tick == 30'000) trace.Keep({tick, 10, 2, 0, "stop"});
    if (tick == 100'000) worst = trace.Keep({tick, 5, 5, 1, "worst"});
    if (tick == 400'000) trace.Move(worst, tick);
    trace.Add(tick, &value);
  }
  trace.Finish();
  EXPECT_FALSE(trace.complete());
  EXPECT_LE(trace.detail_seconds(), kDetail);
  std::vector<double> t, y;
  trace.Part(20'000, 32'000, 0, 0, &t, &y);
  EXPECT_EQ(t.size(), 12'001u);
  for (std::size_t i = 0; i < t.size(); ++i)
    ASSERT_EQ(y[i], Saw(static_cast<std::uint64_t>(std::lround(1000 * t[i]))));
  t.clear();
  y.clear();
  trace.Part(395'000, 405'000, 0, 0, &t, &y);
  EXPECT_EQ(t.size(), 10'001u);
  t.clear();
  y.clear();
  trace.Part(100'000, 101'000, 0, 0, &t, &y);  // this part no longer has the worst value
  EXPECT_TRUE(t.empty());
  // The coarse line is complete, and each part of the detail has its own times.
  EXPECT_EQ(trace.Times(0)->size(), 2u * 20 * 600);
  EXPECT_EQ(trace.DetailTimes(0)->size(), trace.DetailValues(0)->size());
}

// The run has one tick per second and no ticks in between. The memory must depend on the number of
// seconds, not on the number of ticks.
TEST(Trace, OfTicksFarApartIsRefusedBeforeItFillsTheMemory) {
  Trace trace(1, 0.001, 60);
  const float value = 1;
  std::uint64_t tick = 0;
  EXPECT_THROW(for (; tick < 100'000'000; tick += 1000) trace.Add(tick, &value), InputError);
  EXPECT_GE(tick, 8U * 3600 * 1000);
  EXPECT_LT(tick, 9U * 3600 * 1000);
}

TEST(Trace, BreaksLinesWhereTicksAreMissing) {
  Trace trace(1, 0.001, 1e6);
  for (const std::uint64_t tick : {0ULL, 1ULL, 999ULL, 50'000ULL, 10'000'000'000ULL}) {
    const float value = 1;
    trace.Add(tick, &value);
  }
  trace.Finish();
  const Samples t = trace.Times(0), y = trace.Values(0);
  ASSERT_EQ(t->size(), y->size());
  EXPECT_EQ(t->size(), 3u * 40 + 2);  // each of the two gaps adds one point
  EXPECT_TRUE(std::isnan((*y)[40]));
  for (std::size_t i = 1; i < t->size(); ++i) EXPECT_GE((*t)[i], (*t)[i - 1]);
}

std::vector<double> Decode(const std::string& bytes, double step) {
  std::vector<double> values;
  std::int64_t last = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint64_t code = 0;
    unsigned shift = 0;
    std::uint8_t byte = 0;
    do {
      byte = static_cast<std::uint8_t>(bytes[at++]);
      code |= static_cast<std::uint64_t>(byte & 127U) << shift;
      shift += 7;
    } while (byte >= 128);
    if (code == 0) {
      values.push_back(NAN);
      continue;
    }
    --code;
    last += static_cast<std::int64_t>(code >> 1U) ^ -static_cast<std::int64_t>(code & 1U);
    values.push_back(static_cast<double>(last) * step);
  }
  return values;
}

TEST(Encode, DecodesToWithinHalfAStep) {
  std::mt19937 random(1);
  std::normal_distribution<double> walk(0, 3);
  std::vector<double> values;
  double x = 0;
  for (int i = 0; i < 10'000; ++i) values.push_back(i % 97 == 0 ? NAN : x += walk(random));
  values.push_back(1e12);
  values.push_back(-1e12);
  const std::vector<double> back = Decode(EncodeSteps(values, 0.01), 0.01);
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) {
      EXPECT_TRUE(std::isnan(back[i]));
    } else {
      EXPECT_NEAR(back[i], values[i], 0.005 + 1e-3 * (std::abs(values[i]) > 1e9)) << i;
    }
  }
}

TEST(Encode, Base64IsThatOfTheRfc) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace predictor
