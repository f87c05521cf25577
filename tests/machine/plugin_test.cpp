// Tests controllers outside the program that fail in real time.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "machine/attempts.h"
#include "scenario/trial_note.h"
#include "support/find_plugins.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

// Lets a library fail in a run with real arms. The watchdog must stop the arms, and the program
// must end by itself with the exit code `code` and print `words`. The recording must be complete,
// or `repair` must recover it. The library fails soon after the start, so that a late computer has
// little time to stop the run before. Other tests let the watchdog stop arms in motion
// (ProcessFault), and count what `repair` recovers (FailingController).
void ExpectStoppedArms(const std::string& fault, int code, const std::string& words, bool whole) {
  test::FindPlugins();
  const test::TemporaryFolder own;
  const fs::path library = own / "at_time.so";
  const std::string parameters = "damping=40 fault=" + fault + " at=0.3";
  fs::copy_file(fs::path(std::getenv("PREDICTOR_PACKAGE_PATH")) / "at_time.so", library);
  NoteTrial(library, parameters, true);
  setenv("PREDICTOR_PACKAGE_PATH", own.path().c_str(), 1);
  const MachineFolder folder({"ur", "franka"});
  folder.NotePushTests();
  const std::string scenario = FileOf("ur_and_panda"), file = own / "run.mcap";
  Attempts attempts;
  while (attempts.Next()) {
    fs::remove(file);
    FakeRig rig(scenario, {"left=ur:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
    Attempts::AwaitCalm(&rig);
    Terminal terminal({"run", scenario, "--machine", folder.file(), "--set", "operator.type=person",
                       "--no-viewer", "--record", file, "--set",
                       "cobot.controller={type: plugin, library: package://" +
                           own.path().filename().string() +
                           "/at_time.so, parameters: " + parameters + "}"});
    // A late computer can stop the arms before the library fails.
    if (!terminal.Start(&rig) || !terminal.Comes(words)) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    EXPECT_EQ(terminal.Wait(), code) << terminal.Screen();
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    EXPECT_EQ(rig.Ask("mark"), "ok");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_LT(rig.Motion().fastest, 1e-3);
    const std::vector<std::string> log = rig.Log("left", 0);
    EXPECT_NE(std::find(log.begin(), log.end(), "program predictor_watchdog"), log.end());
    if (!whole) {
      Child repair({"repair", file});
      EXPECT_EQ(repair.Wait(), 0) << repair.errors();
    }
    Child verify({"verify", whole ? file : (own / "run.repaired.mcap").string()});
    EXPECT_EQ(verify.Wait(), 0) << verify.errors();
    EXPECT_NE(verify.output().find("bit for bit"), std::string::npos) << verify.output();
    return;
  }
  FAIL() << attempts.Words();
}

TEST(PluginCrash, IsStoppedByTheWatchdogAndLeavesARecording) {
  ExpectStoppedArms("crash", -SIGABRT, "The program crashed (SIGABRT", false);
}

TEST(PluginHang, IsStoppedByTheWatchdogAndEndsTheRun) {
  ExpectStoppedArms("hang", 3, "has not returned for 1 s", true);
}

// If a controller's process hangs in real time, gravity compensation and damping must replace it
// until the run stops.
TEST(PluginHang, OfAProcessIsBridgedUntilTheRunStops) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.mcap";
  for (int attempt = 0; attempt < Attempts::kMax; ++attempt) {
    fs::remove(file);
    Child run({"run", FileOf("box_9kg"), "--no-viewer", "--duration", "6", "--record", file,
               "--set",
               "cobot.controller={type: process, deadline: 9e-4, command: [python3, " +
                   std::string(PREDICTOR_SOURCE_DIR) +
                   "/tests/plugins/process.py, \"hang\", \"0.05\"]}"});
    EXPECT_EQ(run.Wait(), 1) << run.errors();
    const std::string said = run.output() + run.errors();
    EXPECT_NE(said.find("came to rest after"), std::string::npos) << said;
    Child verify({"verify", file});
    EXPECT_EQ(verify.Wait(), 0) << verify.output();
    // On a busy computer, the answers come so irregularly that the cobot oscillates.
    if (said.find("by cause 'oscillation'") != std::string::npos) continue;
    EXPECT_NE(said.find("the cobot's controller ended, or did not answer in time"),
              std::string::npos)
        << said;
    Child data({"export", "data", file, "run.controller", "--quiet"});
    EXPECT_EQ(data.Wait(), 0) << data.errors();
    for (const char* outcome : {",1\n", ",2\n"})
      EXPECT_NE(data.output().find(outcome), std::string::npos) << outcome << said;
    return;
  }
  GIVE_UP_BUSY("The process in Python answered too irregularly.");
}

}  // namespace
}  // namespace predictor
