#include "commissioning/loop_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "commissioning/chirp.h"
#include "commissioning/rig_station.h"
#include "core/error.h"

namespace predictor {
namespace {

constexpr double kRest = 0.4;  // [s]
constexpr int kJoint = 3;

struct Arrangement {
  VelocityLoopSpec loop;
  double rate = 1000;              // of the samples [Hz]
  double quantum = 1e-5;           // of the encoders [rad]
  double acceleration_limit = 10;  // [rad/s²]
  std::uint64_t seed = 1;
  std::function<double(int, double)> wobble;  // what a hand adds to the joints
};

// A swing of one joint of the rig, with nobody at the handle.
LoopRecord Swing(const Arrangement& a) {
  Scenario scenario = ArmScenario(1);
  scenario.seed = a.seed;
  scenario.rig.loop = a.loop;
  scenario.rig.encoder_quantum = a.quantum;
  scenario.device.left->acceleration_limit = {a.acceleration_limit};
  VirtualTime time;
  RigHand hand(scenario, &time, ArmStart(1)[0], a.rate);
  hand.wobble = a.wobble;
  RigDriver driver(&hand);
  const Chirp chirp{ChirpOptions()};
  LoopRecorder recorder(kJoint);
  ArmReading reading;
  std::uint64_t seen = 0;
  const auto now = [&] { return 1e-9 * static_cast<double>(time.Now()); };
  const double begin = now();
  while (now() - begin < chirp.duration() + 2 * kRest) {
    EXPECT_TRUE(driver.Read(&reading).ok());
    if (reading.sequence != seen) recorder.Seen(now() - reading.age, reading.q[kJoint]);
    seen = reading.sequence;
    JointVector v = JointVector::Zero(7);
    v[kJoint] = chirp.v(now() - begin - kRest);
    EXPECT_TRUE(driver.Write(v, true).ok());
    recorder.Told(now(), v[kJoint]);
    time.Wait(0.001);
  }
  return std::move(recorder).Finish();
}

LoopFit FitOf(const Arrangement& a) {
  const LoopRecord record = Swing(a);
  return FitLoop(std::span(&record, 1));
}

std::string RefusalOf(const Arrangement& a) {
  try {
    FitOf(a);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Chirp, BeginsAndEndsAtRestAndWhereItBegan) {
  for (const double low : {0.3, 0.7, 2.0}) {
    ChirpOptions options;
    options.low = low;
    const Chirp chirp(options);
    EXPECT_EQ(chirp.v(-0.1), 0);
    EXPECT_EQ(chirp.v(0), 0);
    EXPECT_NEAR(chirp.v(1e-4), 0, 1e-9);
    EXPECT_NEAR(chirp.v(options.time), 0, 1e-9);
    EXPECT_EQ(chirp.v(chirp.duration()), 0);
    double q = 0, farthest = 0, fastest = 0, hardest = 0;
    const double h = 1e-4;
    for (double t = h / 2; t < chirp.duration(); t += h) {
      q += h * chirp.v(t);
      farthest = std::max(farthest, std::abs(q));
      fastest = std::max(fastest, std::abs(chirp.v(t)));
      hardest = std::max(hardest, std::abs(chirp.v(t + h / 2) - chirp.v(t - h / 2)) / h);
    }
    EXPECT_NEAR(q, 0, 1e-7);
    EXPECT_LE(farthest, options.angle * 1.001);
    EXPECT_NEAR(farthest, chirp.reach(), 1e-3 * options.angle);
    EXPECT_LE(fastest, options.speed);
    EXPECT_LE(hardest, options.acceleration);
    EXPECT_GT(hardest, 0.7 * options.acceleration);
  }
}

TEST(LoopRecorder, KeepsTheWayOfCommandsThatComeAtAnyTime) {
  LoopRecorder recorder(0);
  double way = 0, time = 3;
  const double steps[] = {0.0013, 0.0004, 0.0009, 0.0031, 0.001, 0.0022};
  for (int k = 0; k < 60; ++k) {
    const double u = std::sin(0.3 * k);
    recorder.Told(time, u);
    if (k < 59) way += u * steps[k % 6];
    time += steps[k % 6];
  }
  recorder.Told(time, 0);
  way += std::sin(0.3 * 59) * steps[59 % 6];
  const LoopRecord record = std::move(recorder).Finish();
  double sum = 0;
  for (const double u : record.u) sum += 0.001 * u;
  EXPECT_NEAR(sum, way, 1e-12);
}

TEST(FitLoop, FindsTheLoopOfTheRigAtAnyRateOfSamples) {
  double worst_bandwidth = 0, worst_damping = 0, worst_delay = 0;
  int held = 0, intervals = 0;
  for (const double rate : {125.0, 500.0, 1000.0})
    for (const double bandwidth : {8.0, 15.0, 30.0})
      for (const double damping : {0.6, 0.9, 1.2})
        for (const double delay : {0.0, 0.0043, 0.012}) {
          Arrangement a;
          a.loop = {bandwidth, damping, delay};
          a.rate = rate;
          const LoopFit fit = FitOf(a);
          const double f = std::abs(fit.bandwidth.value / bandwidth - 1);
          const double z = std::abs(fit.damping_ratio.value / damping - 1);
          const double d = std::abs(fit.delay.value - delay);
          EXPECT_LT(f, 0.03) << bandwidth << " " << damping << " " << delay << " " << rate;
          EXPECT_LT(z, 0.03) << bandwidth << " " << damping << " " << delay << " " << rate;
          EXPECT_LT(d, 3e-4) << bandwidth << " " << damping << " " << delay << " " << rate;
          EXPECT_NEAR(fit.gain.value, 1, 1e-3);
          worst_bandwidth = std::max(worst_bandwidth, f);
          worst_damping = std::max(worst_damping, z);
          worst_delay = std::max(worst_delay, d);
          held += (f * bandwidth <= fit.bandwidth.half_width) +
                  (z * damping <= fit.damping_ratio.half_width) + (d <= fit.delay.half_width);
          intervals += 3;
        }
  std::printf(
      "worst: bandwidth %.2f %%, damping ratio %.2f %%, delay %.3f ms; intervals hold %d of "
      "%d\n",
      100 * worst_bandwidth, 100 * worst_damping, 1000 * worst_delay, held, intervals);
  EXPECT_GE(held, 0.85 * intervals);
}

TEST(FitLoop, OfACoarseEncoderIsLessSureAndSaysSo) {
  Arrangement fine, coarse;
  coarse.quantum = 1e-4;
  const LoopFit sure = FitOf(fine), less = FitOf(coarse);
  EXPECT_GT(less.bandwidth.half_width, 3 * sure.bandwidth.half_width);
  EXPECT_NEAR(less.bandwidth.value, 15, 1.5 * less.bandwidth.half_width);
  EXPECT_NEAR(less.delay.value, 0.004, 1.5 * less.delay.half_width);
  coarse.quantum = 2e-3;
  EXPECT_NE(RefusalOf(coarse), "");
}

TEST(FitLoop, RefusesAHandOnTheHandle) {
  for (const double frequency : {2.0, 8.0}) {
    Arrangement a;
    a.wobble = [frequency](int, double t) {
      const double size = 2e-3 / frequency;  // [rad]
      return t > 1 ? size * std::sin(2 * std::numbers::pi * frequency * t + std::sin(t)) : 0;
    };
    EXPECT_NE(RefusalOf(a).find("a hand was on the handle"), std::string::npos) << frequency;
  }
}

TEST(FitLoop, RefusesALimitOfTheAcceleration) {
  Arrangement a;
  a.acceleration_limit = 0.8;
  a.loop.bandwidth = 30;
  EXPECT_NE(RefusalOf(a).find("limit of its acceleration"), std::string::npos) << RefusalOf(a);
}

TEST(FitLoop, RefusesAJointThatGoesHalfTheWay) {
  LoopRecord record = Swing({});
  for (LoopRecord::Sample& sample : record.samples) sample.q *= 0.5;
  try {
    FitLoop(std::span(&record, 1));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("0.50 of the way"), std::string::npos) << error.what();
  }
}

TEST(FitLoop, RefusesWhatIsTooLittle) {
  EXPECT_THROW(FitLoop({}), InputError);
  LoopRecord record;
  EXPECT_THROW(FitLoop(std::span(&record, 1)), InputError);
  record.u.assign(100, 0);
  record.samples.assign(10, {0, 0});
  EXPECT_THROW(FitLoop(std::span(&record, 1)), InputError);
  record.u.assign(5000, 0);  // it never moved
  for (int k = 0; k < 5000; ++k) record.samples.push_back({0.001 * k, 1 + 1e-5 * (k % 2)});
  EXPECT_THROW(FitLoop(std::span(&record, 1)), InputError);
}

}  // namespace
}  // namespace predictor
