// Tests every reason for which the driver refuses a connection, and the message to the person.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "devices/ur_bench.h"

namespace predictor {
namespace {

std::string Refusal(UrBench* bench, const UrOptions& options = {.host = kUrHost}) {
  try {
    bench->Connect(options);
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

::testing::AssertionResult Says(const std::string& sentence, const std::string& part) {
  if (sentence.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\"" << part << "\" is not in \"" << sentence << "\"";
}

TEST(UrConnect, NoAnswer) {
  UrBench bench;
  EXPECT_TRUE(Says(Refusal(&bench, {.host = "192.0.2.99"}), "192.0.2.99:30004 does not answer"));
}

TEST(UrConnect, AnOlderProtocol) {
  UrBench bench;
  bench.fake.rtde().newest_protocol = 1;
  EXPECT_EQ(Refusal(&bench),
            "192.0.2.10:30004 answers RTDE version 1, but version 2 is needed. Update PolyScope to "
            "3.4 or newer.");
  UrBench none;
  none.fake.rtde().newest_protocol = 0;
  EXPECT_TRUE(
      Says(Refusal(&none), "192.0.2.10:30004 refuses RTDE version 2, but version 2 is needed"));
}

TEST(UrConnect, ControllersThatAreNotKnown) {
  for (const std::uint32_t major : {1U, 2U, 4U}) {
    UrBench bench({{major, 1, 0, 0}, 0});
    EXPECT_TRUE(Says(Refusal(&bench),
                     "192.0.2.10:30004 answers PolyScope version " + std::to_string(major) +
                         ".1.0.0, but version 3 (CB3), or 5 (e-Series) or newer, is needed"));
  }
}

TEST(UrConnect, ControllersThatAreKnown) {
  const UrVersion versions[] = {
      {3, 9, 0, 0}, {3, 15, 8, 0}, {5, 3, 0, 0}, {5, 9, 0, 0}, {10, 7, 0, 0}};
  for (const UrVersion& version : versions) {
    UrBench bench({version, 0});
    EXPECT_EQ(Refusal(&bench), "");
    EXPECT_EQ(bench.arm->facts().own_wrench, version.AtLeast(5, 9));
  }
}

TEST(UrConnect, ControllersWithHalfTheRegisters) {
  const UrVersion versions[] = {{3, 4, 0, 0}, {3, 8, 0, 0}, {5, 0, 0, 0}, {5, 2, 0, 0}};
  for (const UrVersion& version : versions) {
    UrBench bench({version, 0});
    EXPECT_TRUE(Says(Refusal(&bench), "choose first register 0"));
    UrBench lower({version, 0});
    EXPECT_EQ(Refusal(&lower, {.host = kUrHost, .first_register = 0}), "");
  }
}

TEST(UrConnect, RegistersThatAFieldbusHolds) {
  for (const char* name : {"input_double_register_24", "input_double_register_29",
                           "input_int_register_24", "input_int_register_25"}) {
    UrBench bench;
    bench.fake.rtde().in_use = {name};
    const std::string sentence = Refusal(&bench);
    EXPECT_TRUE(Says(sentence, std::string(name) + " is in use"));
    EXPECT_TRUE(Says(sentence, "first register 0 or 24"));
    // The other register range is still free, so the driver must connect with it.
    UrBench other;
    other.fake.rtde().in_use = {name};
    EXPECT_EQ(Refusal(&other, {.host = kUrHost, .first_register = 0}), "");
    other.Ticks(100, 0.2);
    EXPECT_DOUBLE_EQ(other.speed(), 0.2);
  }
}

TEST(UrConnect, MissingValues) {
  for (const char* name : {"timestamp", "actual_q", "safety_status_bits", "ft_raw_wrench",
                           "input_int_register_25", "output_int_register_24"}) {
    UrBench bench;
    bench.fake.rtde().unknown = {name};
    EXPECT_TRUE(Says(Refusal(&bench), "does not support " + std::string(name)));
  }
}

TEST(UrConnect, ImpossibleRegisters) {
  for (const int first : {-1, 19, 23, 43, 48}) {
    UrBench bench;
    EXPECT_TRUE(
        Says(Refusal(&bench, {.host = kUrHost, .first_register = first}), "first register"));
  }
}

TEST(UrConnect, ImpossibleAccelerations) {
  for (const double a : {0.0, -1.0, 101.0, std::nan("")}) {
    UrBench bench;
    EXPECT_TRUE(Says(Refusal(&bench, {.host = kUrHost, .acceleration = a}), "acceleration"));
    EXPECT_TRUE(Says(Refusal(&bench, {.host = kUrHost, .deceleration = a}), "deceleration"));
  }
}

TEST(UrConnect, ArmsThatCannotMove) {
  const std::pair<const char*, const char*> states[] = {
      {"protective stop", "is in protective stop"},
      {"emergency stop", "is in emergency stop"},
      {"safeguard stop", "is in safeguard stop"},
      {"power off", "is not powered"},
      {"not a number", "sends data that is not RTDE"},
      {"freedrive", "Release the free-drive button"}};
  for (const auto& [what, says] : states) {
    UrBench bench;
    bench.fake.Do(what);
    EXPECT_TRUE(Says(Refusal(&bench), says));
    EXPECT_FALSE(bench.fake.running());
  }
}

TEST(UrConnect, AReducedSpeedSliderIsRefusedAndReportedToAListener) {
  UrBench bench;
  bench.fake.Do("slider 50");
  EXPECT_TRUE(Says(Refusal(&bench), "Set the pendant's speed slider to 100 %"));
  EXPECT_FALSE(bench.fake.running());
  bench.Connect({.host = kUrHost, .listen = true});
  ASSERT_EQ(bench.arm->facts().remarks.size(), 1U);
  EXPECT_TRUE(Says(bench.arm->facts().remarks[0], "speed slider is at 50 %"));
  UrBench whole;
  whole.Connect();
  EXPECT_TRUE(whole.arm->facts().remarks.empty());
}

TEST(UrConnect, ThePayloadIsReportedIfAvailable) {
  UrBench older;
  older.Connect();
  EXPECT_FALSE(older.arm->facts().payload);
  for (const bool listen : {false, true}) {
    FakeUrOptions options = ESeries();
    options.payload = 0.75;
    options.payload_cog = {0.01, -0.02, 0.06};
    UrBench bench(options);
    bench.Connect({.host = kUrHost, .listen = listen}).Ticks(20, 0, false);
    EXPECT_TRUE(bench.read.ok());
    ASSERT_TRUE(bench.arm->facts().payload);
    EXPECT_EQ(bench.arm->facts().payload->mass, 0.75);
    EXPECT_EQ(bench.arm->facts().payload->center_of_mass, Vector3(0.01, -0.02, 0.06));
    EXPECT_FALSE(bench.arm->facts().payload_taken_off);
  }
}

TEST(UrConnect, TheFlangeIsTheToolLessItsOffset) {
  FakeUrOptions options;
  options.tool_offset = {0.01, -0.02, 0.1, 0.3, 0.2, -0.1};
  UrBench bench(options);
  const UrVector q = {0.3, -1.2, 1.8, -2.2, -1.5, 0.4};
  bench.mechanics.sample.q = Eigen::Map<const Vector6>(q.data());
  bench.network.Pass(0.01);
  bench.Connect({.host = kUrHost, .listen = true});
  ASSERT_TRUE(bench.arm->facts().flange);
  const Pose& reported = bench.arm->facts().flange->X_BF;
  const Pose X_BF = FlangeOf(kUr5, q);
  EXPECT_LT((reported.p - X_BF.p).norm(), 1e-9);
  EXPECT_LT(RotationError(reported.q, X_BF.q).norm(), 1e-9);
}

// The program runs but does not echo the registers, so the driver cannot determine which commands
// it would follow.
TEST(UrConnect, AControllerThatAcceptsNoRegistersIsRefused) {
  UrBench bench;
  bench.fake.Do("deaf");
  EXPECT_TRUE(Says(Refusal(&bench), "does not start the program that receives our commands"));
  EXPECT_EQ(bench.arm, nullptr);
}

TEST(UrConnect, AnArmThatIsGuidedWhileItsProgramStartsIsRefused) {
  UrBench bench;
  bench.network.SetWorld([&] {  // after the registers were cleared
    if (bench.fake.controller().input_int[24] != 0) bench.fake.Do("freedrive");
  });
  EXPECT_TRUE(Says(Refusal(&bench), "Release the free-drive button"));
  EXPECT_EQ(bench.arm, nullptr);
}

TEST(UrConnect, AnotherProgramIsNotReplaced) {
  UrBench bench;
  const auto stream = bench.network.Connect({kUrHost, 30001}, 1);
  const std::string program = "def theirs():\n  while True:\n    sync()\n  end\nend\n";
  stream->Write(std::as_bytes(std::span(program)));
  bench.network.Pass(0.01);
  ASSERT_TRUE(bench.fake.running());
  EXPECT_TRUE(Says(Refusal(&bench), "is running or pausing a program"));
  EXPECT_TRUE(bench.fake.running());
}

TEST(UrConnect, SecondClientFindsTheRegistersInUse) {
  UrBench bench;
  bench.Connect();
  EXPECT_THROW(ConnectUr({.host = kUrHost}, &bench.network), DeviceError);
  bench.Ticks(100, 0.2);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.2);
}

TEST(UrConnect, LocalControlIsNamed) {
  UrBench bench;
  bench.fake.Do("local control");
  EXPECT_TRUE(Says(Refusal(&bench), "is in local control. Choose Remote Control"));
  // The program does not start, and without the dashboard the driver cannot determine the reason.
  UrBench blind;
  blind.fake.Do("local control");
  EXPECT_TRUE(Says(Refusal(&blind, {.host = kUrHost, .dashboard_port = 0}),
                   "192.0.2.10:30002 does not start the program"));
}

// PolyScope X has no dashboard. The message must state that our program cannot remove the power.
TEST(UrConnect, WithoutADashboardARemarkSaysThatPowerCannotBeSwitchedOff) {
  const std::uint16_t ports[] = {0, 30009, 30003};  // disabled; no listener; no greeting
  for (const bool listen : {true, false})
    for (const std::uint16_t port : ports) {
      UrBench bench;
      bench.Connect({.host = kUrHost, .listen = listen, .dashboard_port = port});
      ASSERT_EQ(bench.arm->facts().remarks.size(), 1U);
      EXPECT_TRUE(Says(bench.arm->facts().remarks[0], "cannot switch the robot's power off"));
    }
  UrBench bench;
  bench.Connect({.host = kUrHost, .listen = true});
  EXPECT_TRUE(bench.arm->facts().remarks.empty());
}

// The port sent no greeting. The driver must not wait for a greeting again and must not use the
// port.
TEST(UrConnect, AServerWithoutAGreetingIsNotADashboard) {
  constexpr double kGreeting = 2;  // time-out for the greeting [s]
  const auto connect = [](UrBench* bench, std::uint16_t port) {
    bench->Connect({.host = kUrHost, .dashboard_port = port});
    return 1e-9 * static_cast<double>(bench->network.Now());
  };
  UrBench none, silent;
  EXPECT_NEAR(connect(&silent, 30003) - connect(&none, 30009), kGreeting, 0.1);
}

TEST(UrConnect, PortsThatAreNotOffered) {
  UrBench bench;
  EXPECT_TRUE(Says(Refusal(&bench, {.host = kUrHost, .rtde_port = 30005}), ":30005 refuses"));
  UrBench script;
  EXPECT_TRUE(Says(Refusal(&script, {.host = kUrHost, .script_port = 30009}), ":30009 refuses"));
}

TEST(UrConnect, AnotherServiceAnswers) {
  UrBench bench;
  const UrOptions options{.host = kUrHost, .rtde_port = 29999};
  EXPECT_TRUE(Says(Refusal(&bench, options), "sends an answer that is not RTDE"));
}

TEST(UrConnect, SilenceInTheMiddle) {
  UrBench bench;
  bench.fake.Do("freeze");
  EXPECT_TRUE(Says(Refusal(&bench), "accepts the connection but does not answer"));
}

TEST(UrConnect, AnyScriptPortDoes) {
  for (std::uint16_t port = 30001; port <= 30003; ++port) {
    UrBench bench;
    EXPECT_EQ(Refusal(&bench, {.host = kUrHost, .script_port = port}), "");
  }
}

// The registers contain arbitrary values from an earlier program.
TEST(UrConnect, OldRegisterValuesMoveNothing) {
  UrBench bench;
  auto& c = bench.fake.controller();
  c.input_double.fill(0.7);
  c.input_int.fill(1);
  c.output_int.fill(2);
  bench.Connect();
  bench.network.Pass(1);
  EXPECT_EQ(bench.speed(), 0);
  bench.Ticks(100, 0.1);
  EXPECT_DOUBLE_EQ(bench.speed(), 0.1);
}

TEST(UrConnect, ProgramOfThisDriverIsWhatRuns) {
  UrBench bench;
  bench.Connect();
  EXPECT_TRUE(bench.fake.running());
  EXPECT_EQ(bench.fake.log().back(), "program predictor");
}

}  // namespace
}  // namespace predictor
