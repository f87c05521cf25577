// Tests faults of arms, sensors and wires over real sockets while the arms are at rest. The results
// do not depend on how far an arm moves on a busy computer. devices/faults.cpp tests faults in
// motion, in virtual time.
#include <gtest/gtest.h>

#include "machine/attempts.h"

namespace predictor {
namespace {

struct FaultAtRest {
  const char* name;
  std::array<const char*, 2> makes;    // of left and right
  std::array<const char*, 2> sensors;  // "net_ft", or "" for the arm's own
  std::vector<const char*> does;       // requests to the rig, sent in quick succession
  std::vector<const char*> expected;   // what the screen must report
  bool late = false;                   // a silence stops the arms as lateness does
};

class IdleFault : public testing::TestWithParam<FaultAtRest> {
 protected:
  IdleFault()
      : scenario_(FileOf(*GetParam().makes[1] == 'u' ? "dual_ur5" : "ur_and_panda")),
        folder_({GetParam().makes[0], GetParam().makes[1]},
                {GetParam().sensors[0], GetParam().sensors[1]}) {
    folder_.NotePushTests();
  }
  std::vector<std::string> Fakes() const {
    std::vector<std::string> fakes;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::string side = i == 0 ? "left=" : "right=";
      fakes.push_back(side + GetParam().makes[i] + ":" + HostOf(i == 0 ? kLeft : kRight));
      if (*GetParam().sensors[i] != 0)
        fakes.push_back(side + "net_ft:" + HostOf(i == 0 ? kLeftSensor : kRightSensor));
    }
    return fakes;
  }
  std::vector<std::string> Arguments() const {
    return {"run",          scenario_,    "--machine",
            folder_.file(), "--set",      "operator.type=person",
            "--no-viewer",  "--no-record"};
  }

  std::string scenario_;
  MachineFolder folder_;
};

// The faults may arrive in one tick or in two, in either order. At the end, the arms must have no
// power, and the program must have reported all faults.
TEST_P(IdleFault, EndsWithoutPowerAndIsReported) {
  Attempts attempts;
  while (attempts.Next()) {
    FakeRig rig(scenario_, Fakes());
    Terminal terminal(Arguments());
    if (!terminal.IsIdle() || terminal.Says("Now STOPPING", 0.2)) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    for (const std::string what : GetParam().does) {
      if (what == "SIGSTOP")
        rig.Kill(SIGSTOP);
      else
        EXPECT_EQ(rig.Ask(what), "ok") << what;
    }
    const bool unpowered = terminal.Says("Now UNPOWERED", 10);
    // The console prints the lines one after the other, so the test waits for the last line.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    terminal.Kill(SIGINT);
    const int code = terminal.Wait();
    const std::string screen = terminal.Screen();
    if (!GetParam().late && attempts.WasSpoiled(terminal, &rig)) continue;
    EXPECT_TRUE(unpowered) << screen;
    EXPECT_EQ(code, 1) << screen;
    for (const char* words : GetParam().expected)
      EXPECT_NE(screen.find(words), std::string::npos) << words << "\n" << screen;
    EXPECT_EQ(screen.find("Now ALIGN"), std::string::npos) << screen;
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

INSTANTIATE_TEST_SUITE_P(
    Of, IdleFault,
    testing::Values(
        FaultAtRest{"ProtectiveStopThenTheOthersEmergencyStop",
                    {"ur", "ur"},
                    {"", ""},
                    {"do left 0 protective stop", "do right 0 emergency stop"},
                    {"left: ", " is in protective stop", "right: ", " is in emergency stop"}},
        FaultAtRest{"EmergencyStopThenTheOthersProtectiveStop",
                    {"ur", "ur"},
                    {"", ""},
                    {"do left 0 emergency stop", "do right 0 protective stop"},
                    {"left: ", " is in emergency stop", "right: ", " is in protective stop"}},
        FaultAtRest{"ProtectiveStopThenEmergencyStopOfTheSameArm",
                    {"ur", "ur"},
                    {"", ""},
                    {"do right 0 protective stop", "do right 0 emergency stop"},
                    {"right: ", " is in emergency stop"}},
        FaultAtRest{"ProtectiveStopThenAFrankasUserStop",
                    {"ur", "franka"},
                    {"", ""},
                    {"do left 0 protective stop", "do right 0 user stop"},
                    {" is in protective stop", " is stopped by the user stop"}},
        FaultAtRest{"ReflexThenTheOthersEmergencyStop",
                    {"ur", "franka"},
                    {"", ""},
                    {"do right 0 reflex cartesian_reflex", "do left 0 emergency stop"},
                    {" is stopped by a reflex (cartesian reflex)", " is in emergency stop"}},
        FaultAtRest{"ASilentUr",
                    {"ur", "ur"},
                    {"", ""},
                    {"do right 0 freeze"},
                    {"'stale'", "Right hand: "},
                    true},
        FaultAtRest{"ASilentFranka",
                    {"ur", "franka"},
                    {"", ""},
                    {"do right 0 freeze"},
                    {"right: ", "no longer sends states"},
                    true},
        FaultAtRest{"ASilentSensor",
                    {"ur", "ur"},
                    {"", "net_ft"},
                    {"do right 1 silent"},
                    {"'stale'", "Right hand: "},
                    true},
        FaultAtRest{"AHalfOpenConnection",
                    {"ur", "franka"},
                    {"", ""},
                    {"SIGSTOP"},
                    {"'stale'", "right: ", "no longer sends states"},
                    true}),
    [](const testing::TestParamInfo<FaultAtRest>& fault) { return std::string(fault.param.name); });

// The program reports the minor fault long before the major one occurs. After the major fault, the
// arms must no longer hold their position.
TEST(IdleFaults, AnEmergencyStopWhileTheArmsAreHeldRemovesThePower) {
  const MachineFolder folder({"ur", "ur"});
  folder.NotePushTests();
  for (const std::string side : {"left", "right"}) {
    bool judged = false;
    Attempts attempts;
    while (!judged && attempts.Next()) {
      FakeRig rig(FileOf("dual_ur5"), {"left=ur:" + HostOf(kLeft), "right=ur:" + HostOf(kRight)});
      Terminal terminal({"run", FileOf("dual_ur5"), "--machine", folder.file(), "--set",
                         "operator.type=person", "--no-viewer", "--no-record"});
      if (!terminal.IsIdle()) {
        ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
        continue;
      }
      EXPECT_EQ(rig.Ask("do left 0 protective stop"), "ok");
      const bool held = terminal.Says("Now HELD", 10) && terminal.Says("is in protective stop");
      EXPECT_EQ(rig.Ask("do " + side + " 0 emergency stop"), "ok");
      const bool unpowered = terminal.Says("Now UNPOWERED", 10);
      const bool reported = terminal.Says(side + ": ") && terminal.Says("is in emergency stop", 2);
      terminal.Kill(SIGINT);
      EXPECT_EQ(terminal.Wait() == 0, false);
      const std::string screen = terminal.Screen();
      if (attempts.WasSpoiled(terminal, &rig)) continue;
      judged = true;
      EXPECT_TRUE(held) << screen;
      EXPECT_TRUE(unpowered) << screen;
      EXPECT_TRUE(reported) << screen;
    }
    if (!judged) GIVE_UP_BUSY(attempts.Words());
  }
}

}  // namespace
}  // namespace predictor
