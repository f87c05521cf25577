#include "devices/ur/ur_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "devices/ur/ur_script.h"
#include "devices/ur_bench.h"
#include "devices/wire/device_clock.h"
#include "support/allocation_guard.h"
#include "support/test_name.h"

namespace predictor {
namespace {

using testing::Values;

class UrArmTest : public testing::TestWithParam<FakeUrOptions> {
 protected:
  int period() const { return GetParam().version.major == 3 ? 8 : 2; }  // sample period [ms]
};

TEST_P(UrArmTest, SaysWhatItFound) {
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
  bench.Ticks(100, 0.3);  // a person armed it again; there was no fault
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

TEST_P(UrArmTest, ReadsWhatTheArmIs) {
  UrBench bench(GetParam());
  bench.mechanics.sample.F_S_raw << 1, -2, 3, -0.4, 0.5, -0.6;
  bench.mechanics.sample.q << 0.1, 0.2, 0.3, -0.4, -0.5, 7;
  bench.Connect().Ticks(100, 0.25);
  // The last package is at most one cycle old.
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
  bench.Tick(0);  // one package may have been in transit
  const double age = bench.reading.age;
  bench.Ticks(100, 0);
  EXPECT_NEAR(bench.reading.age, age + 0.1, 1e-9);
  const bool own = bench.arm->facts().own_wrench;
  EXPECT_EQ(bench.reading.wrench.age, own ? bench.reading.age : WrenchReading().age);
  EXPECT_LE(bench.reading.sequence, last + 1);
  EXPECT_TRUE(bench.read.ok());  // other parts decide when it is too old
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

// A sample that old tells us nothing about what the arm is receiving now.
TEST_P(UrArmTest, LatePackagesAreNoProofThatItIsDeaf) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(500, 0);
  bench.fake.Do("late 200");
  bench.Ticks(500, 0);
  EXPECT_GE(bench.reading.age, 0.199);
  EXPECT_TRUE(bench.read.ok()) << bench.arm->Trouble();
}

// While the program on the controller brakes, it does not read commands.
TEST_P(UrArmTest, LongBrakingIsNoProofThatItIsDeaf) {
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

TEST_P(UrArmTest, TimeThatGoesBackIsNoNews) {
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
  bench.Ticks(1000, 0);  // it has passed its previous value
  EXPECT_EQ(bench.arm->Trouble(), "");
}

TEST_P(UrArmTest, PackageThatComesForEverIsNoTimeThatBeginsAnew) {
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

// The process dies at any phase of both cycles.
TEST_P(UrArmTest, ArmBrakesByItselfWhenNothingIsWrittenAndStaysStanding) {
  for (int phase = 0; phase < 16; ++phase) {
    UrBench bench(GetParam());
    bench.Connect().Ticks(200 + phase, 0.5);
    int silent = 0;
    while (bench.speed() >= 0.5 && silent < 1000) bench.Pass(), ++silent;
    EXPECT_LE(silent, 20) << phase;
    for (int i = 0; i < 100; ++i) bench.Pass();
    EXPECT_EQ(bench.speed(), 0);
    // The process continues.
    bench.Ticks(1, 0.5);
    EXPECT_EQ(bench.read.cause, StopCause::kDevice);
    EXPECT_NE(bench.arm->Trouble().find("received no command"), std::string::npos);
    bench.Ticks(200, 0.5);
    EXPECT_EQ(bench.speed(), 0);
    EXPECT_FALSE(bench.fake.running());
  }
}

struct Fault {
  const char* what;
  const char* trouble;
};

class UrFaultTest : public testing::TestWithParam<std::tuple<FakeUrOptions, Fault>> {};

TEST_P(UrFaultTest, IsToldWithinACycleForGoodAndTheArmStands) {
  const auto& [options, fault] = GetParam();
  UrBench bench(options);
  bench.Connect().Ticks(100, 0.3);
  ASSERT_TRUE(bench.read.ok());
  ASSERT_TRUE(bench.fake.Do(fault.what));
  const int cycle = options.version.major == 3 ? 8 : 2;
  bench.Ticks(cycle + 1, 0.3);
  EXPECT_EQ(bench.read.cause, StopCause::kDevice);
  EXPECT_EQ(bench.written.cause, StopCause::kDevice);
  EXPECT_TRUE(bench.reading.fault);
  const std::string trouble = bench.arm->Trouble();
  EXPECT_NE(trouble.find(fault.trouble), std::string::npos) << trouble;
  EXPECT_EQ(trouble.find(kUrHost), 0U);
  // The position of this arm is unknown, but it still obeys, so the stop brings it to rest.
  bench.Ticks(200, fault.what == std::string("not a number") ? 0 : 0.3);
  EXPECT_EQ(bench.speed(), 0);
  // A person clears the fault and resumes the program: the arm must not move.
  for (const char* cure : {"unlock", "freedrive off", "play"}) bench.fake.Do(cure);
  for (int i = 0; i < 300; ++i) {
    bench.Tick(0.3);
    ASSERT_EQ(bench.speed(), 0);
  }
  EXPECT_EQ(bench.read.cause, StopCause::kDevice);
  EXPECT_EQ(bench.arm->Trouble(), trouble);
  EXPECT_FALSE(bench.fake.running());
}

// The following stop may bring the arm to rest, but must not move it for long or again.
TEST(UrArm, WhoseNumbersAreNoneFollowsOneStopOnly) {
  for (const int stop : {100, 1000}) {
    UrBench bench;
    bench.Connect().Ticks(100, 0.3);
    bench.fake.Do("not a number");
    bench.Ticks(50, 0.2);
    EXPECT_EQ(bench.read.cause, StopCause::kDevice);
    EXPECT_DOUBLE_EQ(bench.speed(), 0.2);
    bench.Ticks(stop - 50, 0.2);
    EXPECT_EQ(bench.speed() > 0, stop < 500);
    bench.Ticks(100, 0);
    bench.Ticks(100, 0.2);
    EXPECT_EQ(bench.speed(), 0);
  }
}

TEST(UrArm, TellsWhetherItMayBeLeftHolding) {
  const std::vector<std::pair<const char*, bool>> ends = {
      {"protective stop", false}, {"emergency stop", true}, {"drop link", true},
      {"malformed", true},        {"stop program", false},  {"not a number", false}};
  for (const auto& [what, power_off] : ends) {
    UrBench bench;
    bench.Connect().Ticks(50, 0.1);
    bench.fake.Do(what);
    bench.Ticks(20, 0);
    EXPECT_EQ(bench.read.cause, StopCause::kDevice) << what;
    EXPECT_EQ(bench.read.power_off, power_off) << what;
    EXPECT_EQ(bench.written.power_off, power_off) << what;
  }
}

const auto kControllers = Values(ESeries(), Cb3(3));
const auto kFaults =
    Values(Fault{"protective stop", "protective stop"}, Fault{"emergency stop", "emergency stop"},
           Fault{"safeguard stop", "safeguard stop"}, Fault{"power off", "not powered"},
           Fault{"freedrive", "is in free-drive"}, Fault{"slider 80", "speed slider to 100 %"},
           Fault{"stop program", "no longer runs"}, Fault{"pause program", "no longer runs"},
           Fault{"drop link", "closed the connection"}, Fault{"malformed", "not RTDE"},
           Fault{"not a number", "sends impossible joint angles"});
std::string NameOf(const FakeUrOptions& options) {
  return options.version.major == 3 ? "Cb3" : "ESeries";
}
INSTANTIATE_TEST_SUITE_P(Controllers, UrArmTest, kControllers,
                         [](const auto& controller) { return NameOf(controller.param); });
std::string NameOfCase(const testing::TestParamInfo<std::tuple<FakeUrOptions, Fault>>& c) {
  return NameOf(std::get<0>(c.param)) + "_" + test::TestName(std::get<1>(c.param).what);
}
INSTANTIATE_TEST_SUITE_P(Controllers, UrFaultTest, testing::Combine(kControllers, kFaults),
                         NameOfCase);

TEST(UrArm, ProgramThatHearsNothingEndsAndThatIsAFault) {
  UrBench bench;
  bench.Connect().Ticks(100, 0.0);
  bench.fake.Do("deaf");
  int ticks = 0;
  for (; ticks < 200 && bench.read.ok(); ++ticks) bench.Tick(0);
  EXPECT_LE(ticks, 25);
  EXPECT_NE(bench.arm->Trouble().find("received no command"), std::string::npos);
}

TEST(UrArm, ProgramThatRunsOnWithoutHearingIsAFault) {
  UrBench bench;
  bench.Connect();
  bench.fake.Do("deaf");  // before the first command, so the program waits and does not end
  int ticks = 0;
  for (; ticks < 1000 && bench.read.ok(); ++ticks) bench.Tick(0);
  EXPECT_NEAR(ticks, 100, 10);
  EXPECT_NE(bench.arm->Trouble().find("accepts no commands"), std::string::npos);
}

TEST(UrArm, WhatIsNotSixFiniteNumbersIsNotSent) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const JointVector& v :
       {JointVector(JointVector::Zero(7)), JointVector(),
        JointVector(JointVector::Constant(6, nan)),
        JointVector(JointVector::Constant(6, std::numeric_limits<double>::infinity()))}) {
    UrBench bench;
    bench.Connect().Ticks(100, 0.3);
    bench.Tick(v, true);
    EXPECT_EQ(bench.written.cause, StopCause::kDevice);
    EXPECT_NE(bench.arm->Trouble().find("six finite numbers"), std::string::npos);
    bench.Ticks(200, 0.3);
    EXPECT_EQ(bench.speed(), 0);
  }
  UrBench bench;
  bench.Connect().Tick(JointVector(), false);  // no motion is requested
  EXPECT_TRUE(bench.written.ok());
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

// A peer that accepts no more data, although its own data still arrives.
class FullNetwork final : public Network {
 public:
  explicit FullNetwork(Network* inner) : inner_(inner) {}
  std::unique_ptr<Stream> Connect(const Address& peer, double timeout) override {
    return std::make_unique<FullStream>(inner_->Connect(peer, timeout), &full);
  }
  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) override {
    return inner_->Open(peer, port);
  }
  std::uint64_t Now() const noexcept override { return inner_->Now(); }
  void Wait(double time) override { inner_->Wait(time); }
  bool full = false;

 private:
  class FullStream final : public Stream {
   public:
    FullStream(std::unique_ptr<Stream> inner, const bool* full)
        : inner_(std::move(inner)), full_(full) {}
    int Read(std::span<std::byte> to) noexcept override { return inner_->Read(to); }
    bool Write(std::span<const std::byte> from) noexcept override {
      return !*full_ && inner_->Write(from);
    }

   private:
    std::unique_ptr<Stream> inner_;
    const bool* full_;
  };
  Network* inner_;
};

TEST(UrArm, WhatCannotBeSentIsAFaultAtOnce) {
  UrBench bench;
  FullNetwork network(&bench.network);
  bench.arm = ConnectUr({.host = kUrHost}, &network);
  bench.Ticks(100, 0.1);
  ASSERT_TRUE(bench.written.ok());
  network.full = true;
  bench.Ticks(3, 0.1);
  EXPECT_EQ(bench.written.cause, StopCause::kDevice);
  EXPECT_TRUE(bench.written.power_off);
  bench.Ticks(200, 0.1);
  EXPECT_EQ(bench.speed(), 0);
  bench.arm.reset();
}

TEST(UrArm, AListenerSendsNothing) {
  UrBench bench;
  FullNetwork network(&bench.network);
  bench.arm = ConnectUr({.host = kUrHost, .listen = true}, &network);
  network.full = true;  // so that a write would fail
  bench.Ticks(50, 0, false);
  EXPECT_TRUE(bench.read.ok() && bench.written.ok());
}

// A listener writes nothing, so only its reads can detect the closed connection.
TEST(UrArm, AListenersReadingTellsThatTheConnectionIsClosed) {
  UrBench bench;
  bench.Connect({.host = kUrHost, .listen = true}).Ticks(50, 0, false);
  ASSERT_TRUE(bench.read.ok());
  bench.fake.Do("drop link");
  bench.Ticks(2, 0, false);
  EXPECT_EQ(bench.read.cause, StopCause::kDevice);
  EXPECT_TRUE(bench.read.power_off);
  EXPECT_NE(bench.arm->Trouble().find("closed the connection"), std::string::npos);
}

TEST_P(UrArmTest, CountsPackagesThatWereLeftOut) {
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

// Each package arrives in two parts, a millisecond apart.
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

TEST(UrArm, TakesNothingFromTheHeap) {
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

TEST_P(UrArmTest, CutsThePowerWhenAsked) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(50, 0.1);
  EXPECT_FALSE(bench.reading.no_power_off);
  bench.arm->PowerOff(true);
  bench.Ticks(period() + 2, 0.1);
  EXPECT_EQ(bench.fake.controller().robot_mode, UrController::kPowerOff);
  EXPECT_NE(bench.arm->Trouble().find("not powered"), std::string::npos);
  bench.fake.controller().robot_mode = UrController::kRunning;  // a person switched it on
  for (int i = 0; i < 2000; ++i) {
    bench.arm->PowerOff(true);  // as in every tick of UNPOWERED; the request is not repeated
    bench.Tick(0, false);
    ASSERT_FALSE(bench.reading.keeps_power);
  }
  EXPECT_EQ(bench.fake.controller().robot_mode, UrController::kRunning);
}

// A stop requests power-off, and something prevents the robot from obeying.
TEST_P(UrArmTest, SaysThatItKeepsItsPower) {
  for (const char* why : {"no dashboard", "local control", "drop dashboard"}) {
    UrBench bench(GetParam());
    const bool none = why == std::string("no dashboard");
    bench.Connect({.host = kUrHost, .dashboard_port = std::uint16_t(none ? 0 : 29999)});
    bench.Ticks(50, 0);
    EXPECT_TRUE(none || bench.fake.Do(why));
    bench.arm->PowerOff(true);
    bench.Ticks(990, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power) << why;  // it may still obey
    bench.Ticks(30, 0, false);
    EXPECT_TRUE(bench.reading.keeps_power) << why;
    EXPECT_EQ(bench.reading.no_power_off, why == std::string("drop dashboard"));
    for (const std::int32_t mode : {UrController::kPowerOff + 1, 5, 6}) {  // on, idle, backdrive
      bench.fake.controller().robot_mode = mode;
      bench.Ticks(20, 0, false);
      EXPECT_TRUE(bench.reading.keeps_power) << why << mode;
    }
    bench.fake.Do("power off");  // finally by hand
    bench.Ticks(20, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power) << why;
  }
}

TEST_P(UrArmTest, KeepsItsPowerWhereTheStopIsReset) {
  UrBench bench(GetParam());
  bench.Connect({.host = kUrHost, .dashboard_port = 0}).Ticks(50, 0);
  for (int again = 0; again < 2; ++again) {
    bench.arm->PowerOff(true);
    bench.Ticks(500, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power);
    bench.Ticks(530, 0, false);
    EXPECT_TRUE(bench.reading.keeps_power);
    bench.arm->PowerOff(false);
    bench.Ticks(20, 0, false);
    EXPECT_FALSE(bench.reading.keeps_power);
  }
}

// An old state may have changed since.
TEST_P(UrArmTest, SaysNothingOfItsPowerWhileItIsSilent) {
  UrBench bench(GetParam());
  bench.Connect({.host = kUrHost, .dashboard_port = 0}).Ticks(50, 0);
  bench.arm->PowerOff(true);
  bench.Ticks(500, 0, false);
  bench.fake.Do("late 600");  // packages still arrive, but with this age [ms]
  bench.Ticks(1200, 0, false);
  EXPECT_GT(bench.reading.age, 0.5);
  EXPECT_FALSE(bench.reading.keeps_power);
}

TEST_P(UrArmTest, SaysAtOnceThatItsDashboardIsLost) {
  UrBench bench(GetParam());
  bench.Connect().Ticks(50, 0.1);
  ASSERT_TRUE(bench.fake.Do("drop dashboard"));
  bench.Ticks(3, 0.1);
  EXPECT_TRUE(bench.reading.no_power_off);
  EXPECT_TRUE(bench.read.ok());  // the run continues
  bench.Ticks(50, 0.1);
  EXPECT_TRUE(bench.reading.no_power_off);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.1);
}

// An external watchdog does this through its own connection.
TEST_P(UrArmTest, ProgramThatTakesOursPlaceBrakesTheArmAndIsAFault) {
  UrBench bench(GetParam());
  const auto other = bench.network.Connect({kUrHost, 30001}, 1);
  bench.Connect().Ticks(100, 0.3);
  const std::string brake = "def brake():\n  stopj(10.0)\nend\n";
  other->Write(std::as_bytes(std::span(brake)));
  const double last = bench.speed();
  for (int i = 0; i < 2 * period(); ++i) bench.Tick(0.3);
  EXPECT_LT(bench.speed(), last);
  bench.Ticks(200, 0.3);
  EXPECT_EQ(bench.speed(), 0);
  EXPECT_EQ(bench.read.cause, StopCause::kDevice);
  EXPECT_NE(bench.arm->Trouble().find("no longer runs"), std::string::npos);
}

TEST(UrArm, EndsItsProgramWhenItIsGone) {
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

TEST_P(UrArmTest, ListensToAnArmThatSomebodyElseMoves) {
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
  bench.fake.Do("slider 50");  // set by the other client
  bench.fake.Do("press 9");
  bench.Ticks(20, 0, false);
  EXPECT_EQ(bench.reading.inputs, 1U << 9);
  EXPECT_FALSE(bench.reading.fault);
  EXPECT_EQ(bench.arm->Trouble(), "");
  bench.Ticks(20, 0.3);  // a listener cannot move the arm
  EXPECT_EQ(bench.written.cause, StopCause::kDevice);
  EXPECT_EQ(bench.speed(), 0);
}

TEST(DeviceClock, TellsTheDelayBeyondTheQuickestPackage) {
  DeviceClock clock;
  EXPECT_GE(clock.Age(5), 1e9);
  std::uint64_t now = 7'000'000'000;
  double stamp = 1234;
  for (int i = 0; i < 1000; ++i) clock.Arrived(stamp += 0.002, now += 2'000'000);
  EXPECT_NEAR(clock.Age(now), 0, 1e-9);
  clock.Arrived(stamp += 0.002, now += 12'000'000);  // 10 ms late
  EXPECT_NEAR(clock.Age(now), 0.010, 1e-5);
  EXPECT_NEAR(clock.Age(now + 5'000'000), 0.015, 1e-5);
}

// Even with the worst drift of a quartz clock, the delay must not seem to grow.
TEST(DeviceClock, ForgivesDrift) {
  for (const double drift : {-2e-4, 2e-4}) {
    DeviceClock clock;
    std::uint64_t now = 1'000'000'000;
    double stamp = 0;
    for (int i = 0; i < 500 * 600; ++i) {
      stamp += 0.002 * (1 + drift);
      clock.Arrived(stamp, now += 2'000'000);
      ASSERT_LT(clock.Age(now), 1e-5);
    }
  }
}

}  // namespace
}  // namespace predictor
