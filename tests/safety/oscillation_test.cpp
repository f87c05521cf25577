#include "safety/oscillation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/minimum_jerk.h"
#include "core/random.h"
#include "safety/alarm.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor {
namespace {

// Simulates the disturbances by a sensor and a person's hand: white noise of 0.05 N, and tremor at
// about 10 Hz (rms in N).
class Disturbance {
 public:
  Disturbance(std::uint64_t seed, double tremor) : random_(seed, "disturbance"), tremor_(tremor) {
    phase_ = 2 * kPi * random_.Uniform();
  }
  double Next() {
    wander_ += -2 * kDt * wander_ + 0.02 * random_.Normal();
    phase_ += 2 * kPi * kDt * (10 + 0.5 * wander_);
    return 0.05 * random_.Normal() + tremor_ * std::numbers::sqrt2 * std::sin(phase_);
  }

 private:
  RandomStream random_;
  double tremor_, wander_ = 0, phase_ = 0;
};

// Returns the first alarm for force(t), t in [0, duration), along `axis`. If a seed is given, the
// function adds a disturbance.
template <class Force>
Alarm FirstAlarm(const Force& force, double duration, std::uint64_t seed = 0, int axis = 0,
                 double tremor = 0.1) {
  OscillationDetector detector(OscillationSpec{}, kDt);
  Disturbance disturbance(seed, tremor);
  for (int k = 0; k * kDt < duration; ++k) {
    Vector3 f = Vector3::Zero();
    f[axis] = force(k * kDt);
    if (seed) {
      for (int i = 0; i < 3; ++i) f[i] += disturbance.Next();
    }
    const double amplitude = detector.Update(f);
    if (amplitude > 0) return {k * kDt, amplitude};
  }
  return {};
}

// A sine with an initial amplitude of 0.3 N that grows by the factor `growth` in each cycle.
struct GrowingSine {
  double frequency, growth, phase;
  double Amplitude(double t) const { return 0.3 * std::pow(growth, frequency * t); }
  double operator()(double t) const {
    return Amplitude(t) * std::sin(2 * kPi * frequency * t + phase);
  }
  double TimeOf(double amplitude) const {
    return std::log(amplitude / 0.3) / std::log(growth) / frequency;
  }
};

constexpr double kFrequencies[] = {0.5, 0.73, 0.92, 1.4, 2.5, 4.0, 6.5, 8.0};

// The cycle in which the amplitude reaches 2 N ends at most one period later. If the amplitude
// grows slowly, this cycle is the third growing one. The amplitude in the middle of this cycle
// differs from the amplitude at its end by less than one cycle's growth.
TEST(Oscillation, GrowingSineIsFoundInTheCycleThatReachesTheAmplitude) {
  for (const double frequency : kFrequencies) {
    for (const double growth : {1.05, 1.1, 1.2}) {
      for (int phase = 0; phase < 4; ++phase) {
        const GrowingSine sine{frequency, growth, phase * kPi / 2};
        const Alarm alarm = FirstAlarm(sine, sine.TimeOf(2) + 4 / frequency, 0, phase % 3);
        SCOPED_TRACE(testing::Message() << frequency << " Hz, growth " << growth);
        ASSERT_GE(alarm.time, sine.TimeOf(2));
        EXPECT_LE(alarm.time, sine.TimeOf(2) + 2 / frequency);
        EXPECT_GE(alarm.amplitude, 2);
        EXPECT_LE(alarm.amplitude, sine.Amplitude(alarm.time));
        EXPECT_GE(alarm.amplitude, sine.Amplitude(alarm.time - 1.1 / frequency));
      }
    }
  }
}

// The alarm must come before the force itself would stop the run at 30 N. A sine that doubles in
// each cycle is excluded, because there are hardly four cycles between the tremor and 30 N.
TEST(Oscillation, GrowingSineIsFoundInNoiseAndTremorSoak) {
  for (const double frequency : kFrequencies) {
    for (const double growth : {1.05, 1.2, 1.5}) {
      for (long seed = 1; seed <= Count(4, 200); ++seed) {
        const GrowingSine sine{frequency, growth, 0.7 * static_cast<double>(seed)};
        const Alarm alarm = FirstAlarm(sine, sine.TimeOf(29), static_cast<std::uint64_t>(seed),
                                       static_cast<int>(seed % 3));
        SCOPED_TRACE(testing::Message() << frequency << " Hz, growth " << growth << ", " << seed);
        ASSERT_GE(alarm.time, 0);
        // Tremor at 10 Hz interferes with nearby frequencies and may hide a growth of 5 % for a
        // while.
        const double late = frequency > 6 ? 8 : 2.8;
        if (growth < 1.2) {
          EXPECT_LE(sine.Amplitude(alarm.time), late);
        }
      }
    }
  }
}

// If the sine is large from the start, the first cycle serves for comparison. The third cycle that
// exceeds its predecessor must raise the alarm.
TEST(Oscillation, AlarmIsAtTheThirdGrowingCycle) {
  for (const double frequency : kFrequencies) {
    const auto force = [&](double t) {
      return 4 * std::pow(1.3, frequency * t) * std::sin(2 * kPi * frequency * t);
    };
    // The peaks are at 0.25, ..., 4.25 cycles, and the last one is detected before the trough after
    // it.
    const double cycles = FirstAlarm(force, 10 / frequency).time * frequency;
    EXPECT_GT(cycles, 4.2) << frequency;
    EXPECT_LT(cycles, 4.95) << frequency;
  }
}

TEST(Oscillation, StrongTremorDoesNotHideASlowOscillation) {
  for (const double frequency : {0.5, 0.92}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const GrowingSine sine{frequency, 1.05, 0.7 * static_cast<double>(seed)};
      const Alarm alarm = FirstAlarm(sine, sine.TimeOf(2.5), seed, 0, 0.3);
      EXPECT_GT(alarm.time, 0) << frequency << " Hz, " << seed;
    }
  }
}

TEST(Oscillation, DiagonalIsFoundByItsComponents) {
  OscillationDetector detector(OscillationSpec{}, kDt);
  const GrowingSine sine{1.0, 1.1, 0};
  double found = -1;
  for (int k = 0; found < 0 && k < 60000; ++k) {
    if (detector.Update(Vector3::Constant(sine(k * kDt) / std::sqrt(3.0))) > 0) found = k * kDt;
  }
  ASSERT_GE(found, 0);
  EXPECT_LE(sine.Amplitude(found), 2 * std::sqrt(3.0) * 1.1 * 1.1);
}

TEST(Oscillation, ConstantAndDecayingNeverCount) {
  for (double frequency = 0.3; frequency < 12; frequency *= 1.3) {
    for (const double growth : {1.0, 0.97, 0.8, 0.4}) {
      for (const double amplitude : {1.0, 3.0, 25.0}) {
        for (std::uint64_t seed : {0, 1, 2}) {
          const auto force = [&](double t) {
            const double phase = 2 * kPi * frequency * t + static_cast<double>(seed);
            return amplitude * std::pow(growth, frequency * t) * std::sin(phase);
          };
          EXPECT_EQ(FirstAlarm(force, 6 / frequency + 4, seed).time, -1)
              << frequency << " Hz, growth " << growth << ", " << amplitude << " N, " << seed;
        }
      }
    }
  }
}

// Growth by less than kGrowth per cycle cannot be distinguished from noise, and slow drift belongs
// to the task.
TEST(Oscillation, OutsideTheBandNothingGrows) {
  for (const double frequency : {0.1, 0.2, 0.3, 0.35}) {
    const GrowingSine sine{frequency, 1.5, 0.3};
    EXPECT_EQ(FirstAlarm(sine, sine.TimeOf(30)).time, -1) << frequency;
  }
  for (const double frequency : {11.0, 14.0, 25.0, 50.0}) {
    const GrowingSine sine{frequency, 1.05, 0.3};
    EXPECT_EQ(FirstAlarm(sine, sine.TimeOf(30)).time, -1) << frequency;
  }
}

// After three growing cycles, the force ends on a rise. The alarm must either come when the cycles
// are complete or not come at all. The alarm must not come seconds later, when a small force
// happens to change its sign.
TEST(Oscillation, ThatEndedIsNotReportedLater) {
  OscillationSpec spec;
  OscillationDetector detector(spec, 0.001);
  double reported = -1;
  const auto feed = [&](double from, double to, auto force) {
    for (double t = from; t < to; t += 0.001)
      if (detector.Update({0, 0, force(t)}) > 0 && reported < 0) reported = t;
  };
  // The force grows until it rises in the last cycle. The force then decays to zero without
  // changing its sign.
  feed(0, 6.2, [](double t) { return 0.6 * t * std::sin(2 * M_PI * 0.5 * t) * (t < 5.9); });
  feed(6.2, 20, [](double) { return 0.0; });
  feed(20, 21, [](double t) { return -1.0 * (t - 20); });
  EXPECT_LT(reported, 9);
}

TEST(Oscillation, TwoGrowingCyclesAreTooFew) {
  for (const double frequency : kFrequencies) {
    for (int cycles = 1; cycles <= 3; ++cycles) {  // the first cycle has no predecessor
      const auto force = [&](double t) {
        return t * frequency < cycles ? GrowingSine{frequency, 2, 0}(t)*10 : 0.0;
      };
      EXPECT_EQ(FirstAlarm(force, 8 / frequency).time, -1) << frequency << " Hz, " << cycles;
    }
  }
}

// Jolts at irregular intervals are not an oscillation, even if each is larger than the last one.
TEST(Oscillation, CyclesOfUnequalPeriodsNeverCount) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, "periods");
    double cycle = 0, whole = -1, frequency = 1;
    const auto force = [&](double) {
      if (std::floor(cycle) != whole) {
        // Shorter and longer cycles alternate, so no three in a row agree.
        whole = std::floor(cycle);
        const double shorter = 1 + random.Uniform();
        frequency *= std::fmod(whole, 4) < 2 ? 1.8 * shorter : 1 / (1.8 * shorter);
        frequency = std::clamp(frequency, 0.45, 9.0);
      }
      cycle += kDt * frequency;
      return std::min(25.0, 0.6 * std::pow(1.3, whole)) * std::sin(2 * kPi * cycle);
    };
    EXPECT_EQ(FirstAlarm(force, 12).time, -1) << seed;
  }
}

// The filtered signal consists of an oscillation and a remaining part of the task's slow motion.
// This remaining part must not make the oscillation seem to grow.
TEST(Oscillation, ConstantOscillationOnASlowMotionNeverCounts) {
  for (const double frequency : {1.5, 2.0, 3.0, 5.0}) {
    for (const double slow : {0.1, 0.15, 0.2}) {
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const auto force = [&](double t) {
          return 4 * std::sin(2 * kPi * frequency * t) +
                 15 * std::sin(2 * kPi * slow * t + static_cast<double>(seed));
        };
        EXPECT_EQ(FirstAlarm(force, 20, seed).time, -1) << frequency << " Hz, " << slow << " Hz";
      }
    }
  }
}

TEST(Oscillation, QuietHandNeverCountsSoak) {
  for (long seed = 1; seed <= Count(20, 2000); ++seed) {
    const auto force = [](double) { return 15.0; };
    EXPECT_EQ(FirstAlarm(force, 20, static_cast<std::uint64_t>(seed)).time, -1);
  }
}

// A step of the force makes the band-pass filter ring more than any other signal. The hand releases
// the handle within 40 ms and grips it again within 0.3 s.
TEST(Oscillation, StepsReleaseAndRegripNeverCountSoak) {
  for (long seed = 1; seed <= Count(40, 4000); ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "release");
    const double force = 60 * random.Uniform() - 30, release = 1 + 2 * random.Uniform();
    const double regrip = release + 0.2 + 2 * random.Uniform();
    const double again = 60 * random.Uniform() - 30;
    const auto grip = [&](double t) {
      if (t < release) return force;
      return force * std::exp(-(t - release) / 0.04) + again * MinimumJerk((t - regrip) / 0.3);
    };
    EXPECT_EQ(FirstAlarm(grip, 9, static_cast<std::uint64_t>(seed)).time, -1) << seed;
    const auto step = [&](double t) { return t < release ? 0 : force; };
    EXPECT_EQ(FirstAlarm(step, 6).time, -1) << seed;
  }
}

// Simulates the forces of a task. The forces consist of minimum-jerk legs to random levels within
// ±20 N, with and without pauses.
struct Legs {
  Legs(std::uint64_t seed, double leg, double dwell) {
    RandomStream random(seed, "legs");
    for (double t = 1; t < 60;) {
      begin.push_back(t);
      length.push_back(leg * (0.7 + 0.6 * random.Uniform()));
      level.push_back(40 * random.Uniform() - 20);
      t += length.back() + dwell * random.Uniform();
    }
  }
  double operator()(double t) const {
    const auto next = std::upper_bound(begin.begin(), begin.end(), t) - begin.begin();
    if (next == 0) return 0;
    const auto i = static_cast<std::size_t>(next - 1);
    const double from = i == 0 ? 0 : level[i - 1];
    return from + (level[i] - from) * MinimumJerk((t - begin[i]) / length[i]);
  }
  std::vector<double> begin, length, level;
};

TEST(Oscillation, LegsOfATaskNeverCountSoak) {
  for (long seed = 1; seed <= Count(8, 500); ++seed) {
    const auto s = static_cast<std::uint64_t>(seed);
    EXPECT_EQ(FirstAlarm(Legs(s, 4, 0), 55, s).time, -1) << seed;
    EXPECT_EQ(FirstAlarm(Legs(s, 2, 0), 55, s).time, -1) << seed;
    EXPECT_EQ(FirstAlarm(Legs(s, 1.5, 3), 55, s).time, -1) << seed;
  }
}

TEST(Oscillation, CirclesNeverCount) {
  for (const double period : {4.0, 6.0, 8.0}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const auto force = [&](double t) {
        return 15 * MinimumJerk(t / 2) * std::sin(2 * kPi * t / period + static_cast<double>(seed));
      };
      EXPECT_EQ(FirstAlarm(force, 4 * period + 2, seed).time, -1) << period;
    }
  }
}

// The loaded cobot responds to each leg with an additional decaying oscillation. With the damping
// that tasks have, there must be no alarm. With an unstable mode, there must be an alarm.
TEST(Oscillation, DampedModeDrivenByLegsNeverCountsAndAnUnstableOneDoesSoak) {
  for (const double frequency : {0.74, 0.92, 1.5}) {
    for (const double damping : {0.4, 0.2, 0.1, -0.02}) {
      for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(Count(3, 100)); ++seed) {
        const Legs legs(seed, 4, 0);
        const double w = 2 * kPi * frequency;
        double x = 0, v = 0;
        const auto mode = [&](double t) {
          v += (w * w * (legs(t) - x) - 2 * damping * w * v) * kDt;
          return x += v * kDt;
        };
        // The unstable mode gets enough time to grow from almost nothing.
        EXPECT_EQ(FirstAlarm(mode, damping < 0 ? 70 : 40, seed).time > 0, damping < 0)
            << frequency << " Hz, " << damping << ", " << seed;
      }
    }
  }
}

TEST(Oscillation, StartsWhereTheForceIsAndForgetsOnReset) {
  OscillationDetector detector(OscillationSpec{}, kDt);
  const GrowingSine sine{1.0, 1.3, 0};
  const auto feed = [&](double from, double to) {
    for (double t = from; t < to; t += kDt) {
      if (detector.Update(Vector3(0, 20 + sine(t), 0)) > 0) return t;
    }
    return -1.0;
  };
  const double undisturbed = feed(0, 60);
  ASSERT_GT(undisturbed, 0);
  detector.Reset();
  const double middle = undisturbed - 1.5;
  EXPECT_EQ(feed(0, middle), -1);
  detector.Reset();
  // After the reset, four more cycles are needed: one for comparison and three that grow.
  const double later = feed(middle, 60);
  EXPECT_GT(later, middle + 3.5);
  EXPECT_LT(later, middle + 6);
}

TEST(Oscillation, AConstantForceBelowChangesNothing) {
  for (const double frequency : kFrequencies) {
    const auto force = [&](double t) {
      return 1.5 * std::pow(1.1, frequency * t) * std::sin(2 * kPi * frequency * t);
    };
    const Alarm without = FirstAlarm(force, 10 / frequency);
    const Alarm with = FirstAlarm([&](double t) { return force(t) - 25; }, 10 / frequency);
    ASSERT_GT(without.time, 0);
    EXPECT_NEAR(with.time, without.time, 1e-9);
    EXPECT_NEAR(with.amplitude, without.amplitude, 1e-9);
  }
}

TEST(Oscillation, DisabledSeesNothing) {
  OscillationSpec spec;
  spec.enabled = false;
  OscillationDetector detector(spec, kDt);
  const GrowingSine sine{1.0, 1.3, 0};
  for (double t = 0; t < sine.TimeOf(30); t += kDt) {
    ASSERT_EQ(detector.Update(Vector3::Constant(sine(t))), 0);
  }
}

// The same signal must give the same result at other sampling rates.
TEST(Oscillation, SamplingTimeDoesNotMatter) {
  for (const double dt : {0.0005, 0.002, 0.004}) {
    OscillationDetector detector(OscillationSpec{}, dt);
    const GrowingSine sine{0.92, 1.15, 0.4};
    double found = -1;
    for (int k = 0; found < 0 && k * dt < 40; ++k) {
      if (detector.Update(Vector3(sine(k * dt), 0, 0)) > 0) found = k * dt;
    }
    EXPECT_NEAR(found, FirstAlarm(sine, 40).time, 0.01) << dt;
  }
}

}  // namespace
}  // namespace predictor
