// Tests the driver's program for the controller, which the fake's URScript executes.
#include "devices/ur/ur_script.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/format.h"
#include "fakes/ur/urscript.h"
#include "fakes/ur/urscript_machine.h"
#include "support/test_name.h"

namespace predictor {
namespace {

constexpr int kReady = 1, kFollows = 2, kStopping = 3, kEnded = 4;

// A controller whose cycles begin at multiples of the cycle time. The test writes the registers
// between the cycles.
class Bench {
 public:
  explicit Bench(const UrScriptOptions& options)
      : options_(options), program_(urscript::Compile(UrScript(options))) {
    controller.cycle = options.cycle;
    controller.input_int[Register(0)] = 1000;  // left by an earlier program
    controller.input_int[Register(1)] = 1;
    controller.input_double[Register(0)] = 0.7;
    machine_ = std::make_unique<urscript::Machine>(&program_, &controller);
  }

  // Performs one cycle of the controller.
  void Cycle() {
    if (running) running = machine_->Cycle();
    if (!running) controller.Stopj(options_.deceleration);
    controller.Advance();
  }
  void Cycles(double time) {
    for (double t = 0; t < time - 1e-9; t += options_.cycle) Cycle();
  }
  // Writes the registers, as a tick does, with a velocity for the first joint.
  void Command(double v, bool follow) {
    ++controller.input_int[Register(0)];
    controller.input_int[Register(1)] = follow ? 1 : 0;
    controller.input_double[Register(0)] = v;
  }
  void Follow(double v, double time) {
    for (double t = 0; t < time - 1e-9; t += options_.cycle) {
      Command(v, true);
      Cycle();
    }
  }
  double speed() const { return controller.set_point()[0]; }
  int state() const { return controller.output_int[Register(1)]; }
  int echo() const { return controller.output_int[Register(0)]; }
  int counter() const { return controller.input_int[Register(0)]; }

  UrController controller;
  bool running = true;

 private:
  std::size_t Register(int i) const {
    return static_cast<std::size_t>(options_.first_register + i);
  }

  UrScriptOptions options_;
  urscript::Program program_;
  std::unique_ptr<urscript::Machine> machine_;
};

class UrScriptTest : public testing::TestWithParam<UrScriptOptions> {};

TEST_P(UrScriptTest, StandsUntilTheCounterChangesWithAnyRegisters) {
  Bench bench(GetParam());
  bench.Cycles(1);
  EXPECT_TRUE(bench.running);
  EXPECT_EQ(bench.state(), kReady);
  EXPECT_EQ(bench.echo(), 1000);
  EXPECT_EQ(bench.speed(), 0);
}

TEST_P(UrScriptTest, WaitsHalfAMinuteAndEnds) {
  Bench bench(GetParam());
  bench.Cycles(29.9);
  EXPECT_TRUE(bench.running);
  bench.Cycles(0.2);
  EXPECT_FALSE(bench.running);
  EXPECT_EQ(bench.state(), kEnded);
}

TEST_P(UrScriptTest, FollowsAndEchoes) {
  Bench bench(GetParam());
  bench.Cycle();
  for (const double v : {0.3, -0.5, 0.1}) {
    bench.Follow(v, 0.1);
    EXPECT_DOUBLE_EQ(bench.speed(), v);
    EXPECT_EQ(bench.echo(), bench.counter());
    EXPECT_EQ(bench.state(), kFollows);
  }
}

TEST_P(UrScriptTest, ActsInTheCycleThatSeesTheCommand) {
  Bench bench(GetParam());
  bench.Cycle();
  bench.Follow(0.3, 0.1);
  bench.Command(0.4, true);
  bench.Cycle();
  EXPECT_GT(bench.speed(), 0.3);
}

TEST_P(UrScriptTest, StandsOnCommandAndFollowsAgain) {
  Bench bench(GetParam());
  bench.Cycle();
  bench.Follow(0.5, 0.1);
  bool stopping = false;
  for (int i = 0; i < 100; ++i) {
    bench.Command(0.5, false);  // without `follow`, the velocity causes no motion
    bench.Cycle();
    stopping = stopping || bench.state() == kStopping;
  }
  EXPECT_TRUE(stopping);
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_EQ(bench.state(), kFollows);
  bench.Follow(0.2, 0.1);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.2);
}

// Time advances in steps of 0.1 ms, so the last command can arrive at any phase of a cycle.
TEST_P(UrScriptTest, BrakesWithinTwentyMillisecondsOfSilenceAndForGood) {
  constexpr double kStep = 1e-4;
  const double cycle = GetParam().cycle;
  const int steps = static_cast<int>(std::lround(cycle / kStep));
  for (int phase = 0; phase < steps; ++phase) {
    Bench bench(GetParam());
    bench.Cycle();
    bench.Follow(0.5, 0.2);
    double silence = 0;
    bench.Command(0.5, true);  // each test writes later after the start of a cycle
    for (int i = phase; bench.speed() >= 0.5; ++i) {
      silence += kStep;
      if (i % steps == steps - 1) bench.Cycle();
      ASSERT_LT(silence, 1);
    }
    EXPECT_LE(silence, 0.020) << phase;
    EXPECT_GE(silence, cycle) << phase;
    EXPECT_LE(silence, UrWatchdog(cycle) + 1e-9) << phase;
    // After that, the arm must brake to a standstill with the given deceleration, whatever data
    // arrives.
    double last = bench.speed();
    for (double t = 0; t < 0.2; t += cycle) {
      bench.Command(0.5, true);
      bench.Cycle();
      EXPECT_LE(bench.speed(), std::max(0.0, last - 0.999 * GetParam().deceleration * cycle));
      last = bench.speed();
    }
    EXPECT_EQ(bench.speed(), 0);
    EXPECT_FALSE(bench.running);
    EXPECT_EQ(bench.state(), kEnded);
  }
}

TEST_P(UrScriptTest, ShorterSilenceIsTolerated) {
  Bench bench(GetParam());
  bench.Cycle();
  for (int i = 0; i < 100; ++i) {
    bench.Follow(0.5, GetParam().cycle);
    bench.Cycles((UrSilentCycles(GetParam().cycle) - 1) * GetParam().cycle);
    EXPECT_TRUE(bench.running);
  }
  EXPECT_DOUBLE_EQ(bench.speed(), 0.5);
}

TEST_P(UrScriptTest, SilenceEndsAStandingProgramToo) {
  Bench bench(GetParam());
  bench.Cycle();
  bench.Command(0, false);
  bench.Cycles(0.05);
  EXPECT_FALSE(bench.running);
  bench.Follow(0.5, 0.1);
  EXPECT_EQ(bench.speed(), 0);
}

TEST_P(UrScriptTest, CounterWraps) {
  Bench bench(GetParam());
  bench.controller.input_int[static_cast<std::size_t>(GetParam().first_register)] = 2147483647;
  bench.Cycle();
  auto& counter = bench.controller.input_int[static_cast<std::size_t>(GetParam().first_register)];
  counter = -2147483647 - 1;
  bench.Cycle();
  EXPECT_EQ(bench.state(), kFollows);
  EXPECT_EQ(bench.echo(), counter);
}

INSTANTIATE_TEST_SUITE_P(
    Controllers, UrScriptTest,
    testing::Values(UrScriptOptions{0.002, 20, 10, 0}, UrScriptOptions{0.008, 20, 10, 0},
                    UrScriptOptions{0.002, 20, 5.5, 24}, UrScriptOptions{0.008, 15, 10, 42}),
    [](const auto& options) {
      const UrScriptOptions& o = options.param;
      return test::TestName(Formatted("%.0f ms %g %g rad/s2 register %d", 1e3 * o.cycle,
                                      o.acceleration, o.deceleration, o.first_register));
    });

TEST(UrScriptText, HasEveryPlaceFilled) { EXPECT_EQ(UrScript({}).find('$'), std::string::npos); }

}  // namespace
}  // namespace predictor
