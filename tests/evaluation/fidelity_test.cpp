// Compares the results with closed forms, with simple second implementations, and with SciPy
// 1.17.1.
#include "evaluation/fidelity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "evaluation/fidelity_perceived.h"
#include "evaluation/fidelity_signals.h"

namespace predictor {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

std::vector<double> Sampled(std::size_t n, const std::function<double(double)>& f) {
  std::vector<double> samples(n);
  for (std::size_t i = 0; i < n; ++i) samples[i] = f(static_cast<double>(i) / kFidelityRate);
  return samples;
}

// ---- phase

TEST(CyclePhase, IsTheAngleOfACircleWhicheverWayItGoes) {
  for (const double sign : {1.0, -1.0}) {
    const auto x = Sampled(3201, [](double t) { return 0.4 + 0.15 * std::cos(kTurn * t / 8); });
    const auto y =
        Sampled(3201, [sign](double t) { return -2 + sign * 0.15 * std::sin(kTurn * t / 8); });
    const auto phase = CyclePhase(x, y);
    for (std::size_t i = 0; i < phase.size(); i += 50)
      EXPECT_NEAR(phase[i], static_cast<double>(i) / 800, 1e-9);
    EXPECT_EQ(CyclesIn(phase), 4u);
  }
}

// The waiting time at the start, the way from the centre to the circle, and a pause on the circle
// must not count.
TEST(CyclePhase, WaitsBeforeAtAndAfterTheCircle) {
  std::vector<double> x, y;
  const auto go = [&](double cx, double cy, int samples) {
    for (int i = 0; i < samples; ++i) x.push_back(cx), y.push_back(cy);
  };
  go(0, 0, 100);
  for (int i = 0; i < 100; ++i) x.push_back(0.002 * i), y.push_back(0);
  go(0.2, 0, 50);
  for (int i = 0; i < 1600; ++i) {
    const double angle = kTurn * i / 800;
    x.push_back(0.2 * std::cos(angle)), y.push_back(0.2 * std::sin(angle));
    if (i == 400) go(x.back(), y.back(), 300);
  }
  go(0.2, 0, 200);
  const auto phase = CyclePhase(x, y);
  EXPECT_EQ(CyclesIn(phase), 2u);
  EXPECT_NEAR(PlaceOfPhase(phase, 0), 250, 1);
  EXPECT_NEAR(PlaceOfPhase(phase, 0.5), 250 + 400 + 300, 2);
  EXPECT_NEAR(PlaceOfPhase(phase, 1), 250 + 800 + 300, 2);
  EXPECT_TRUE(std::is_sorted(phase.begin(), phase.end()));
}

TEST(CyclePhase, NeverGoesBackAndRefusesInvalidPaths) {
  const auto x =
      Sampled(800, [](double t) { return std::cos(kTurn * (t / 4 + 0.1 * std::sin(3 * t))); });
  const auto y =
      Sampled(800, [](double t) { return std::sin(kTurn * (t / 4 + 0.1 * std::sin(3 * t))); });
  const auto phase = CyclePhase(x, y);
  EXPECT_TRUE(std::is_sorted(phase.begin(), phase.end()));
  EXPECT_NEAR(phase.back(), 2, 0.15);
  const std::vector<double> still(100, 0.3);
  EXPECT_EQ(CyclesIn(CyclePhase(still, still)), 0u);
  EXPECT_TRUE(CyclePhase({}, {}).empty());
}

// A cycle must count even if the person lets go shortly before its start point.
TEST(CyclePhase, CountsACycleThatEndsALittleShort) {
  std::vector<double> phase(100);
  for (std::size_t i = 0; i < phase.size(); ++i) phase[i] = 1.985 * static_cast<double>(i) / 99;
  EXPECT_EQ(CyclesIn(phase), 2u);
  phase.back() = phase[98];
  EXPECT_EQ(CyclesIn(std::vector<double>{0, 0.5, 1.97}), 1u);
  const std::vector<double> ramp = phase;
  const auto cut = CutCycle(ramp, phase, 1, 100);  // holds the last value
  EXPECT_NEAR(cut[98], phase[98], 1e-12);
}

TEST(CutCycle, TakesASignalByThePhaseNotByTheTime) {
  // The second cycle is twice as fast as the first cycle. The signal depends only on the phase.
  const auto turns = [](double t) { return t < 4 ? t / 4 : 1 + (t - 4) / 2; };
  const auto phase = Sampled(601, turns);
  const auto signal = Sampled(601, [&](double t) { return std::sin(kTurn * turns(t)); });
  const auto first = CutCycle(signal, phase, 0, 100), second = CutCycle(signal, phase, 1, 100);
  for (std::size_t k = 0; k < 100; ++k) {
    const double expected = std::sin(kTurn * static_cast<double>(k) / 100);
    EXPECT_NEAR(first[k], expected, 1e-4);
    EXPECT_NEAR(second[k], expected, 5e-4);
  }
}

// ---- comparison of two signals

TEST(LagOf, FindsAShiftBetweenSamples) {
  const auto bump = [](double t) { return std::exp(-(t - 4) * (t - 4)) + 0.3 * std::sin(2 * t); };
  for (const double shift : {0.0, 0.043, -0.107, 0.5}) {
    const auto a = Sampled(1000, bump),
               b = Sampled(1000, [&](double t) { return bump(t - shift); });
    const Lag lag = LagOf(a, b, 100);
    EXPECT_NEAR(lag.samples / kFidelityRate, shift, 2e-4) << shift;
    EXPECT_GT(lag.correlation, 0.9999);
  }
  const std::vector<double> flat(100, 1);
  EXPECT_TRUE(std::isnan(LagOf(flat, flat, 10).correlation));
}

// Computes the distance by its definition, as the minimum over all paths, without a table.
double WarpedByAllPaths(const std::vector<double>& a, const std::vector<double>& b, std::size_t i,
                        std::size_t j) {
  const double here = std::abs(a[i] - b[j]);
  if (i == 0 && j == 0) return here;
  double best = std::numeric_limits<double>::infinity();
  if (i > 0) best = std::min(best, WarpedByAllPaths(a, b, i - 1, j));
  if (j > 0) best = std::min(best, WarpedByAllPaths(a, b, i, j - 1));
  if (i > 0 && j > 0) best = std::min(best, WarpedByAllPaths(a, b, i - 1, j - 1));
  return here + best;
}

TEST(WarpedDistance, IsTheLeastOverAllPaths) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  for (int round = 0; round < 30; ++round) {
    std::vector<double> a(1 + random() % 7), b(1 + random() % 7);
    for (double& x : a) x = noise(random);
    for (double& x : b) x = noise(random);
    const double longer = static_cast<double>(std::max(a.size(), b.size()));
    EXPECT_NEAR(WarpedDistance(a, b, 1),
                WarpedByAllPaths(a, b, a.size() - 1, b.size() - 1) / longer, 1e-12);
  }
}

TEST(WarpedDistance, StaysInItsBandAndForgivesWhatFits) {
  // A delayed step must not contribute to the distance while the delay is within the band, but a
  // longer delay must.
  std::vector<double> a(100, 0.0), late(100, 0.0), later(100, 0.0);
  std::fill(a.begin() + 40, a.end(), 1.0);
  std::fill(late.begin() + 49, late.end(), 1.0);
  std::fill(later.begin() + 60, later.end(), 1.0);
  EXPECT_EQ(WarpedDistance(a, late, 0.1), 0);
  EXPECT_DOUBLE_EQ(WarpedDistance(a, later, 0.1), 10.0 / 100);
  EXPECT_DOUBLE_EQ(RootMeanSquareError(a, later), std::sqrt(0.2));
  EXPECT_DOUBLE_EQ(WarpedDistance(a, a), 0);
  EXPECT_TRUE(std::isnan(WarpedDistance(a, {})));
}

TEST(Coherence, IsThatOfScipyAtEachFrequency) {
  // `a` is the output of a linear congruential generator. `b` is `a` delayed by two samples, plus
  // independent noise of the same size.
  std::vector<double> a, b, other;
  std::uint64_t state = 12345;
  const auto draw = [&] {
    state = (state * 1103515245 + 12345) % 2147483648u;
    return static_cast<double>(state) / 2147483648.0 - 0.5;
  };
  for (int i = 0; i < 400; ++i) a.push_back(draw()), other.push_back(draw());
  for (std::size_t i = 0; i < 400; ++i) b.push_back(a[i < 2 ? 0 : i - 2] + other[i]);
  // The expected value is from scipy.signal.csd(window="hann", nperseg=40, detrend="constant"):
  // |Sab|²/(Saa Sbb) of bins 1 to 6 (0 < f ≤ 15 at 100 Hz), averaged with the weights √(Saa Sbb).
  const Coherence coherence = CoherenceOf(a, b, 100, 40, 15);
  EXPECT_EQ(coherence.segments, 19u);
  EXPECT_NEAR(coherence.mean, 0.5704597717406317, 1e-12);
}

TEST(Coherence, IsOneOfAFilteredAndSmallOfUnrelatedSignals) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise;
  std::vector<double> a(8000), b(8000), unrelated(8000);
  for (double& x : a) x = noise(random);
  for (double& x : unrelated) x = noise(random);
  for (std::size_t i = 1; i < a.size(); ++i) b[i] = 3 * a[i] - a[i - 1];
  EXPECT_GT(CoherenceOf(a, b, 100, 400, 3).mean, 0.999);
  const Coherence chance = CoherenceOf(a, unrelated, 100, 400, 3);
  EXPECT_LT(chance.mean, chance.chance);
  EXPECT_NEAR(chance.chance, 1 - std::pow(0.05, 1.0 / 19), 1e-12);
  EXPECT_TRUE(std::isnan(CoherenceOf(a, b, 100, 8000, 3).mean));  // a single segment always gives 1
}

TEST(Repeats, AreComparedByTheirMeanSquares) {
  // For these constant series, the squared distances were computed by hand. They are 4 within a, 0
  // within b, and 9 and 1 between the sets.
  const std::vector<std::vector<double>> a = {{0, 0}, {2, 2}}, b = {{3, 3}, {3, 3}};
  const RepeatComparison c = CompareRepeats(a, b);
  EXPECT_DOUBLE_EQ(c.within, std::sqrt((4 + 0) / 2.0));
  EXPECT_DOUBLE_EQ(c.between, std::sqrt((9 + 1) / 2.0));
  EXPECT_DOUBLE_EQ(c.ratio, std::sqrt(5.0 / 2));
  EXPECT_TRUE(std::isnan(CompareRepeats({{1, 2}}, {{1, 2}}).ratio));
}

TEST(Repeats, OfOneKindHaveARatioOfOne) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise;
  const auto draw = [&](double offset) {
    std::vector<std::vector<double>> set(17, std::vector<double>(400));
    for (auto& one : set)
      for (double& x : one) x = offset + noise(random);
    return set;
  };
  // The standard error is 0.01. The means of the sets vary by ±0.017, which changes 2² by ±0.07.
  EXPECT_NEAR(CompareRepeats(draw(0), draw(0)).ratio, 1, 0.01);
  EXPECT_NEAR(CompareRepeats(draw(0), draw(2)).ratio, std::sqrt(3.0), 0.04);  // (2 + 2²) / 2
}

// ---- impedance

TEST(Impedance, IsIdentifiedIfTheMotionAllows) {
  const auto x = [](double t) { return 0.1 * std::sin(1.3 * t) + 0.03 * std::sin(4.1 * t + 1); };
  const auto v = [](double t) { return 0.13 * std::cos(1.3 * t) + 0.123 * std::cos(4.1 * t + 1); };
  const auto a = [](double t) {
    return -0.169 * std::sin(1.3 * t) - 0.5043 * std::sin(4.1 * t + 1);
  };
  const auto position = Sampled(1000, x);
  const auto force =
      Sampled(1000, [&](double t) { return 2.1 * a(t) + 14.5 * v(t) + 5 * x(t) + 7; });
  const ApparentImpedance found = FitImpedance(position, force);
  // The sums over forty samples differ from the integrals by a few parts per million.
  EXPECT_NEAR(found.mass, 2.1, 1e-4);
  EXPECT_NEAR(found.viscosity, 14.5, 1e-4);
  EXPECT_NEAR(found.stiffness, 5, 1e-4);
  EXPECT_GT(found.separable, kSeparable);
}

TEST(Impedance, OfOneSineCannotSeparateMassFromStiffness) {
  const double w = kTurn / 8;
  const auto position = Sampled(1600, [w](double t) { return 0.15 * std::sin(w * t); });
  const auto force = Sampled(1600, [w](double t) {
    return (5 - 2.1 * w * w) * 0.15 * std::sin(w * t) + 14.5 * 0.15 * w * std::cos(w * t);
  });
  const ApparentImpedance found = FitImpedance(position, force);
  EXPECT_LT(found.separable, kSeparable);
  EXPECT_EQ(found.mass, 0);
  EXPECT_NEAR(found.viscosity, 14.5, 1e-4);
  EXPECT_NEAR(found.stiffness, 5 - 2.1 * w * w, 1e-4);
  EXPECT_TRUE(std::isnan(FitImpedance(std::vector<double>(500, 0.2), force).viscosity));
  EXPECT_TRUE(std::isnan(FitImpedance({}, {}).viscosity));
}

// If the person only yields, the force is the reaction of the hand itself, F = −(mass a + …). This
// force contains no information about the object.
TEST(Impedance, IsNotReportedForAnAxisWithoutMotion) {
  const auto position = Sampled(1000, [](double t) { return 1e-3 * std::sin(2 * t); });
  const auto force = Sampled(1000, [](double t) { return -0.6 * std::sin(2 * t); });
  EXPECT_TRUE(std::isnan(FitImpedance(position, force).stiffness));
}

TEST(Perceived, IsJudgedByTheJustNoticeableDifferenceAndItsOwnError) {
  const auto judge = [](double b, double error) {
    PerceivedQuantity q;
    q.a = 10, q.b = b, q.error_a = q.error_b = error;
    q.jnd = {0.07, 0.10};
    return Perceive(q);
  };
  // With a = 10, the intervals are 5 ± 1.2 %, 6 ± 11 %, 6 ± 2.4 %, 12 ± 3.7 % and 20 ± 2.6 %.
  EXPECT_EQ(judge(10.5, 0.05).noticed, Noticed::kNo);
  EXPECT_EQ(judge(10.6, 0.46).noticed, Noticed::kUndecided);
  EXPECT_EQ(judge(10.6, 0.1).noticed, Noticed::kPerhaps);
  EXPECT_EQ(judge(11.2, 0.15).noticed, Noticed::kPerhaps);
  EXPECT_EQ(judge(12, 0.1).noticed, Noticed::kYes);
  EXPECT_NEAR(judge(12, 0.1).difference, 0.2, 1e-12);
  EXPECT_NEAR(judge(12, 0.1).error, std::hypot(0.12, 0.1) / 10, 1e-12);
  EXPECT_EQ(judge(std::nan(""), 0.1).noticed, Noticed::kUndecided);
}

// ---- whole runs

struct Task {
  double period = 8, cycles = 4, start = 1, viscosity = 14.5, noise = 0;
  unsigned seed = 1;
  int hands = 2;
};

// Calls `visit` with each record at 1 kHz of two hands that lead E around a circle through a
// viscous medium. The records are not stored, because a whole run would occupy a hundred megabytes.
template <class Visit>
void Record(const Task& task, const Visit& visit) {
  std::mt19937 random(task.seed);
  std::normal_distribution<double> noise;
  const int ticks = static_cast<int>(1e3 * (task.start + task.cycles * task.period));
  double shake = 0;  // a fast disturbance would be removed by averaging, so this one is slow
  for (int i = 0; i < ticks; ++i) {
    TickRecord record{};
    record.ran = 1;
    record.run_time = 1e-3 * i;
    const double t = std::max(0.0, record.run_time - task.start), w = kTurn / task.period;
    const double angle = w * t, speed = t > 0 ? 0.15 * w : 0;
    record.end_effector.pose.p = {0.15 * std::cos(angle), 0.15 * std::sin(angle), 0.3};
    shake += 1e-3 * (-shake / 0.5) + task.noise * std::sqrt(2e-3 / 0.5) * noise(random);
    for (int h = 0; h < task.hands; ++h) {
      HandRecord& hand = record.hands[static_cast<std::size_t>(h)];
      hand.present = 1;
      const double share = 1.0 / task.hands;
      hand.wrench = {share * -task.viscosity * speed * std::sin(angle) + shake,
                     share * task.viscosity * speed * std::cos(angle),
                     0.5,
                     0,
                     0,
                     0};
    }
    visit(record);
  }
}

std::vector<TickRecord> Records(const Task& task) {
  std::vector<TickRecord> records;
  Record(task, [&](const TickRecord& record) { records.push_back(record); });
  return records;
}

FidelitySignals SignalsOf(const std::vector<TickRecord>& records) {
  FidelityCollector collector;
  for (const TickRecord& record : records) collector.Add(record);
  return collector.signals();
}

FidelitySignals SignalsOf(const Task& task) {
  FidelityCollector collector;
  Record(task, [&](const TickRecord& record) { collector.Add(record); });
  return collector.signals();
}

const ChannelFidelity& Channel(const FidelityReport& report, const std::string& name) {
  for (const ChannelFidelity& channel : report.channels)
    if (channel.name == name) return channel;
  throw std::runtime_error(name);
}

const PerceivedQuantity& PerceivedNamed(const FidelityReport& report, const std::string& name) {
  for (const PerceivedQuantity& quantity : report.perceived)
    if (quantity.name == name) return quantity;
  throw std::runtime_error(name);
}

TEST(FidelityCollector, AveragesStepsAndFillsGaps) {
  std::vector<TickRecord> records = Records({.period = 2, .cycles = 1, .start = 0});
  const FidelitySignals whole = SignalsOf(records);
  ASSERT_EQ(whole.channels.size(), 9u);
  ASSERT_EQ(whole.channels[0].samples.size(), 200u);
  EXPECT_EQ(whole.channels[0].name, "position x");
  EXPECT_EQ(whole.channels[8].name, "right force z");
  double mean = 0;
  for (int i = 70; i < 80; ++i) mean += 0.015 * std::cos(kTurn * 1e-3 * i / 2);
  EXPECT_NEAR(whole.channels[0].samples[7], mean, 1e-12);
  EXPECT_EQ(whole.filled, 0u);
  records.erase(records.begin() + 500, records.begin() + 530);  // three steps are missing
  records[10].ran = 0;                                          // must be ignored
  const FidelitySignals cut = SignalsOf(records);
  EXPECT_EQ(cut.filled, 3u);
  ASSERT_EQ(cut.channels[0].samples.size(), 200u);
  const auto& x = cut.channels[0].samples;
  EXPECT_NEAR(x[50] - x[49], (x[53] - x[49]) / 4, 1e-12);
  EXPECT_NEAR(x[52] - x[49], 3 * (x[53] - x[49]) / 4, 1e-12);
}

// The times come from a file, so large times must not increase the memory use.
TEST(FidelityCollector, RefusesTimesThatCannotBe) {
  std::vector<TickRecord> records = Records({.period = 2, .cycles = 1, .start = 0});
  for (const double time : {HUGE_VAL, 1e300, 1e7}) {
    records.back().run_time = time;
    EXPECT_THROW(SignalsOf(records), InputError) << time;
  }
  records.back().run_time = std::nan("");
  EXPECT_EQ(SignalsOf(records).channels[0].samples.size(), 200u);
  records.back().run_time = 5 * 3600;  // a single gap of five hours
  EXPECT_EQ(SignalsOf(records).channels[0].samples.size(), 5u * 3600 * 100 + 1);
}

TEST(FidelityCollector, StartsAgainWithTheRunAndKnowsOneHand) {
  std::vector<TickRecord> records = Records({.period = 2, .cycles = 2});
  const auto again = Records({.period = 2, .cycles = 1, .start = 0, .hands = 1});
  records.insert(records.end(), again.begin(), again.end());
  const FidelitySignals signals = SignalsOf(records);
  EXPECT_EQ(signals.channels.size(), 6u);
  EXPECT_EQ(signals.channels[0].samples.size(), 200u);
  EXPECT_TRUE(FidelityCollector().signals().channels[0].samples.empty());
}

TEST(Fidelity, OfARunWithItselfIsPerfect) {
  const std::vector<FidelitySignals> run = {SignalsOf(Task{.noise = 0.2})};
  const FidelityReport report = CompareFidelity(run, run);
  EXPECT_TRUE(report.by_phase);
  EXPECT_EQ(report.cycles, 4u);
  EXPECT_NEAR(report.period_a, 8, 0.02);
  for (const ChannelFidelity& channel : report.channels) {
    EXPECT_EQ(channel.rmse, 0) << channel.name;
    EXPECT_EQ(channel.warped, 0);
    if (channel.range < 1e-9) continue;  // z is constant
    EXPECT_NEAR(channel.correlation, 1, 1e-12);
    EXPECT_EQ(channel.lag, 0);
    EXPECT_NEAR(channel.coherence.mean, 1, 1e-9);
  }
}

// Alignment by phase removes differences in speed and start time. The force is proportional to the
// speed.
TEST(Fidelity, IsAlignedByThePhaseOfTheCycle) {
  const std::vector<FidelitySignals> a = {SignalsOf(Task{.period = 8})},
                                     b = {SignalsOf(Task{.period = 10, .start = 3})};
  const FidelityReport report = CompareFidelity(a, b);
  EXPECT_NEAR(report.period_a, 8, 0.02);
  EXPECT_NEAR(report.period_b, 10, 0.02);
  EXPECT_LT(Channel(report, "position x").rmse, 1e-3);
  const ChannelFidelity& force = Channel(report, "left force y");
  const double amplitude = 14.5 * 0.15 * kTurn / 8 / 2;
  EXPECT_NEAR(force.correlation, 1, 1e-3);
  EXPECT_NEAR(force.std_b / force.std_a, 8.0 / 10, 0.01);
  EXPECT_NEAR(force.peak_a, amplitude, 0.01 * amplitude);
  EXPECT_NEAR(force.rmse, 0.2 * amplitude / std::numbers::sqrt2, 0.02 * amplitude);
  EXPECT_NEAR(force.relative_rmse, 0.1 / std::numbers::sqrt2, 0.01);
  // If the two runs are aligned by time, they differ considerably.
  EXPECT_GT(Channel(CompareFidelity(a, b, false), "position x").rmse, 0.05);
}

// The paper found that the real cobot resists motion more than the emulated one. The comparison
// quantifies this difference.
TEST(Fidelity, NamesTheViscosityThatIsMissing) {
  const std::vector<FidelitySignals> real = {SignalsOf(Task{.viscosity = 29, .noise = 0.05})},
                                     emulated = {SignalsOf(
                                         Task{.viscosity = 14.5, .noise = 0.05, .seed = 2})};
  const FidelityReport report = CompareFidelity(real, emulated);
  const PerceivedQuantity& viscosity = PerceivedNamed(report, "viscosity y");
  EXPECT_NEAR(viscosity.a, 29, 0.3);
  EXPECT_NEAR(viscosity.b, 14.5, 0.3);
  EXPECT_NEAR(viscosity.difference, -0.5, 0.02);
  EXPECT_EQ(viscosity.noticed, Noticed::kYes);
  EXPECT_GT(Channel(report, "left force y").repeats.ratio, 2);
  const FidelityReport same = CompareFidelity(real, real);
  EXPECT_EQ(PerceivedNamed(same, "viscosity y").noticed, Noticed::kNo);
}

// Runs of the same kind with different random draws must differ about as much as the repeats of one
// kind.
TEST(Fidelity, OfTheSameKindLiesWithinTheRepeats) {
  std::vector<FidelitySignals> a, b;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    a.push_back(SignalsOf(Task{.period = 4, .noise = 0.3, .seed = seed}));
    b.push_back(SignalsOf(Task{.period = 4, .noise = 0.3, .seed = 100 + seed}));
  }
  const FidelityReport report = CompareFidelity(a, b);
  EXPECT_EQ(report.repeats_a, 24u);
  EXPECT_NEAR(Channel(report, "left force x").repeats.ratio, 1, 0.1);
}

TEST(Fidelity, RefusesWhatCannotBeCompared) {
  const std::vector<FidelitySignals> run = {SignalsOf(Task{.period = 2})}, none,
                                     brief = {SignalsOf(Task{.period = 0.1, .start = 0})};
  EXPECT_THROW(CompareFidelity(run, none), InputError);
  EXPECT_THROW(CompareFidelity(run, brief), InputError);
  std::vector<FidelitySignals> other = run;
  for (FidelityChannel& channel : other[0].channels) channel.name += " of something else";
  EXPECT_THROW(CompareFidelity(run, other), InputError);
  std::vector<FidelitySignals> still = run;
  std::fill(still[0].path_x.begin(), still[0].path_x.end(), 0);
  std::fill(still[0].path_y.begin(), still[0].path_y.end(), 0);
  EXPECT_FALSE(CompareFidelity(run, still).by_phase);
  EXPECT_THROW(CompareFidelity(run, still, true), InputError);
}

TEST(Fidelity, IsDescribedInWords) {
  const std::vector<FidelitySignals> a = {SignalsOf(Task{.noise = 0.1})},
                                     b = {
                                         SignalsOf(Task{.viscosity = 30, .noise = 0.1, .seed = 3})};
  const std::string text = FidelityText(CompareFidelity(a, b), "real", "emulated");
  EXPECT_NE(text.find("real (a) against emulated (b): 4 cycles by phase"), std::string::npos)
      << text;
  EXPECT_NE(text.find("left force y"), std::string::npos);
  EXPECT_NE(text.find("viscosity y"), std::string::npos);
  EXPECT_NE(text.find("noticeable"), std::string::npos);
  EXPECT_EQ(text.find("Warning"), std::string::npos) << text;
}

// If the runs are aligned by time, each run gives a single value, whose error is unknown.
TEST(Fidelity, WarnsWhereErrorsAreNotKnown) {
  const std::vector<FidelitySignals> a = {SignalsOf(Task{.noise = 0.1})},
                                     b = {SignalsOf(Task{.viscosity = 30, .noise = 0.1})};
  const FidelityReport report = CompareFidelity(a, b, false);
  ASSERT_EQ(report.warnings.size(), 1u);
  const std::string text = FidelityText(report, "real", "emulated");
  EXPECT_NE(text.find("Warning: A run has fewer than two cycles"), std::string::npos) << text;
  EXPECT_NE(text.find("noticeable, error unknown"), std::string::npos) << text;
  EXPECT_NE(FidelityJson(report, "a", "b").find("fewer than two cycles"), text.npos);
  EXPECT_TRUE(CompareFidelity(a, b).warnings.empty());
}

}  // namespace
}  // namespace predictor
