// A controller may take time to begin a motion. Until the controller has begun, the other arm must
// not move alone, and the emulation must wait. When the emulation continues, it must not catch up
// on the lost time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/motion.h"
#include "fakes/bench.h"

namespace predictor {
namespace {

BenchOptions UrAndFranka() {
  BenchOptions options;
  options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/ur_and_panda.yaml";
  options.arms = {"ur", "franka"};
  return options;
}

// Requests RUN while hands push both handles upwards. The Franka takes `start` ms to begin.
void BeginRun(Bench* bench, int start) {
  ASSERT_TRUE(bench->Await(RunState::kIdle, 2));
  bench->Hold(true);
  bench->Pass(0.2);
  bench->emulator().Request(RunEvent::kAlignRequested);
  ASSERT_TRUE(bench->Await(RunState::kArmed, 20));
  bench->Pass(0.5);
  ASSERT_TRUE(bench->arm(1).Do("start late " + std::to_string(start)));
  bench->emulator().Request(RunEvent::kStartRequested);
  ASSERT_TRUE(bench->Await(RunState::kRun, 1));
  for (int hand = 0; hand < kHands; ++hand)
    bench->rig().Disturb(hand, {}, Wrench((Vector6() << 0, 0, 8, 0, 0, 0).finished()));
}

bool Waits(const Bench& bench) { return bench.record().hands[1].arm_waits != 0; }

// Returns the command of the fastest joint [rad/s].
double FastestCommand(const Bench& bench) {
  double fastest = 0;
  for (const HandRecord& hand : bench.record().hands)
    for (const double v : hand.command) fastest = std::max(fastest, std::abs(v));
  return fastest;
}

Pose Relative(const Bench& bench) {
  const auto& hands = bench.record().hands;
  return FromRecord(hands[0].real.pose).Inverse() * FromRecord(hands[1].real.pose);
}

// Returns the largest change of the distance between the handles during 1.5 s [m]. `asked` receives
// the fastest command.
double Parted(Bench* bench, const Pose& before, double* asked) {
  double apart = 0;
  for (int k = 0; k < 1500; ++k) {
    bench->Tick();
    EXPECT_EQ(bench->emulator().state(), RunState::kRun);
    apart = std::max(apart, (Relative(*bench).p - before.p).norm());
    *asked = std::max(*asked, FastestCommand(*bench));
  }
  return apart;
}

class BeginMotion : public testing::TestWithParam<int> {};  // time that the Franka takes to begin
                                                            // [ms]

TEST_P(BeginMotion, MakesTheOtherArmWait) {
  Bench prompt(UrAndFranka()), late(UrAndFranka());
  ASSERT_NO_FATAL_FAILURE(BeginRun(&prompt, 3));
  ASSERT_NO_FATAL_FAILURE(BeginRun(&late, GetParam()));
  const Pose before = Relative(late);
  double waited = 0;
  for (; Waits(late); waited += 1e-3) {
    EXPECT_EQ(FastestCommand(late), 0) << waited;
    EXPECT_EQ(late.record().run_time, 0);
    late.Tick();
    ASSERT_LT(waited, 1);
  }
  EXPECT_NEAR(waited, 1e-3 * GetParam(), 0.006);
  double asked_prompt = 0, asked_late = 0;
  const double apart = Parted(&prompt, before, &asked_prompt);
  EXPECT_LT(Parted(&late, before, &asked_late), 1.2 * apart);
  EXPECT_GT(asked_late, 0.05);
  EXPECT_LT(asked_late, 1.2 * asked_prompt);
}

TEST_P(BeginMotion, ThatIsStoppedBeforeItBeginsMovesNothing) {
  Bench bench(UrAndFranka());
  ASSERT_NO_FATAL_FAILURE(BeginRun(&bench, GetParam()));
  bench.Pass(1e-3 * GetParam() / 2);
  ASSERT_TRUE(Waits(bench));
  bench.emulator().Request(RunEvent::kStopRequested);
  for (int k = 0; k < 1500; ++k) {
    bench.Tick();
    EXPECT_EQ(FastestCommand(bench), 0) << k;
  }
  EXPECT_EQ(bench.emulator().state(), RunState::kHeld);
}

INSTANTIATE_TEST_SUITE_P(After, BeginMotion, testing::Values(50, 300, 900),
                         [](const auto& delay) { return std::to_string(delay.param) + "ms"; });

}  // namespace
}  // namespace predictor
