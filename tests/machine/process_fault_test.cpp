// Tests faults of the program's own processes with real arms, over real sockets.
#include <gtest/gtest.h>

#include "machine/attempts.h"
#include "support/faulty_system.h"
#include "support/process.h"

namespace predictor {
namespace {

std::vector<std::string> Arguments(const std::string& scenario, const MachineFolder& folder) {
  return {"run",         scenario,     "--machine", folder.file(), "--set", "operator.type=person",
          "--no-viewer", "--no-record"};
}

// If the loop hangs (fault 31), the watchdog process must brake the arms to which it has a channel.
// When the loop continues, it must detect that these arms have stopped, and it must then begin a
// stop itself.
TEST(ProcessFault, ALoopThatHangsIsStoppedByTheWatchdogSoak) {
  const MachineFolder folder({"ur", "franka"});
  folder.NotePushTests();
  const std::string scenario = folder.Brisk("ur_and_panda");
  Attempts attempts;
  while (attempts.Next()) {
    FakeRig rig(scenario, {"left=ur:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
    Attempts::AwaitCalm(&rig);
    Terminal terminal(Arguments(scenario, folder));
    // The loop hangs at the fastest moment of the first move.
    if (!terminal.Start(&rig) || terminal.Says("Now STOPPING", kBriskBegin + kBriskMove / 2)) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    const std::uint64_t hung = Terminal::Now();
    const auto before = std::chrono::steady_clock::now();
    EXPECT_EQ(rig.Ask("mark"), "ok");
    terminal.Kill(SIGSTOP);
    const std::chrono::duration<double> lived_on = std::chrono::steady_clock::now() - before;
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    const RigMotion motion = rig.Motion();
    std::printf("At %.0f mm/s when the loop hung; rest after %.0f ms and %.1f mm, %.1f rad/s²\n",
                1e3 * motion.fastest, 1e3 * motion.rest_after, 1e3 * motion.distance,
                motion.braking);
    const Advertised advertised({"ur", "franka"}, motion.joint);
    const bool kept = motion.fastest > kBriskMedian && motion.braking < advertised.braking &&
                      motion.rest_after < advertised.rest_after + lived_on.count();
    if (!kept && attempts.ComputerWasLate(&rig, hung - kJustBefore)) continue;
    EXPECT_GT(motion.fastest, kBriskMedian);
    EXPECT_LT(motion.rest_after, advertised.rest_after + lived_on.count());
    EXPECT_LT(motion.braking, advertised.braking);
    const std::vector<std::string> log = rig.Log("left", 0);
    EXPECT_NE(std::find(log.begin(), log.end(), "program predictor_watchdog"), log.end())
        << (log.empty() ? "no log" : log.back());
    terminal.Kill(SIGCONT);
    EXPECT_TRUE(terminal.Says("The control loop hung, and the watchdog stopped the arms."))
        << terminal.Screen();
    EXPECT_TRUE(terminal.Says("after the stop")) << terminal.Screen();
    terminal.Let();
    terminal.Kill(SIGINT);
    EXPECT_EQ(terminal.Wait(), 1) << terminal.Screen();
    return;
  }
  FAIL() << attempts.Words();
}

// The end of a run is not a hang. The loop itself must bring the arms to rest and report the end of
// the run.
TEST(ProcessFault, CtrlCInARunIsNotAHang) {
  const MachineFolder folder({"ur", "ur"});
  folder.NotePushTests();
  Attempts attempts;
  while (attempts.Next()) {
    FakeRig rig(FileOf("dual_ur5"), {"left=ur:" + HostOf(kLeft), "right=ur:" + HostOf(kRight)});
    Terminal terminal(Arguments(FileOf("dual_ur5"), folder));
    if (!terminal.Start(&rig)) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    terminal.Kill(SIGINT);
    const int code = terminal.Wait();
    const std::string screen = terminal.Screen();
    if (attempts.WasSpoiled(terminal, &rig)) continue;
    EXPECT_EQ(code, 0) << screen;
    EXPECT_NE(screen.find("Now HELD"), std::string::npos) << screen;
    EXPECT_EQ(screen.find("hung"), std::string::npos) << screen;
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

// The watchdog's channel is closed during the run. The program must report this immediately, not
// only when it needs the channel, and the channel must be restored automatically. Lateness may stop
// the loop during this test, but the watchdog must continue to watch.
TEST(ProcessFault, ALostStopChannelIsReportedAndRestored) {
  const MachineFolder folder({"ur", "franka"});
  folder.NotePushTests();
  FakeRig rig(FileOf("ur_and_panda"),
              {"left=ur:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
  Terminal terminal(Arguments(FileOf("ur_and_panda"), folder));
  ASSERT_TRUE(terminal.Says("Keys: ")) << terminal.Screen();
  EXPECT_EQ(rig.Ask("do left 0 drop primary"), "ok");
  EXPECT_TRUE(terminal.Says("The watchdog has lost its channel to " + HostOf(kLeft)))
      << terminal.Screen();
  EXPECT_TRUE(terminal.Says("The watchdog is running again.")) << terminal.Screen();
  EXPECT_EQ(rig.Ask("do left 0 mute primary"), "ok");
  EXPECT_TRUE(terminal.Says("The watchdog receives no data from " + HostOf(kLeft)))
      << terminal.Screen();
  EXPECT_EQ(rig.Ask("do left 0 unmute primary"), "ok");
  EXPECT_TRUE(terminal.Says("again.")) << terminal.Screen();  // same channel or a new one
  terminal.Kill(SIGINT);
  terminal.Wait();
}

// Returns the process with this name that belongs to the program, or 0 if there is none.
int ProcessBeside(int program, const std::string& name) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const int pid = std::atoi(entry.path().filename().c_str());
    if (pid > 0 && test::StatusOf(pid, "Name") == name &&
        test::StatusOf(pid, "PPid") == std::to_string(program))
      return pid;
  }
  return 0;
}

// A watchdog that can no longer detect a hang must end the motion and be restored.
TEST(ProcessFault, AWatchdogThatIsStoppedEndsMotionSoak) {
  const MachineFolder folder({"ur", "franka"});
  folder.NotePushTests();
  Attempts attempts;
  while (attempts.Next()) {
    FakeRig rig(FileOf("ur_and_panda"),
                {"left=ur:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
    Attempts::AwaitCalm(&rig);
    Terminal terminal(Arguments(FileOf("ur_and_panda"), folder));
    if (!terminal.Start(&rig)) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    const int watchdog = ProcessBeside(terminal.pid(), "watchdog");
    ASSERT_GT(watchdog, 0);
    ASSERT_EQ(kill(watchdog, SIGSTOP), 0);
    EXPECT_TRUE(terminal.Says("The watchdog does not respond")) << terminal.Screen();
    const auto says = [&](const char* text) {
      return test::Becomes([&] { return terminal.Screen().find(text) != std::string::npos; });
    };
    const bool stopped = says("the stop 'watchdog'");
    if (!stopped && attempts.WasSpoiled(terminal, &rig)) continue;
    EXPECT_TRUE(stopped) << terminal.Screen();
    EXPECT_TRUE(says("The watchdog is running again.")) << terminal.Screen();
    terminal.Let();
    terminal.Kill(SIGINT);
    EXPECT_EQ(terminal.Wait(), 1) << terminal.Screen();
    return;
  }
  FAIL() << attempts.Words();
}

// If the console fails with an exception, the effect must be the same as if the operator had left.
TEST(ProcessFault, AConsoleThatReceivesNoMoreKeysStopsTheRun) {
  const MachineFolder folder({"ur", "ur"});
  folder.NotePushTests();
  const FaultySystem system("FAULTY_MEMORY", "console,1,1");
  FakeRig rig(FileOf("dual_ur5"), {"left=ur:" + HostOf(kLeft), "right=ur:" + HostOf(kRight)});
  Terminal terminal(Arguments(FileOf("dual_ur5"), folder));
  ASSERT_TRUE(terminal.Says("Now IDLE")) << terminal.Screen();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  terminal.Type(":mark what is too long for a short text");
  EXPECT_TRUE(terminal.Says(
      "The console no longer receives keys (std::bad_alloc), so the arms are stopping."))
      << terminal.Screen();
  EXPECT_TRUE(test::Becomes([&] {
    return terminal.Screen().find("Now HELD") != std::string::npos;
  })) << terminal.Screen();
  terminal.Kill(SIGINT);
  EXPECT_EQ(terminal.Wait(), 1) << terminal.Screen();
}

// If other programs could delay the loop (fault 33), the program must not move real arms.
TEST(ProcessFault, WithoutRealTimePriorityRealArmsAreRefused) {
  // The refused hosts include a name that only looks like an address of this computer.
  for (const char* host : {"192.0.2.10", "127.robot.example"}) {
    const MachineFolder folder({"ur", "ur"});
    folder.Change([&](Machine* machine) { machine->left->connection.host = host; });
    folder.NotePushTests();
    const FaultySystem system("FAULTY_PRIORITY", "1");
    Terminal terminal(Arguments(FileOf("dual_ur5"), folder));
    EXPECT_EQ(terminal.Wait(), 3) << terminal.Screen();
    EXPECT_NE(terminal.Screen().find("real-time"), std::string::npos) << terminal.Screen();
    EXPECT_EQ(terminal.Screen().find("Connecting"), std::string::npos) << terminal.Screen();
  }
}

}  // namespace
}  // namespace predictor
