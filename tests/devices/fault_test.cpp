// Every fault of arms, sensors and wires that the loop must survive, over many seeds in virtual
// time: when it is seen, how the arms stop, how far, and whether the handles stay together.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "fakes/bench.h"
#include "support/soak.h"

namespace predictor {
namespace {

constexpr double kWatchdog = 0.020;  // of our program on a controller [s]

enum class Expect { kNothing, kHold, kPowerOff };

struct Fault {
  int number;  // in the fault model
  const char* name;
  Expect expect;
  int bound;  // ticks from the fault to the decision, the device's own cycle in it
  std::function<void(Bench&, int hand)> inject;
};

void Disturb(Bench& bench, int hand, double joint, double force) {
  JointVector q = JointVector::Zero(bench.record().hands[0].arm_dof);
  q[1] = joint;
  Wrench F = Wrench::Zero();
  F[2] = force;
  bench.rig().Disturb(hand, q, F);
}

// Ages are told from 5 ms on; two ticks, and a cycle of the controller.
const std::vector<Fault> kFaults = {
    {2, "samples late by 30 ms", Expect::kHold, 9,
     [](Bench& b, int hand) { b.wire(hand).delay = 0.030; }},
    {3, "arm silent", Expect::kPowerOff, 9, [](Bench& b, int hand) { b.wire(hand).silent = true; }},
    {4, "samples late by 0 to 2 ms", Expect::kNothing, 0,
     [](Bench& b, int hand) { b.wire(hand).jitter = 0.002; }},
    {5, "sensor's datagrams out of order", Expect::kNothing, 0,
     [](Bench& b, int hand) { b.sensor_wire(hand).reorder = 0.5; }},
    {6, "sensor's datagrams twice", Expect::kNothing, 0,
     [](Bench& b, int hand) { b.sensor_wire(hand).duplicate = 0.5; }},
    {6, "the arm's last package for ever", Expect::kPowerOff, 9,
     [](Bench& b, int hand) { b.arm(hand).Do("repeat"); }},
    {1, "a tenth of the sensor's datagrams lost", Expect::kNothing, 0,
     [](Bench& b, int hand) { b.sensor_wire(hand).loss = 0.1; }},
    {8, "sensor's datagrams cut", Expect::kPowerOff, 9,
     [](Bench& b, int hand) { b.sensor(hand).Do("short"); }},
    {9, "malformed frame", Expect::kPowerOff, 4,
     [](Bench& b, int hand) { b.arm(hand).Do("malformed"); }},
    {10, "stream cut at every byte", Expect::kNothing, 0,
     [](Bench& b, int hand) { b.wire(hand).split = true; }},
    {11, "half-open connection", Expect::kPowerOff, 9,
     [](Bench& b, int hand) { b.wire(hand).silent = b.wire(hand).deaf = true; }},
    {11, "connection closed", Expect::kPowerOff, 3,
     [](Bench& b, int hand) { b.wire(hand).closed = true; }},
    {12, "protective stop of one arm", Expect::kHold, 4,
     [](Bench& b, int hand) { b.arm(hand).Do("protective stop"); }},
    {13, "emergency stop of one arm", Expect::kPowerOff, 4,
     [](Bench& b, int hand) { b.arm(hand).Do("emergency stop"); }},
    {17, "joint that is not a number", Expect::kHold, 4,
     [](Bench& b, int hand) { b.arm(hand).Do("not a number"); }},
    {18, "sensor saturated", Expect::kPowerOff, 3,
     [](Bench& b, int hand) { b.sensor(hand).Do("saturate"); }},
    {19, "sensor's payload frozen", Expect::kHold, 53,
     [](Bench& b, int hand) { b.sensor(hand).Do("freeze"); }},
    {21, "60 N on a handle", Expect::kHold, 12,
     [](Bench& b, int hand) { Disturb(b, hand, 0, 60); }},
    {23, "joint jumps by 0.2 rad", Expect::kPowerOff, 4,
     [](Bench& b, int hand) { Disturb(b, hand, 0.2, 0); }},
    {30, "one deadline missed", Expect::kNothing, 0, [](Bench& b, int) { b.Tick(1); }},
    {30, "three deadlines missed", Expect::kHold, 1, [](Bench& b, int) { b.Tick(3); }},
};

class Faults : public testing::TestWithParam<Fault> {};

std::string Text(const Fault& fault) { return std::to_string(fault.number) + " " + fault.name; }

TEST_P(Faults, IsSeenInTimeAndStopsTheArmsTogetherSoak) {
  const Fault& fault = GetParam();
  const long seeds = Count(2, 200);
  int latest = 0, missed = 0;
  double time = 0, distance = 0, drift = 0, turn = 0;
  for (long seed = 1; seed <= seeds; ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), fault.name);
    BenchOptions options;
    options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml";
    options.sensors = {"net_ft", "net_ft"};
    options.seed = static_cast<std::uint64_t>(seed);
    Bench bench(options);
    ASSERT_TRUE(bench.Start()) << "state " << Name(bench.emulator().state()) << ", "
                               << Name(bench.record().cause) << " "
                               << bench.record().cause_value << ": " << bench.device().Trouble();
    // In the middle of the first lifts, where the arms move.
    bench.Pass(1.5 + 2 * random.Uniform());
    const std::uint64_t tick = bench.record().tick;
    fault.inject(bench, static_cast<int>(random.Next() % kHands));
    const BenchStop stop =
        bench.AwaitStop(tick, fault.expect == Expect::kNothing ? 0.5 : 1.5);
    if (fault.expect == Expect::kNothing) {
      EXPECT_EQ(bench.emulator().state(), RunState::kRun)
          << Text(fault) << ", seed " << seed << ": " << Name(stop.cause);
      continue;
    }
    EXPECT_EQ(stop.end,
              fault.expect == Expect::kHold ? RunState::kHeld : RunState::kUnpowered)
        << Text(fault) << ", seed " << seed << ": " << Name(stop.cause);
    missed += stop.ticks < 0 || stop.ticks > fault.bound;
    latest = std::max(latest, stop.ticks);
    time = std::max(time, stop.time);
    distance = std::max(distance, stop.distance);
    drift = std::max(drift, stop.drift);
    turn = std::max(turn, stop.turn);
  }
  std::printf("%2d  %-42s", fault.number, fault.name);
  if (fault.expect == Expect::kNothing)
    std::printf("goes on\n");
  else
    std::printf("%-9s seen after %2d of %2d ticks; rest after %3.0f ms, %4.1f mm; apart %.2f mm, "
                "%.2f deg\n",
                fault.expect == Expect::kHold ? "holds" : "power off", latest, fault.bound,
                1e3 * time, 1e3 * distance, 1e3 * drift, 57.2958 * turn);
  EXPECT_EQ(missed, 0) << Text(fault) << " was seen too late";
  EXPECT_LE(drift, 0.002) << Text(fault);
  EXPECT_LE(turn, 0.5 / 57.2958) << Text(fault);
  // At 0.25 m/s the budget is 90 ms and 13.4 mm, 0.8 mm before it; the arms' own lag comes on top.
  EXPECT_LE(distance, 0.0134 + 0.25 * 0.040) << Text(fault);
}

INSTANTIATE_TEST_SUITE_P(faults, Faults, testing::ValuesIn(kFaults),
                         [](const testing::TestParamInfo<Fault>& info) {
                           std::string name = Text(info.param);
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return std::to_string(info.index) + "_" + name;
                         });

// Whatever becomes of the loop, the controllers stop the arms by themselves.
TEST(Loop, ThatHangsStopsTheArms) {
  BenchOptions options;
  options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml";
  Bench bench(options);
  ASSERT_TRUE(bench.Start());
  bench.Pass(2.5);
  bench.Hang(kWatchdog + 0.3);
  for (const FrameMotion& handle : bench.rig().rig().true_handles())
    EXPECT_LT(handle.V_W.norm(), 1e-3);
}

}  // namespace
}  // namespace predictor
