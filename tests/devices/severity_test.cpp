// A lasting fault must not hide a worse one that follows. The most severe fault determines how a
// stop ends.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <ostream>
#include <string>

#include "fakes/bench.h"

namespace predictor {
namespace {

using Happening = std::function<void(Bench&)>;

Happening ToArm(int hand, const char* what) {
  return [=](Bench& b) { EXPECT_TRUE(b.arm(hand).Do(what)) << what; };
}
Happening Silence(int hand) {
  return [=](Bench& b) { b.wire(hand).silent = true; };
}
Happening Saturation(int hand) {
  return [=](Bench& b) { EXPECT_TRUE(b.sensor(hand).Do("saturate")); };
}
void Press(Bench& b) {
  b.rig().Disturb(0, {}, Wrench((Vector6() << 60, 0, 0, 0, 0, 0).finished()));
}

struct Course {
  const char* name;
  std::string scenario;
  std::array<std::string, 2> arms, sensors;
  Happening lesser, worse;
  const char* message = "";  // message about the worse fault, in addition to the first

  friend std::ostream& operator<<(std::ostream& out, const Course& course) {
    return out << course.name;
  }
};

class Severity : public testing::TestWithParam<Course> {
 protected:
  static Bench MakeBench() {
    BenchOptions options;
    options.scenario =
        std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + GetParam().scenario + ".yaml";
    options.arms = GetParam().arms;
    options.sensors = GetParam().sensors;
    return Bench(options);
  }
};

TEST_P(Severity, TheLesserHoldsAndTheWorseEndsWithoutPower) {
  Bench bench = MakeBench();
  ASSERT_TRUE(bench.Start());
  bench.Pass(1.5);
  GetParam().lesser(bench);
  ASSERT_TRUE(bench.Await(RunState::kHeld, 1));
  bench.Pass(0.3);
  ASSERT_EQ(bench.emulator().state(), RunState::kHeld);
  const std::string first = bench.device().Trouble();
  GetParam().worse(bench);
  EXPECT_TRUE(bench.Await(RunState::kUnpowered, 0.1));
  bench.Pass(0.2);  // by then, the driver also reports the worse fault
  const std::string both = bench.device().Trouble();
  EXPECT_NE(both.find(first.substr(0, first.find('.'))), std::string::npos) << both;
  EXPECT_NE(both.find(GetParam().message), std::string::npos) << both;
}

// If a robot ignores a power-off request, the danger continues after the stop.
TEST(PowerOff, ThatTheArmIgnoresCausesAWarningUntilItHappens) {
  BenchOptions options;
  options.scenario = std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/dual_ur5.yaml";
  Bench bench(options);
  ASSERT_TRUE(bench.Start());
  ASSERT_TRUE(bench.arm(1).Do("drop dashboard"));
  const auto has = [&](int hand, Warning warning) {
    return Has(bench.record().hands[static_cast<std::size_t>(hand)], warning);
  };
  bench.Pass(0.02);
  EXPECT_EQ(bench.emulator().state(), RunState::kRun);
  EXPECT_TRUE(has(1, Warning::kNoPowerOff));
  EXPECT_FALSE(has(0, Warning::kNoPowerOff));
  bench.emulator().Request(RunEvent::kStopAndPowerOff);
  ASSERT_TRUE(bench.Await(RunState::kUnpowered, 1));
  bench.Pass(0.9);
  EXPECT_FALSE(has(1, Warning::kKeepsPower));
  bench.Pass(0.2);
  EXPECT_TRUE(has(1, Warning::kKeepsPower));
  EXPECT_FALSE(has(0, Warning::kKeepsPower));  // this arm obeyed
  ASSERT_TRUE(bench.arm(1).Do("power off"));
  bench.Pass(0.1);
  EXPECT_FALSE(has(1, Warning::kKeepsPower));
}

const char* const kUrs = "dual_ur5";
const char* const kFrankas = "box_9kg";

INSTANTIATE_TEST_SUITE_P(
    Of, Severity,
    testing::Values(
        Course{"OneURThenTheOther",
               kUrs,
               {"ur", "ur"},
               {},
               ToArm(0, "protective stop"),
               ToArm(1, "emergency stop"),
               "192.0.2.11 is in emergency stop"},
        Course{"OneURTwice",
               kUrs,
               {"ur", "ur"},
               {},
               ToArm(0, "protective stop"),
               ToArm(0, "emergency stop"),
               "Since then it is in emergency stop"},
        Course{"OneURThenTheOtherSilent",
               kUrs,
               {"ur", "ur"},
               {},
               ToArm(0, "protective stop"),
               Silence(1)},
        Course{"AHandThenItsArmSilent", kUrs, {"ur", "ur"}, {}, Press, Silence(0)},
        Course{"OneURThenTheOthersSensor",
               kUrs,
               {"ur", "ur"},
               {"", "net_ft"},
               ToArm(0, "protective stop"),
               Saturation(1),
               "outside its range"},
        Course{"AHandThenItsSensor", kUrs, {"ur", "ur"}, {"net_ft", ""}, Press, Saturation(0)},
        Course{"OneFrankaThenTheOther",
               kFrankas,
               {"franka", "franka"},
               {},
               ToArm(0, "reflex"),
               ToArm(1, "user stop"),
               "192.0.2.11:1337 is stopped by the user stop"},
        Course{"OneFrankaTwice",
               kFrankas,
               {"franka", "franka"},
               {},
               ToArm(0, "reflex"),
               ToArm(0, "user stop"),
               "Since then it is stopped by the user stop"},
        Course{"OneFrankaThenItIsSilent",
               kFrankas,
               {"franka", "franka"},
               {},
               ToArm(0, "reflex"),
               Silence(0),
               "Since then it no longer sends states"}),
    [](const testing::TestParamInfo<Course>& course) { return course.param.name; });

}  // namespace
}  // namespace predictor
