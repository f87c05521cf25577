#include "commissioning/loop_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "commissioning/chirp.h"
#include "commissioning/rig_station.h"
#include "core/error.h"

namespace predictor::commissioning {
namespace {

constexpr double kRest = 0.4;  // [s]
constexpr int kJoint = 3;

struct Arrangement {
  VelocityLoopSpec loop;
  double rate = 1000;              // sample rate [Hz]
  double quantum = 1e-5;           // encoder resolution [rad]
  double acceleration_limit = 10;  // [rad/s²]
  std::uint64_t seed = 1;
  std::function<double(int, double)> wobble;  // motion that a hand adds to the joints
  int waver = 0;  // the arm takes each command after a random delay of 0 … waver ticks
};

// One joint of the rig swings while no hand is on the handle.
LoopRecord Swing(const Arrangement& a) {
  Scenario scenario = ArmScenario(1);
  scenario.seed = a.seed;
  scenario.rig.loop = a.loop;
  scenario.rig.encoder_resolution = a.quantum;
  scenario.device.left->acceleration_limit = {a.acceleration_limit};
  VirtualTime time;
  RigHand hand(scenario, &time, ArmStart(1)[0], a.rate);
  hand.wobble = a.wobble;
  RigDriver driver(&hand);
  const Chirp chirp{ChirpOptions()};
  LoopRecorder recorder(kJoint, 1 / a.rate);
  ArmReading reading;
  std::uint64_t seen = 0;
  std::mt19937 random(static_cast<std::mt19937::result_type>(a.seed));
  std::vector<std::pair<double, JointVector>> sent;  // time at which the arm takes a command [s],
                                                     // and the command
  const auto now = [&] { return 1e-9 * static_cast<double>(time.Now()); };
  const double begin = now();
  while (now() - begin < chirp.duration() + 2 * kRest) {
    EXPECT_TRUE(driver.Read(&reading).ok());
    if (reading.sequence != seen) recorder.AddSample(now() - reading.age, reading.q[kJoint]);
    seen = reading.sequence;
    JointVector v = JointVector::Zero(7);
    v[kJoint] = chirp.v(now() - begin - kRest);
    recorder.AddCommand(now(), now(), v[kJoint]);
    sent.emplace_back(now() + 0.001 * static_cast<double>(random() % (a.waver + 1U)), v);
    for (; !sent.empty() && sent.front().first < now() + 1e-6; sent.erase(sent.begin()))
      EXPECT_TRUE(driver.Write(sent.front().second, true).ok());
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
  LoopRecorder recorder(0, 0.002);
  double way = 0, time = 3;
  const double steps[] = {0.0013, 0.0004, 0.0009, 0.0031, 0.001, 0.0022};
  for (int k = 0; k < 60; ++k) {
    const double u = std::sin(0.3 * k);
    recorder.AddCommand(time, time, u);
    if (k < 59) way += u * steps[k % 6];
    time += steps[k % 6];
  }
  recorder.AddCommand(time, time, 0);
  way += std::sin(0.3 * 59) * steps[59 % 6];
  const LoopRecord record = std::move(recorder).Finish();
  double sum = 0;
  for (const double u : record.u) sum += 0.001 * u;
  EXPECT_NEAR(sum, way, 1e-12);
}

TEST(LoopRecorder, CountsLateTicksAndLostSamples) {
  LoopRecorder recorder(0, 0.002);
  double time = 7;
  for (int k = 0; k < 1000; ++k) {
    recorder.AddCommand(time, time, 0);
    // Every other tick has a sample, whose age varies. Of the 500 samples, the ten from k = 400 to
    // 419 are lost.
    if (k % 2 == 0 && (k < 400 || k >= 420)) recorder.AddSample(time - 0.0004 * (k % 3), 0);
    time += k % 100 == 50 ? 0.0042 : k % 100 == 51 ? 0.0014 : k % 100 == 60 ? 0.0019 : 0.001;
  }
  const Gaps gaps = std::move(recorder).Finish().gaps;
  EXPECT_EQ(gaps.ticks, 1000);
  EXPECT_EQ(gaps.late, 20);  // 1.4 ms is jitter of the wake-up, 1.9 ms is a skipped step
  EXPECT_NEAR(gaps.longest_tick, 0.0042, 1e-9);
  EXPECT_EQ(gaps.samples, 490);
  // Ten samples were lost together, and 22.5 more count as lost because of ten gaps of 4.5 ms.
  EXPECT_NEAR(static_cast<double>(gaps.lost), 10 + 22.5, 1.5);
  EXPECT_NEAR(gaps.longest_hole, 0.022, 0.002);
  const std::string text = GapsText(gaps);
  EXPECT_NE(text.find("20 of 1000 ticks were late (2.0 %; longest interval 4.2 ms"),
            std::string::npos)
      << text;
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
      "largest errors: bandwidth %.2f %%, damping ratio %.2f %%, delay %.3f ms; correct intervals: "
      "%d of %d\n",
      100 * worst_bandwidth, 100 * worst_damping, 1000 * worst_delay, held, intervals);
  EXPECT_GE(held, 0.85 * intervals);
}

// The controller uses the latest command in each of its cycles, which are independent of our ticks.
TEST(FitLoop, FindsTheLoopOfAnArmThatTakesCommandsAtItsOwnTime) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Arrangement a;
    a.loop = {15, 0.9, 0.004};
    a.rate = 500;
    a.waver = 2;
    a.seed = seed;
    const LoopFit fit = FitOf(a);
    EXPECT_NEAR(fit.bandwidth.value, 15, 0.03 * 15);
    EXPECT_NEAR(fit.damping_ratio.value, 0.9, 0.03 * 0.9);
    EXPECT_NEAR(fit.delay.value, 0.004 + 0.001, 0.001);
  }
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
    EXPECT_NE(RefusalOf(a).find("hand may have been on the handle"), std::string::npos)
        << frequency;
    EXPECT_NE(RefusalOf(a).find("No tick was late and no sample was lost."), std::string::npos);
  }
}

// If a hand on the handle is the reason for the refusal, the message must also report gaps in the
// measurement.
TEST(FitLoop, RefusalReportsLateTicksAndLostSamples) {
  LoopRecord record = Swing({});
  const auto refusal = [&] {
    try {
      FitLoop(std::span(&record, 1));
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refusal(), "");
  record.gaps.late = record.gaps.ticks / 50;
  EXPECT_EQ(refusal(), "");  // the fit uses the actual command times
  const LoopRecord whole = record;
  for (LoopRecord::Sample& sample : record.samples) sample.q *= 0.5;
  EXPECT_NE(refusal().find("ticks were late (2.0 %"), std::string::npos) << refusal();
  record = whole;
  record.gaps.late = record.gaps.ticks / 10;
  EXPECT_NE(refusal().find("The measurement has too many gaps"), std::string::npos);
  record = whole;
  record.gaps.lost = record.gaps.samples / 10;
  EXPECT_NE(refusal().find("samples were lost (9.1 %"), std::string::npos) << refusal();
}

TEST(FitLoop, RefusesALimitOfTheAcceleration) {
  Arrangement a;
  a.acceleration_limit = 0.8;
  a.loop.bandwidth = 30;
  EXPECT_NE(RefusalOf(a).find("acceleration limit"), std::string::npos) << RefusalOf(a);
}

TEST(FitLoop, RefusesAJointThatGoesHalfTheWay) {
  LoopRecord record = Swing({});
  for (LoopRecord::Sample& sample : record.samples) sample.q *= 0.5;
  try {
    FitLoop(std::span(&record, 1));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("0.50 times the commanded distance"),
              std::string::npos)
        << error.what();
  }
}

TEST(FitLoop, RefusesWhatIsTooLittle) {
  EXPECT_THROW(FitLoop({}), InputError);
  LoopRecord record;
  EXPECT_THROW(FitLoop(std::span(&record, 1)), InputError);
  record.u.assign(100, 0);
  record.samples.assign(10, {0, 0});
  EXPECT_THROW(FitLoop(std::span(&record, 1)), InputError);
  record.u.assign(5000, 0);  // the joint never moved
  for (int k = 0; k < 5000; ++k) record.samples.push_back({0.001 * k, 1 + 1e-5 * (k % 2)});
  EXPECT_THROW(FitLoop(std::span(&record, 1)), InputError);
}

}  // namespace
}  // namespace predictor::commissioning
