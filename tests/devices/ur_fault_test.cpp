// Tests faults of a UR, of its connection and of its commands.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "devices/ur_arm_fixture.h"
#include "support/test_name.h"

namespace predictor {
namespace {

struct UrFault {
  const char* what;
  const char* trouble;
};

class UrFaultTest : public testing::TestWithParam<std::tuple<FakeUrOptions, UrFault>> {};

TEST_P(UrFaultTest, IsReportedWithinACyclePermanentlyAndTheArmStands) {
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
  // The position of this arm is unknown, but it still follows commands, so the stop brings it to
  // rest.
  bench.Ticks(200, fault.what == std::string("not a number") ? 0 : 0.3);
  EXPECT_EQ(bench.speed(), 0);
  // A person clears the fault and resumes the program. The arm must not move.
  for (const char* cure : {"unlock", "freedrive off", "play"}) bench.fake.Do(cure);
  for (int i = 0; i < 300; ++i) {
    bench.Tick(0.3);
    ASSERT_EQ(bench.speed(), 0);
  }
  EXPECT_EQ(bench.read.cause, StopCause::kDevice);
  EXPECT_EQ(bench.arm->Trouble(), trouble);
  EXPECT_FALSE(bench.fake.running());
}

const auto kFaults = testing::Values(
    UrFault{"protective stop", "protective stop"}, UrFault{"emergency stop", "emergency stop"},
    UrFault{"safeguard stop", "safeguard stop"}, UrFault{"power off", "not powered"},
    UrFault{"freedrive", "is in free-drive"}, UrFault{"slider 80", "speed slider to 100 %"},
    UrFault{"stop program", "no longer runs"}, UrFault{"pause program", "no longer runs"},
    UrFault{"drop link", "closed the connection"}, UrFault{"malformed", "not RTDE"},
    UrFault{"not a number", "sends impossible joint angles"});
std::string NameOfCase(const testing::TestParamInfo<std::tuple<FakeUrOptions, UrFault>>& c) {
  return NameOfController(std::get<0>(c.param)) + "_" + test::TestName(std::get<1>(c.param).what);
}
INSTANTIATE_TEST_SUITE_P(Controllers, UrFaultTest, testing::Combine(UrControllers(), kFaults),
                         NameOfCase);

// The stop that follows may bring the arm to rest, but must not move it for long or a second time.
TEST(UrArm, WithInvalidNumbersFollowsOneStopOnly) {
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

TEST(UrArm, ReportsWhetherItMayBeHeld) {
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

// The process dies at a random phase of both cycles.
TEST_P(UrArmTest, ArmBrakesByItselfWhenNothingIsWrittenAndStaysStanding) {
  for (int phase = 0; phase < 16; ++phase) {
    UrBench bench(GetParam());
    bench.Connect().Ticks(200 + phase, 0.5);
    int silent = 0;
    while (bench.speed() >= 0.5 && silent < 1000) bench.Pass(), ++silent;
    EXPECT_LE(silent, 20) << phase;
    for (int i = 0; i < 100; ++i) bench.Pass();
    EXPECT_EQ(bench.speed(), 0);
    // The process resumes.
    bench.Ticks(1, 0.5);
    EXPECT_EQ(bench.read.cause, StopCause::kDevice);
    EXPECT_NE(bench.arm->Trouble().find("received no command"), std::string::npos);
    bench.Ticks(200, 0.5);
    EXPECT_EQ(bench.speed(), 0);
    EXPECT_FALSE(bench.fake.running());
  }
}

TEST(UrArm, AProgramWithoutCommandsEndsWhichIsAFault) {
  UrBench bench;
  bench.Connect().Ticks(100, 0.0);
  bench.fake.Do("deaf");
  int ticks = 0;
  for (; ticks < 200 && bench.read.ok(); ++ticks) bench.Tick(0);
  EXPECT_LE(ticks, 25);
  EXPECT_NE(bench.arm->Trouble().find("received no command"), std::string::npos);
}

TEST(UrArm, AProgramThatContinuesWithoutCommandsIsAFault) {
  UrBench bench;
  bench.Connect();
  bench.fake.Do("deaf");  // before the first command, so the program waits and does not end
  int ticks = 0;
  for (; ticks < 1000 && bench.read.ok(); ++ticks) bench.Tick(0);
  EXPECT_NEAR(ticks, 100, 10);
  EXPECT_NE(bench.arm->Trouble().find("accepts no commands"), std::string::npos);
}

TEST(UrArm, OnlySixFiniteNumbersAreSent) {
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

// This peer accepts no more data, although its own data still arrives.
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

// A listener writes nothing, so it can notice a closed connection only when it reads.
TEST(UrArm, AListenersReadingReportsThatTheConnectionIsClosed) {
  UrBench bench;
  bench.Connect({.host = kUrHost, .listen = true}).Ticks(50, 0, false);
  ASSERT_TRUE(bench.read.ok());
  bench.fake.Do("drop link");
  bench.Ticks(2, 0, false);
  EXPECT_EQ(bench.read.cause, StopCause::kDevice);
  EXPECT_TRUE(bench.read.power_off);
  EXPECT_NE(bench.arm->Trouble().find("closed the connection"), std::string::npos);
}

// In this way, an external watchdog takes over the arm through its own connection.
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

}  // namespace
}  // namespace predictor
