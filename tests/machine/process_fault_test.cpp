// Faults of our own processes beside real arms, over real sockets.
#include <gtest/gtest.h>

#include "machine/rig_process.h"
#include "support/faulty_system.h"
#include "support/soak.h"

namespace predictor {
namespace {

constexpr int kAttempts = 4;

std::vector<std::string> Arguments(const std::string& scenario, const MachineFolder& folder) {
  return {"run",      scenario, "--machine",  folder.file(), "--set", "operator.type=person",
          "--viewer", "off",    "--no-record"};
}

// Fault 31: the loop stands still, and another process of ours brakes the arms that leave it a
// channel. When the loop goes on it finds them stopped, and stops.
TEST(ProcessFault, ALoopThatHangsIsStoppedByTheWatchdogSoak) {
  const MachineFolder folder({"ur", "franka"});
  folder.NotePushTests();
  const std::string scenario = folder.Brisk("ur_and_panda");
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    FakeRig rig(scenario, {"left=ur:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
    Terminal terminal(Arguments(scenario, folder));
    // Where the first move is fastest; else a busy computer's stop.
    if (!terminal.Start(&rig) || terminal.Says("Now STOPPING", kBriskBegin + kBriskMove / 2))
      continue;
    const auto before = std::chrono::steady_clock::now();
    EXPECT_EQ(rig.Ask("mark"), "ok");
    terminal.Kill(SIGSTOP);
    const std::chrono::duration<double> lived_on = std::chrono::steady_clock::now() - before;
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    const RigMotion motion = rig.Motion();
    std::printf("At %.0f mm/s when the loop hung; rest after %.0f ms and %.1f mm, %.1f rad/s²\n",
                1e3 * motion.fastest, 1e3 * motion.rest_after, 1e3 * motion.distance,
                motion.braking);
    EXPECT_GT(motion.fastest, kBriskMedian);
    const Advertised advertised({"ur", "franka"}, motion.joint);
    EXPECT_LT(motion.rest_after, advertised.rest_after + lived_on.count());
    EXPECT_LT(motion.braking, advertised.braking);
    const std::vector<std::string> log = rig.Log("left", 0);
    EXPECT_NE(std::find(log.begin(), log.end(), "program predictor_watchdog"), log.end())
        << (log.empty() ? "no log" : log.back());
    terminal.Kill(SIGCONT);
    EXPECT_TRUE(terminal.Says("The loop hung: the watchdog stopped the arms."))
        << terminal.Screen();
    EXPECT_TRUE(terminal.Says("after the stop")) << terminal.Screen();
    terminal.Let();
    terminal.Kill(SIGINT);
    EXPECT_EQ(terminal.Wait(), 1) << terminal.Screen();
    return;
  }
  GIVE_UP_BUSY(std::to_string(kAttempts) + " stops.");
}

// The end of a run is no hang: the arms come to rest by the loop, which says so.
TEST(ProcessFault, CtrlCInARunIsNoHang) {
  const MachineFolder folder({"ur", "ur"});
  folder.NotePushTests();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    FakeRig rig(FileOf("dual_ur5"), {"left=ur:" + HostOf(kLeft), "right=ur:" + HostOf(kRight)});
    Terminal terminal(Arguments(FileOf("dual_ur5"), folder));
    if (!terminal.Start(&rig)) continue;  // a busy computer's stop
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    terminal.Kill(SIGINT);
    const int code = terminal.Wait();
    const std::string screen = terminal.Screen();
    if (terminal.WasLate()) continue;
    EXPECT_EQ(code, 0) << screen;
    EXPECT_NE(screen.find("Now HELD"), std::string::npos) << screen;
    EXPECT_EQ(screen.find("hung"), std::string::npos) << screen;
    return;
  }
  GIVE_UP_BUSY(std::to_string(kAttempts) + " stops.");
}

// The watchdog's channel is closed in the middle: that is told at once, not when it is needed, and
// it comes back by itself. A busy computer may stop the loop meanwhile: the watchdog watches on.
TEST(ProcessFault, AStopChannelThatIsLostIsToldAndComesBack) {
  const MachineFolder folder({"ur", "franka"});
  folder.NotePushTests();
  FakeRig rig(FileOf("ur_and_panda"),
              {"left=ur:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
  Terminal terminal(Arguments(FileOf("ur_and_panda"), folder));
  ASSERT_TRUE(terminal.Says("Keys: ")) << terminal.Screen();
  EXPECT_EQ(rig.Ask("do left 0 drop primary"), "ok");
  EXPECT_TRUE(terminal.Says("The watchdog has lost its channel to " + HostOf(kLeft)))
      << terminal.Screen();
  EXPECT_TRUE(terminal.Says("The watchdog watches again.")) << terminal.Screen();
  EXPECT_EQ(rig.Ask("do left 0 mute primary"), "ok");
  EXPECT_TRUE(terminal.Says("The watchdog hears nothing from " + HostOf(kLeft)))
      << terminal.Screen();
  EXPECT_EQ(rig.Ask("do left 0 unmute primary"), "ok");
  EXPECT_TRUE(terminal.Says("again.")) << terminal.Screen();  // hears, or watches by another
  terminal.Kill(SIGINT);
  terminal.Wait();
}

// Fault 33: real arms do not move by a loop that any other program may hold up.
TEST(ProcessFault, WithoutRealTimePriorityRealArmsAreRefused) {
  // Names, too, that only begin as this computer's own addresses do.
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
