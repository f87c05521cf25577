// Tests what the UR driver reads and sends while there is no fault.
#include "devices/ur/ur_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "devices/ur/ur_script.h"
#include "devices/ur_arm_fixture.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

TEST_P(UrArmTest, DescribesTheConnectedArm) {
  UrBench bench(GetParam());
  const DeviceFacts& facts = bench.Connect().arm->facts();
  const bool cb3 = GetParam().version.major == 3;
  EXPECT_EQ(facts.joints, 6);
  EXPECT_EQ(facts.rate, cb3 ? 125 : 500);
  EXPECT_EQ(facts.own_wrench, !cb3);
  EXPECT_LE(facts.watchdog, 0.020);
  EXPECT_NE(facts.name.find(cb3 ? "CB3, PolyScope 3.14.3" : "e-Series, PolyScope 5.12.0"),
            std::string::npos);
  EXPECT_NE(facts.name.find("never run on hardware"), std::string::npos);
  EXPECT_EQ(bench.arm->Trouble(), "");
}

TEST_P(UrArmTest, FollowsWhatIsWritten) {
  UrBench bench(GetParam());
  bench.Connect();
  for (const double v : {0.2, -0.4, 0.0, 0.1}) {
    bench.Ticks(100, v);
    EXPECT_TRUE(bench.written.ok());
    EXPECT_DOUBLE_EQ(bench.speed(), v);
  }
  JointVector each(kUrJoints);
  each << 0.1, -0.2, 0.3, -0.4, 0.5, -0.6;
  for (int i = 0; i < 200; ++i) bench.Tick(each, true);
  EXPECT_LT((bench.mechanics.command - each).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(UrArmTest, StandsWithoutMotion) {
  UrBench bench(GetParam());
  bench.Connect();
  bench.Ticks(100, 0.3, false);
  EXPECT_EQ(bench.speed(), 0);
  bench.Ticks(100, 0.3);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.3);
  bench.Ticks(150, 0.3, false);
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_TRUE(bench.read.ok());
  bench.Ticks(100, 0.3);  // as after a person's request; there was no fault
  EXPECT_DOUBLE_EQ(bench.speed(), 0.3);
}

TEST_P(UrArmTest, StandsWhileTheTickHasNotBegun) {
  UrBench bench(GetParam());
  bench.Connect();
  bench.network.Pass(5);
  EXPECT_EQ(bench.speed(), 0);
  bench.Ticks(100, 0.3);
  EXPECT_TRUE(bench.read.ok());
  EXPECT_DOUBLE_EQ(bench.speed(), 0.3);
}

TEST_P(UrArmTest, ReadsTheArmsModelAndVersion) {
  UrBench bench(GetParam());
  bench.mechanics.sample.F_S_raw << 1, -2, 3, -0.4, 0.5, -0.6;
  bench.mechanics.sample.q << 0.1, 0.2, 0.3, -0.4, -0.5, 7;
  bench.Connect().Ticks(100, 0.25);
  // The last packet can be at most one cycle old.
  const double most = 0.25e-3 * (period() + 1) + 1e-9;
  for (int j = 0; j < kUrJoints; ++j)
    EXPECT_NEAR(bench.reading.q[j], bench.mechanics.sample.q[j], most) << j;
  EXPECT_DOUBLE_EQ(bench.reading.v[3], 0.25);
  EXPECT_FALSE(bench.reading.fault);
  if (!bench.arm->facts().own_wrench) return;
  EXPECT_EQ(bench.reading.wrench.F_S, bench.mechanics.sample.F_S_raw);
  EXPECT_EQ(bench.reading.wrench.sequence, bench.reading.sequence);
  EXPECT_FALSE(bench.reading.wrench.saturated);
}

TEST_P(UrArmTest, SamplesAreCountedAndYoung) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(50, 0);
  const std::uint64_t first = bench.reading.sequence;
  for (int i = 0; i < 800; ++i) {
    bench.Tick(0);
    EXPECT_LT(bench.reading.age, 1e-3 * period());
  }
  EXPECT_EQ(bench.reading.sequence, first + 800 / static_cast<unsigned>(period()));
}

TEST_P(UrArmTest, NewestOfSeveralPackagesCounts) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(100, 0);
  static_cast<void>(bench.arm->Read(&bench.reading));
  const std::uint64_t before = bench.reading.sequence;
  bench.mechanics.sample.q[0] = 1;
  for (int i = 0; i < 80; ++i) {
    bench.mechanics.sample.q[0] += 0.01;
    static_cast<void>(bench.arm->Write(JointVector::Zero(kUrJoints), false));
    bench.Pass();
  }
  static_cast<void>(bench.arm->Read(&bench.reading));
  EXPECT_NEAR(bench.reading.q[0], bench.mechanics.sample.q[0], 0.01 * period());
  EXPECT_EQ(bench.reading.sequence, before + 80 / static_cast<unsigned>(period()));
  EXPECT_LT(bench.reading.age, 1e-3 * period());
}

TEST_P(UrArmTest, SilenceAges) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(100, 0);
  bench.fake.Do("freeze");
  const std::uint64_t last = bench.reading.sequence;
  bench.Tick(0);  // one packet may have been in transit
  const double age = bench.reading.age;
  bench.Ticks(100, 0);
  EXPECT_NEAR(bench.reading.age, age + 0.1, 1e-9);
  const bool own = bench.arm->facts().own_wrench;
  EXPECT_EQ(bench.reading.wrench.age, own ? bench.reading.age : WrenchReading().age);
  EXPECT_LE(bench.reading.sequence, last + 1);
  EXPECT_TRUE(bench.read.ok());  // the monitor decides when it is too old
}

TEST_P(UrArmTest, LatePackagesAreAsOldAsTheyAre) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(500, 0);
  bench.fake.Do("late 30");
  bench.Ticks(200, 0);
  for (int i = 0; i < 20; ++i) {
    bench.Tick(0);
    EXPECT_GE(bench.reading.age, 0.030 - 1e-3);
    EXPECT_LT(bench.reading.age, 0.030 + 1e-3 * period());
  }
  EXPECT_TRUE(bench.read.ok());
}

// A sample of this age does not show whether the arm still receives commands.
TEST_P(UrArmTest, LatePackagesDoNotProveThatItIsDeaf) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(500, 0);
  bench.fake.Do("late 200");
  bench.Ticks(500, 0);
  EXPECT_GE(bench.reading.age, 0.199);
  EXPECT_TRUE(bench.read.ok()) << bench.arm->Trouble();
}

// While the program on the controller brakes the arm, it does not read commands.
TEST_P(UrArmTest, LongBrakingDoesNotProveThatItIsDeaf) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(300, 3.0);
  ASSERT_DOUBLE_EQ(bench.speed(), 3.0);
  bench.Ticks(200, 0, false);
  EXPECT_GT(bench.speed(), 0.5);
  bench.Ticks(300, 0, false);
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_TRUE(bench.read.ok()) << bench.arm->Trouble();
}

TEST_P(UrArmTest, RepeatedPackageDoesNotRefreshItsAge) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(100, 0);
  bench.fake.Do("repeat");
  bench.Tick(0);
  const std::uint64_t last = bench.reading.sequence;
  bench.Ticks(100, 0);
  EXPECT_GE(bench.reading.age, 0.099);
  EXPECT_EQ(bench.reading.sequence, last);
}

TEST_P(UrArmTest, AnEarlierTimeIsNotANewSample) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(100, 0);
  bench.fake.Do("rewind");
  bench.Tick(0);
  const std::uint64_t last = bench.reading.sequence;
  bench.Ticks(100, 0);
  EXPECT_GE(bench.reading.age, 0.099);
  EXPECT_EQ(bench.reading.sequence, last);
  bench.Ticks(100, 0);
  EXPECT_NE(bench.arm->Trouble().find("has restarted its clock, as after a reboot"),
            std::string::npos);
  bench.Ticks(1000, 0);  // the clock has passed its previous value
  EXPECT_EQ(bench.arm->Trouble(), "");
}

TEST_P(UrArmTest, ARepeatedPackageIsNotARestartedClock) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(100, 0);
  bench.fake.Do("repeat");
  bench.Ticks(400, 0);
  EXPECT_EQ(bench.arm->Trouble(), "");
}

TEST_P(UrArmTest, TextOfTheControllerChangesNothing) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(20, 0.1);
  bench.fake.Do("text");
  bench.Ticks(50, 0.1);
  EXPECT_TRUE(bench.read.ok());
  EXPECT_DOUBLE_EQ(bench.speed(), 0.1);
}

TEST(UrArm, WrenchBeyondAnySensorIsSaturated) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double f : {501.0, -501.0, inf, -inf, std::nan("")}) {
    UrBench bench;
    bench.mechanics.sample.F_S_raw[1] = f;
    bench.Connect().Ticks(20, 0);
    EXPECT_TRUE(bench.reading.wrench.saturated) << f;
  }
  UrBench bench;
  bench.mechanics.sample.F_S_raw[4] = -101;
  bench.Connect().Ticks(20, 0);
  EXPECT_TRUE(bench.reading.wrench.saturated);
}

TEST_P(UrArmTest, CountsMissingPackages) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(100, 0);
  EXPECT_EQ(bench.reading.link.lost, 0U);
  bench.fake.Do("freeze");
  bench.Ticks(5 * period(), 0);
  bench.fake.Do("thaw");
  bench.Ticks(100, 0);
  EXPECT_EQ(bench.reading.link.lost, 5U);
  bench.fake.Do("freeze");  // a pause does not count as a loss
  bench.Ticks(1100, 0);
  bench.fake.Do("thaw");
  bench.Ticks(100, 0);
  EXPECT_EQ(bench.reading.link.lost, 5U);
}

// Each packet arrives in two parts that are a millisecond apart.
TEST(UrArm, StreamCutAtAnyByteGivesTheSameSamples) {
  const std::size_t package =
      rtde::kHeaderSize + 1 + rtde::SizeOf(UrOutputs(0, {true, false, true}));
  for (std::size_t cut = 0; cut <= package + 1; ++cut) {
    UrBench bench;
    bench.ConnectThroughProxy();
    bench.proxy.HoldBack(cut);
    std::uint64_t last = 0;
    for (int i = 0; i < 100; ++i) {
      bench.mechanics.sample.q[0] += 0.001;
      bench.Tick(0.0);
      ASSERT_TRUE(bench.read.ok()) << cut;
      ASSERT_GE(bench.reading.sequence, last);
      last = bench.reading.sequence;
    }
    EXPECT_NEAR(bench.reading.q[0], bench.mechanics.sample.q[0], 0.005) << cut;
    EXPECT_LE(bench.reading.age, 0.004) << cut;
  }
}

TEST(UrArm, DoesNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  for (const char* fault : {"text", "late 10", "repeat", "rewind", "protective stop", "power off",
                            "not a number", "stop program", "freeze", "malformed", "drop link"}) {
    UrBench bench;
    bench.ConnectThroughProxy();
    JointVector v = JointVector::Constant(kUrJoints, 0.1);
    std::int64_t taken = 0;
    for (int i = 0; i < 400; ++i) {
      if (i == 200) {
        ASSERT_TRUE(bench.fake.Do(fault));
      }
      const test::AllocationGuard guard;
      bench.read = bench.arm->Read(&bench.reading);
      bench.written = bench.arm->Write(v, i % 50 < 40);
      taken += guard.count();
      bench.Pass();
    }
    EXPECT_EQ(taken, 0) << fault;
  }
}

TEST(UrArm, EndsItsProgramWhenItIsDestroyed) {
  UrBench bench;
  bench.Connect().Ticks(100, 0.3);
  bench.arm.reset();
  bench.network.Pass(0.010);
  EXPECT_LT(bench.speed(), 0.29);  // on command, before its time-out
  bench.network.Pass(0.2);
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_FALSE(bench.fake.running());
  bench.Connect().Ticks(100, 0.2);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.2);
}

TEST_P(UrArmTest, ListensToAnArmThatAnotherProgramMoves) {
  UrBench bench(GetParam());
  bench.fake.Do("local control");
  bench.fake.Do("freedrive");
  bench.fake.rtde().in_use = {"input_double_register_24"};  // of another client
  bench.Connect({.host = kUrHost, .listen = true});
  EXPECT_FALSE(bench.fake.running());  // without our program
  bench.mechanics.sample.q[1] = 0.7;   // moved by hand
  bench.Ticks(200, 0, false);
  EXPECT_TRUE(bench.read.ok());
  EXPECT_TRUE(bench.written.ok());
  EXPECT_DOUBLE_EQ(bench.reading.q[1], 0.7);
  EXPECT_LT(bench.reading.age, 0.01);
  EXPECT_TRUE(bench.reading.fault);  // it cannot move
  EXPECT_NE(bench.arm->Trouble().find("is in free-drive"), std::string::npos);
  EXPECT_EQ(bench.reading.inputs, 0U);
  bench.fake.Do("freedrive off");
  bench.fake.Do("slider 50");  // the other client sets it
  bench.fake.Do("press 9");
  bench.Ticks(20, 0, false);
  EXPECT_EQ(bench.reading.inputs, 1U << 9);
  EXPECT_FALSE(bench.reading.fault);
  EXPECT_EQ(bench.arm->Trouble(), "");
  bench.Ticks(20, 0.3);  // a listener cannot move the arm
  EXPECT_EQ(bench.written.cause, StopCause::kDevice);
  EXPECT_EQ(bench.speed(), 0);
}

INSTANTIATE_TEST_SUITE_P(Controllers, UrArmTest, UrControllers(),
                         [](const auto& controller) { return NameOfController(controller.param); });

}  // namespace
}  // namespace predictor
