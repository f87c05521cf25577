#include "devices/franka/franka_arm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/random.h"
#include "devices/franka/rate_limiter.h"
#include "devices/franka_rig.h"
#include "support/constants.h"
#include "support/soak.h"

namespace predictor {
namespace {

Quaternion AnyRotation(RandomStream* random) {
  const Quaternion q(random->Normal(), random->Normal(), random->Normal(), random->Normal());
  return q.normalized();
}

class FrankaDriver : public testing::TestWithParam<std::uint16_t> {
 protected:
  FrankaDriver() : rig_(FrankaOfVersion(GetParam())) {}
  FrankaRig rig_;
};

TEST_P(FrankaDriver, FindsTheVersionAndDescribesTheArm) {
  rig_.Connect();
  const DeviceFacts& facts = rig_.arm->facts();
  EXPECT_EQ(facts.joints, 7);
  EXPECT_EQ(facts.rate, 1000);
  EXPECT_EQ(facts.watchdog, 0.020);
  EXPECT_TRUE(facts.own_wrench);
  EXPECT_NE(facts.name.find(GetParam() == 5 ? "Panda" : "Research 3"), std::string::npos);
  EXPECT_NE(facts.name.find("never run on hardware"), std::string::npos);
  EXPECT_TRUE(rig_.read.ok());
  EXPECT_EQ(rig_.arm->Trouble(), "");
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(rig_.reading.q[i], rig_.mechanics.sample.q[i], 1e-6);
  EXPECT_EQ(rig_.reading.age, 0);
  EXPECT_FALSE(rig_.reading.fault);
}

// After a command to rest, the driver brings the arm to rest within the jerk limit. Whichever
// commands are lost, the driver must report motion until the arm can no longer move.
TEST_P(FrankaDriver, IsInMotionUntilNothingButRestFollows) {
  rig_.Connect();
  EXPECT_FALSE(rig_.reading.in_motion);
  double sent = 0;
  rig_.fake.on_command = [&](const fci::PandaCommand& command) {
    for (std::size_t i = 0; i < 7; ++i) sent = std::max(sent, std::abs(command.dq_c[i]));
  };
  for (int lost = 0; lost < 12; ++lost) {
    rig_.v << 0.01, -0.004, 0.002, 0.005, -0.002, 0.01, 0.003;
    ASSERT_TRUE(rig_.Ticks(40));
    EXPECT_TRUE(rig_.reading.in_motion) << lost;
    rig_.v.setZero();
    for (int tick = 0; tick < 100; ++tick) {
      ASSERT_TRUE(tick != lost || rig_.fake.Do("lose commands 2"));
      ASSERT_TRUE(rig_.Tick());
      EXPECT_TRUE(tick > 0 || rig_.reading.in_motion) << lost;
      if (!rig_.reading.in_motion) break;
    }
    EXPECT_FALSE(rig_.reading.in_motion) << lost;
    sent = 0;
    ASSERT_TRUE(rig_.Ticks(50, false));
    EXPECT_EQ(sent, 0) << lost;
    ASSERT_TRUE(rig_.Ticks(100, false));
  }
}

TEST_P(FrankaDriver, WaitsUntilItsControllerHasBegun) {
  ASSERT_TRUE(rig_.fake.Do("start late 100"));
  rig_.Connect();
  EXPECT_TRUE(rig_.reading.waits);
  rig_.v.setConstant(0.01);
  ASSERT_TRUE(rig_.Ticks(98));
  EXPECT_TRUE(rig_.reading.waits);
  ASSERT_TRUE(rig_.Ticks(10));
  EXPECT_FALSE(rig_.reading.waits);
  rig_.v.setZero();
  ASSERT_TRUE(rig_.Ticks(200, false));
  EXPECT_TRUE(rig_.reading.waits);
}

TEST_P(FrankaDriver, DoesNotWaitForAFaultyArm) {
  rig_.Connect();
  rig_.v.setConstant(0.05);
  ASSERT_TRUE(rig_.Ticks(40));
  EXPECT_TRUE(rig_.reading.in_motion);
  ASSERT_TRUE(rig_.fake.Do("emergency stop"));
  EXPECT_FALSE(rig_.Ticks(5));
  EXPECT_FALSE(rig_.reading.in_motion);
}

// Without this limit, a caller that waits for rest would wait forever.
TEST_P(FrankaDriver, GivesUpAnArmThatReportsMotionAfterACommandToRest) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(50));
  ASSERT_TRUE(rig_.fake.Do("say it moves"));
  ASSERT_TRUE(rig_.Ticks(900));
  EXPECT_TRUE(rig_.reading.in_motion);
  EXPECT_FALSE(rig_.Ticks(200));
  EXPECT_NE(rig_.arm->Trouble().find("did not end its motion"), std::string::npos)
      << rig_.arm->Trouble();
}

TEST_P(FrankaDriver, ReportsItsLimits) {
  rig_.Connect();
  const DeviceFacts& facts = rig_.arm->facts();
  const fci::JointLimits& published = fci::PublishedLimits(GetParam() == 5 ? 5 : 10);
  ASSERT_EQ(facts.acceleration.size(), 7U);
  ASSERT_EQ(facts.velocity.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(facts.acceleration[i], 0.95 * published[i].acceleration, 1e-9);
    EXPECT_NEAR(facts.velocity[i], 0.95 * published[i].velocity, 1e-9);
  }
}

TEST_P(FrankaDriver, MovesAsCommandedAndEndsTheMotion) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(50, false));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kIdle);  // no motion without a request
  EXPECT_EQ(rig_.arm->counts().commands, 0U);
  const JointVector start = rig_.mechanics.sample.q;
  rig_.v << 0.1, -0.1, 0.2, 0.05, -0.2, 0.1, 0.3;
  ASSERT_TRUE(rig_.Ticks(1010));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kMove);
  EXPECT_NEAR((rig_.reading.v - rig_.v).norm(), 0, 1e-6);
  // The arm moves at that speed for one second, minus a few milliseconds for the start and the time
  // v/a + a/j of the ramp.
  for (int i = 0; i < 7; ++i) {
    const double way = rig_.mechanics.sample.q[i] - start[i];
    EXPECT_NEAR(way, rig_.v[i], std::abs(rig_.v[i]) * 0.03) << i;
  }
  ASSERT_TRUE(rig_.Ticks(200, false));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kIdle);
  EXPECT_EQ(rig_.fake.log().back(), "motion ended with status 0");
  EXPECT_EQ(rig_.reading.v.norm(), 0);
  // The driver must answer the first state of a motion, so that no command is lost.
  EXPECT_EQ(rig_.fake.lost_commands(), 0U);
  EXPECT_EQ(rig_.arm->counts().lost_commands, 0U);
  // The second motion must work in the same way.
  ASSERT_TRUE(rig_.Ticks(100));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kMove);
  ASSERT_TRUE(rig_.Ticks(200, false));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kIdle);
}

TEST_P(FrankaDriver, EndsAMotionThatWasNotYetBegun) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Tick(true));
  ASSERT_TRUE(rig_.Ticks(50, false));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kIdle);
  // The test requests motion or rest at random in every millisecond.
  RandomStream random(1, "toggle");
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(rig_.Tick(random.Next() % 2 == 0)) << i;
  ASSERT_TRUE(rig_.Ticks(300, false));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kIdle);
}

// The arm has not come to rest, so its motion has not ended and must not be started again.
TEST_P(FrankaDriver, ContinuesWhenCommandedBeforeItIsAtRest) {
  rig_.Connect();
  rig_.v.setConstant(0.2);
  ASSERT_TRUE(rig_.Ticks(200));
  ASSERT_TRUE(rig_.Ticks(5, false));
  ASSERT_TRUE(rig_.Ticks(60));
  EXPECT_NEAR((rig_.reading.v - rig_.v).norm(), 0, 1e-6);
  for (const std::string& line : rig_.fake.log())
    EXPECT_EQ(line.find("motion ended"), std::string::npos) << line;
}

TEST_P(FrankaDriver, StopsWithinTheLimits) {
  rig_.Connect();
  rig_.v.setConstant(0.5);
  ASSERT_TRUE(rig_.Ticks(200));
  rig_.v.setZero();
  int ticks = 0;
  for (; rig_.mechanics.command.cwiseAbs().maxCoeff() > 1e-9 && ticks < 1000; ++ticks)
    ASSERT_TRUE(rig_.Tick());
  // The slowest joint needs the time v/a + a/j, where a is 95 % of 7.5 rad/s² or 10 rad/s².
  // Transmission takes two further ticks.
  const double a = 0.95 * (GetParam() == 5 ? 7.5 : 10);
  EXPECT_NEAR(1e-3 * ticks, 0.5 / a + 0.002, 0.004);
}

// A NaN in any joint invalidates the whole command.
TEST_P(FrankaDriver, ANanForOneJointBrakesAllJoints) {
  rig_.Connect();
  rig_.v.setConstant(0.2);
  ASSERT_TRUE(rig_.Ticks(200));
  EXPECT_NEAR(rig_.mechanics.command.minCoeff(), 0.2, 1e-9);
  rig_.v[4] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(rig_.Ticks(200));
  EXPECT_NEAR(rig_.mechanics.command.cwiseAbs().maxCoeff(), 0, 1e-9);
}

// The arm's own control must accept any sequence of requests and the loss of any message.
TEST_P(FrankaDriver, IsNeverStoppedByAReflexWhateverIsAskedSoak) {
  for (long seed = 0; seed < Count(6, 400); ++seed) {
    FrankaRig rig(FrankaOfVersion(GetParam()));
    RandomStream random(static_cast<std::uint64_t>(seed), "asked");
    const FrankaLimits& limits = FrankaLimitsOf(GetParam());
    for (int i = 0; i < 7; ++i) {
      const FrankaJointLimit& l = limits[static_cast<std::size_t>(i)];
      rig.mechanics.sample.q[i] = l.lower + 0.05 + (l.upper - l.lower - 0.1) * random.Uniform();
    }
    rig.Connect();
    int quiet = 0;
    for (int tick = 0; tick < 4000; ++tick) {
      if (random.Next() % 100 == 0)
        for (double& v : rig.v) v = random.Next() % 4 == 0 ? 50 * random.Normal() : random.Normal();
      if (random.Next() % 400 == 0 && rig.v.size() == 7)
        rig.v[static_cast<int>(random.Next() % 7)] = kNan;
      if (random.Next() % 900 == 0) rig.v.setZero(random.Next() % 2 == 0 ? 7 : 3);
      if (rig.v.size() != 7 && random.Next() % 20 == 0) rig.v.setZero(7);
      // Messages of one kind at a time are lost, for at most 19 milliseconds.
      if (--quiet < 0 && random.Next() % 60 == 0) {
        const auto count = std::to_string(1 + random.Next() % 9);
        const std::string what[] = {"lose states " + count,
                                    "lose commands " + count,
                                    "repeat state",
                                    "swap states",
                                    "cut state",
                                    "spoil state"};
        ASSERT_TRUE(rig.fake.Do(what[random.Next() % 6]));
        quiet = 12;
      }
      const bool ok = rig.Tick(tick % 2000 < 1800);
      ASSERT_TRUE(ok) << "seed " << seed << ", tick " << tick << ": " << rig.arm->Trouble();
    }
    EXPECT_GT(rig.arm->counts().malformed, 0U);
    EXPECT_GT(rig.fake.lost_commands(), 0U);
  }
}

// The test checks the differences between the commands that arrive at the arm without losses,
// independently of the driver.
TEST_P(FrankaDriver, SendsDifferencesWithinTheLimits) {
  rig_.Connect();
  const FrankaLimits& limits = FrankaLimitsOf(GetParam());
  FrankaJoints v{}, a{};
  std::uint64_t last_id = 0, heard = 0;
  rig_.fake.on_command = [&](const fci::PandaCommand& command) {
    EXPECT_TRUE(last_id == 0 || command.message_id == last_id + 1);  // one command for each state
    last_id = command.message_id;
    ++heard;
    for (std::size_t i = 0; i < 7; ++i) {
      const double v_now = command.dq_c[i], a_now = (v_now - v[i]) / 1e-3;
      EXPECT_LE(std::abs(a_now), limits[i].acceleration) << i;
      EXPECT_LE(std::abs(a_now - a[i]) / 1e-3, limits[i].jerk) << i;
      EXPECT_LE(std::abs(v_now), limits[i].velocity) << i;
      v[i] = v_now;
      a[i] = a_now;
    }
  };
  RandomStream random(8, "differences");
  for (int tick = 0; tick < 3000; ++tick) {
    if (tick % 150 == 0)
      for (double& asked : rig_.v) asked = 3 * random.Normal();
    ASSERT_TRUE(rig_.Tick());
  }
  EXPECT_GT(heard, 2980U);
}

TEST_P(FrankaDriver, AfterAMissedStateDoesNotGoFaster) {
  rig_.Connect();
  rig_.v.setConstant(1);
  ASSERT_TRUE(rig_.Ticks(60));
  ASSERT_TRUE(rig_.fake.Do("lose states 1"));
  const FrankaJoints a = rig_.fake.motion().a();
  ASSERT_GT(a[0], 1);
  ASSERT_TRUE(rig_.Ticks(2));  // the tick without a state, and the one after it
  rig_.network.Pass(1e-3);
  for (std::size_t i = 0; i < 7; ++i) {
    const double step = FrankaLimitsOf(GetParam())[i].jerk * 1e-3;
    EXPECT_LE(rig_.fake.motion().a()[i], std::max(0.0, a[i] - 0.9 * step)) << i;
  }
  EXPECT_EQ(rig_.arm->counts().missed_states, 1U);
}

// While states are lost, the driver does not accelerate. When states arrive again, the driver must
// not jump to the velocity that was requested meanwhile.
TEST_P(FrankaDriver, CatchesUpWithoutAJumpAfterWaiting) {
  constexpr double kRate = 0.5, kStep = kRate * 1e-3;  // [rad/s²], [rad/s]
  rig_.Connect();
  const auto tick = [&] {
    rig_.v.array() += kStep;
    ASSERT_TRUE(rig_.Tick());
  };
  for (int k = 0; k < 300; ++k) tick();
  for (int lost = 0; lost < 4; ++lost) {
    ASSERT_TRUE(rig_.fake.Do("lose states 1"));
    for (int k = 0; k < 2; ++k) tick();
  }
  const double behind = rig_.v[0] - rig_.fake.motion().v()[0];
  ASSERT_GT(behind, 4 * kStep);
  double before = rig_.fake.motion().v()[0];
  for (int k = 0; k < 40; ++k) {
    tick();
    const double now = rig_.fake.motion().v()[0];
    EXPECT_LT(now - before, 2 * kStep) << k;
    before = now;
  }
  EXPECT_NEAR(before, rig_.v[0], 3 * kStep);
}

TEST_P(FrankaDriver, CountsTheCommandsThatTheArmDidNotUse) {
  rig_.Connect();
  rig_.v.setConstant(0.6);
  ASSERT_TRUE(rig_.Ticks(30));
  // The lost commands are the first ones that no longer accelerate.
  rig_.v.setZero();
  ASSERT_TRUE(rig_.fake.Do("lose commands 4"));
  ASSERT_TRUE(rig_.Ticks(10));
  EXPECT_EQ(rig_.fake.lost_commands(), 4U);
  EXPECT_EQ(rig_.arm->counts().lost_commands, 4U);
}

TEST_P(FrankaDriver, ReportsTheAgeOfItsReadings) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(20, false));
  const std::uint64_t sequence = rig_.reading.sequence;
  EXPECT_EQ(rig_.reading.age, 0);
  rig_.fake.Do("lose states 7");
  for (int i = 1; i <= 7; ++i) {
    ASSERT_TRUE(rig_.Tick(false));
    EXPECT_NEAR(rig_.reading.age, 1e-3 * i, 1e-5);
    EXPECT_EQ(rig_.reading.sequence, sequence);
  }
  ASSERT_TRUE(rig_.Tick(false));
  EXPECT_NEAR(rig_.reading.age, 0, 1e-5);
  EXPECT_EQ(rig_.reading.sequence, sequence + 8);
  EXPECT_EQ(rig_.arm->counts().missed_states, 7U);
}

TEST_P(FrankaDriver, ALateStateIsOld) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(20, false));
  rig_.fake.Do("delay states 8");
  ASSERT_TRUE(rig_.Ticks(12, false));  // states arrive again, each 8 ms late
  EXPECT_NEAR(rig_.reading.age, 8e-3, 1e-4);
}

TEST_P(FrankaDriver, ARepeatedStateIsNotFresh) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(20, false));
  const FrankaCounts before = rig_.arm->counts();
  rig_.fake.Do("repeat state");
  ASSERT_TRUE(rig_.Tick(false));
  EXPECT_EQ(rig_.arm->counts().old_states, before.old_states + 1);
  EXPECT_EQ(rig_.arm->counts().states, before.states + 1);
}

TEST_P(FrankaDriver, NeverUsesAnOlderState) {
  rig_.Connect();
  rig_.v.setConstant(0.2);
  ASSERT_TRUE(rig_.Ticks(50));
  const FrankaCounts before = rig_.arm->counts();
  const std::uint64_t sequence = rig_.reading.sequence;
  rig_.fake.Do("swap states");
  ASSERT_TRUE(rig_.Tick());
  EXPECT_EQ(rig_.reading.sequence, sequence);
  ASSERT_TRUE(rig_.Tick());
  EXPECT_EQ(rig_.reading.sequence, sequence + 2);
  EXPECT_EQ(rig_.arm->counts().old_states, before.old_states + 1);
  EXPECT_EQ(rig_.arm->counts().commands, before.commands + 1);
}

TEST_P(FrankaDriver, DropsAndCountsInvalidStates) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(5, false));
  const std::uint64_t sequence = rig_.reading.sequence;
  for (const char* what : {"cut state", "spoil state"}) {
    ASSERT_TRUE(rig_.fake.Do(what));
    ASSERT_TRUE(rig_.Tick(false));
    EXPECT_TRUE(rig_.reading.q.allFinite());
  }
  EXPECT_EQ(rig_.reading.sequence, sequence);
  EXPECT_NEAR(rig_.reading.age, 2e-3, 1e-5);
  EXPECT_EQ(rig_.arm->counts().malformed, 2U);
}

// In one state message, a single bit of the message's number is wrong. The driver must discard that
// message and use the later ones.
TEST_P(FrankaDriver, DropsAStateWhoseNumberJumps) {
  FrankaRig rig(FrankaOfVersion(GetParam()));
  rig.Connect();
  ASSERT_TRUE(rig.Ticks(100));
  ASSERT_TRUE(rig.fake.Do("leap"));
  EXPECT_TRUE(rig.Ticks(200));
  EXPECT_NEAR(rig.reading.age, 0, 1e-5);
  EXPECT_EQ(rig.arm->counts().malformed, 1U);
  EXPECT_EQ(rig.arm->counts().old_states, 0U);
}

TEST_P(FrankaDriver, ContinuesCountingWhenTheArmsNumbersWrap) {
  FakeFrankaOptions options = FrankaOfVersion(GetParam());
  options.first_message = std::numeric_limits<std::uint64_t>::max() - 100;
  FrankaRig rig(options);
  rig.Connect();
  rig.v.setConstant(0.1);
  std::uint64_t sequence = rig.reading.sequence;
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(rig.Tick());
    ASSERT_EQ(rig.reading.sequence, ++sequence);
    ASSERT_NEAR(rig.reading.age, 0, 1e-5);
  }
  EXPECT_EQ(rig.arm->counts().missed_states + rig.arm->counts().old_states, 0U);
}

// The result must be the handle's wrench on the sensor, for any pose of the sensor in the flange.
TEST_P(FrankaDriver, TurnsTheArmsEstimateIntoTheHandlesWrench) {
  RandomStream random(4, "frames");
  for (int round = 0; round < 20; ++round) {
    FakeFrankaOptions fake = FrankaOfVersion(GetParam());
    fake.X_FS.p = 0.1 * Vector3(random.Normal(), random.Normal(), random.Normal());
    fake.X_FS.q = AnyRotation(&random);
    FrankaRig rig(fake);
    FrankaOptions options = rig.options();
    options.X_FS = fake.X_FS;
    for (double& f : rig.mechanics.sample.F_S_raw) f = 5 * random.Normal();
    rig.Connect(options);
    const WrenchReading& w = rig.reading.wrench;
    EXPECT_NEAR((w.F_S - rig.mechanics.sample.F_S_raw).norm(), 0, 1e-5);
    EXPECT_EQ(w.age, 0);
    EXPECT_EQ(w.sequence, rig.reading.sequence);
    EXPECT_FALSE(w.saturated);
  }
}

TEST_P(FrankaDriver, HasNoWrenchBeforeTheFirst) {
  FrankaRig rig(FrankaOfVersion(GetParam()));
  rig.mechanics.sample.F_S_raw.setZero();  // an arm reports zero near a singular pose
  rig.Connect();
  ASSERT_TRUE(rig.Ticks(50, false));
  EXPECT_EQ(rig.reading.wrench.sequence, 0U);
  EXPECT_GT(rig.reading.wrench.age, 1e8);
}

TEST_P(FrankaDriver, HasNoFreshWrenchNearASingularPose) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(5, false));
  const Wrench last = rig_.reading.wrench.F_S;
  const std::uint64_t sequence = rig_.reading.wrench.sequence;
  rig_.mechanics.sample.F_S_raw.setZero();  // the arm then reports zero
  ASSERT_TRUE(rig_.Ticks(10, false));
  EXPECT_EQ(rig_.reading.wrench.F_S, last);
  EXPECT_EQ(rig_.reading.wrench.sequence, sequence);
  EXPECT_NEAR(rig_.reading.wrench.age, 10e-3, 1e-5);
  EXPECT_NEAR(rig_.reading.age, 0, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Versions, FrankaDriver,
                         testing::Values(fci::kPandaVersion, fci::kResearch3Version),
                         [](const auto& version) { return ControllerName(version.param); });

TEST(FrankaDriverEarly, ReadsTheStatesOfAnOlderResearch3) {
  FakeFrankaOptions options;
  options.early = true;
  FrankaRig rig(options);
  rig.Connect();
  rig.v.setConstant(0.1);
  ASSERT_TRUE(rig.Ticks(500));
  EXPECT_NEAR(rig.reading.v[3], 0.1, 1e-6);
  EXPECT_NE(rig.arm->facts().name.find("1233"), std::string::npos);
}

}  // namespace
}  // namespace predictor
