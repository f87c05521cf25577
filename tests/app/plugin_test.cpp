// Tests controllers outside the program that fail. The arms must come to rest, a message must give
// the reason, and the recording must be complete or repairable. Replays must not need the
// controller.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "child.h"
#include "support/find_plugins.h"
#include "support/process.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

class FailingController : public testing::Test {
 protected:
  int Do(std::vector<std::string> arguments) {
    Child child(arguments);
    const int code = child.Wait();
    said_ = child.output() + child.errors();
    return code;
  }
  // Returns the command line of a recorded run. The process of this run finds the library only if
  // FindPlugins exists.
  std::vector<std::string> Arguments(const std::string& controller, const std::string& command) {
    std::vector<std::string> arguments = {command,      Scenario("box_9kg"),
                                          "--duration", "6",
                                          "--record",   file_,
                                          "--set",      "cobot.controller={" + controller + "}"};
    if (command == "run") arguments.emplace_back("--no-viewer");
    return arguments;
  }
  int Run(const std::string& controller, const std::string& command = "simulate") {
    test::FindPlugins();
    const int code = Do(Arguments(controller, command));
    unsetenv("PREDICTOR_PACKAGE_PATH");
    return code;
  }
  static std::string Library(const std::string& fault) {
    return "type: plugin, library: package://plugins/at_time.so, parameters: fault=" + fault +
           " at=2";
  }
  static std::string Program(const std::string& fault) {
    return "type: process, deadline: 9e-4, command: [python3, " +
           std::string(PREDICTOR_SOURCE_DIR) + "/tests/plugins/process.py, \"" + fault +
           "\", \"2\"]";
  }
  void ExpectStop(const std::string& words) {
    EXPECT_NE(said_.find(words), std::string::npos) << said_;
    EXPECT_NE(said_.find("came to rest after"), std::string::npos) << said_;
    EXPECT_EQ(Do({"verify", file_}), 0) << said_;
  }
  long TicksSaid() const {
    std::smatch match;
    return std::regex_search(said_, match, std::regex("(\\d+) ticks")) ? std::stol(match[1]) : -1;
  }

  const test::TemporaryFolder folder_;
  const std::string file_ = folder_ / "run.mcap";
  std::string said_;
};

TEST_F(FailingController, ThatReturnsNoNumberStopsTheRun) {
  ASSERT_EQ(Run(Library("nan")), 1) << said_;
  ExpectStop("the cobot's controller gave torques that are not finite. Correct the plug-in");
}

TEST_F(FailingController, ThatAllocatesStopsTheRun) {
  for (const char* command : {"simulate", "run"}) {
    ASSERT_EQ(Run(Library("allocate"), command), 1) << said_;
    const std::string said = said_;
    ExpectStop(
        "the cobot's controller allocated or freed heap memory in the control loop. Correct the "
        "plug-in");
    EXPECT_NE(said.find("malloc, free and the like: 2."), std::string::npos) << said;
    std::filesystem::remove(file_);
  }
}

TEST_F(FailingController, ThatEndsAsAProcessStopsTheRun) {
  ASSERT_EQ(Run(Program("crash")), 1) << said_;
  ExpectStop(
      "the cobot's controller ended, or did not answer in time. Read the output of the "
      "controller's program");
}

// The crash of the library also ends the program, whose message must state the cause. `repair` must
// recover the recording except for its last second.
TEST_F(FailingController, ThatCrashesAsALibraryIsNamedAndLeavesARecordingThatCanBeRepaired) {
  const struct {
    const char* fault;
    int signal;
    const char* name;
  } kCrashes[] = {
      {"crash", SIGABRT, "SIGABRT"}, {"access", SIGSEGV, "SIGSEGV"}, {"divide", SIGFPE, "SIGFPE"}};
  const std::string repaired = folder_ / "run.repaired.mcap";
  for (const auto& crash : kCrashes) {
    EXPECT_EQ(Run(Library(crash.fault)), -crash.signal) << said_;
    for (const std::string& words :
         {std::string("The program crashed (") + crash.name,
          std::string("in the function compute of the controller's library /"),
          std::string("/at_time.so."), "predictor repair " + file_})
      EXPECT_NE(said_.find(words), std::string::npos) << words << "\n" << said_;
    ASSERT_EQ(Do({"repair", file_}), 0) << said_;
    const long kept = TicksSaid();
    EXPECT_GT(kept, 2400) << said_;
    ASSERT_EQ(Do({"verify", repaired}), 0) << said_;
    EXPECT_EQ(TicksSaid(), kept);
    std::filesystem::remove(file_);
    std::filesystem::remove(repaired);
  }
}

// The program must not report a signal from another process as a crash of the library. The run in
// this test is not recorded.
TEST_F(FailingController, IsNotBlamedForASignalFromOutside) {
  Child child({"run", Scenario("box_9kg"), "--no-viewer"});
  ASSERT_TRUE(child.Says("Running")) << child.errors();
  child.Send(SIGSEGV);
  EXPECT_EQ(child.Wait(), -SIGSEGV);
  EXPECT_NE(child.errors().find("This is a defect of the program"), std::string::npos)
      << child.errors();
  EXPECT_EQ(child.errors().find("library"), std::string::npos) << child.errors();
  EXPECT_EQ(child.errors().find("repair"), std::string::npos) << child.errors();
}

// In real time, the recording is complete up to the hang, because other threads write it.
TEST_F(FailingController, ThatHangsAsALibraryEndsARunInRealTime) {
  ASSERT_EQ(Run(Library("hang"), "run"), 3) << said_;
  for (const char* words : {"The function compute of the controller's library /", "/at_time.so ",
                            "has not returned for 1 s", "Recorded "})
    EXPECT_NE(said_.find(words), std::string::npos) << words << "\n" << said_;
  EXPECT_EQ(said_.find("repair"), std::string::npos) << said_;
  ASSERT_EQ(Do({"verify", file_}), 0) << said_;
  EXPECT_GT(TicksSaid(), 2000) << said_;
}

// In virtual time, the thread that hangs also writes the recording.
TEST_F(FailingController, ThatHangsAsALibraryEndsASimulation) {
  ASSERT_EQ(Run(Library("hang")), 3) << said_;
  for (const std::string& words : {std::string("has not returned for 10 s"),
                                   std::string("/at_time.so "), "predictor repair " + file_})
    EXPECT_NE(said_.find(words), std::string::npos) << words << "\n" << said_;
  ASSERT_EQ(Do({"repair", file_}), 0) << said_;
  EXPECT_GT(TicksSaid(), 2400) << said_;
  ASSERT_EQ(Do({"verify", folder_ / "run.repaired.mcap"}), 0) << said_;
}

// Even while a library takes a long time to prepare itself, Ctrl-C must end the program. The
// program handles Ctrl-C as soon as the thread that watches the library has started.
TEST_F(FailingController, ThatHangsInItsPreparationEndsWithTheFirstCtrlC) {
  test::FindPlugins();
  Child child(Arguments(Library("create"), "run"));
  unsetenv("PREDICTOR_PACKAGE_PATH");
  const std::string tasks = "/proc/" + std::to_string(child.pid()) + "/task";
  ASSERT_TRUE(test::Becomes([&] {
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      std::string name;
      std::getline(std::ifstream(task.path() / "comm"), name);
      if (name == "plug-in watch") return true;
    }
    return false;
  }));
  child.Send(SIGINT);
  EXPECT_EQ(child.Wait(), 3) << child.errors();
  EXPECT_NE(child.errors().find("The function create of the controller's library /"),
            std::string::npos)
      << child.errors();
}

// The result of the trial applies only to a library with exactly these bytes, and to the same
// parameters.
TEST_F(FailingController, ThatAllocatesFailsItsTrial) {
  const auto library = [](const char* name) {
    return "cobot.controller={type: plugin, library: package://plugins/" + std::string(name) +
           ", parameters: fault=allocate at=2}";
  };
  ASSERT_EQ(Run(Library("none")), 0) << said_;
  test::FindPlugins();
  namespace fs = std::filesystem;
  const fs::path mine = folder_ / "plugins";
  fs::create_directories(mine);
  fs::copy_file(fs::path(std::getenv("PREDICTOR_PACKAGE_PATH")) / "at_time.so", mine / "mine.so");
  setenv("PREDICTOR_PACKAGE_PATH", mine.c_str(), 1);
  EXPECT_EQ(Do({"trial", Scenario("box_9kg"), file_, "--set", library("mine.so"), "--set",
                "cobot.controller.parameters=fault=none"}),
            0)
      << said_;
  const auto noted = [&] {
    std::ifstream note(mine / "mine.so.trial");
    return std::string(std::istreambuf_iterator<char>(note), {});
  };
  EXPECT_NE(noted().find("with the parameters fault=none\n"), std::string::npos) << noted();
  EXPECT_EQ(Do({"trial", Scenario("box_9kg"), file_, "--set", library("mine.so")}), 1) << said_;
  EXPECT_NE(said_.find("the library allocates heap memory in"), std::string::npos) << said_;
  EXPECT_NE(said_.find("first at 2.00"), std::string::npos) << said_;
  EXPECT_NE(noted().find("with the parameters fault=none\n"), std::string::npos) << noted();
  EXPECT_EQ(noted().find("allocate"), std::string::npos) << noted();
  EXPECT_EQ(Do({"trial", Scenario("box_9kg"), file_}), 2);
  EXPECT_NE(said_.find("which needs no trial"), std::string::npos) << said_;
}

TEST_F(FailingController, ThatDoesNotExistIsNamedWithItsPlace) {
  ASSERT_EQ(Run("type: plugin, library: no_such.so"), 2);
  EXPECT_NE(said_.find("--set cobot.controller:1:"), std::string::npos) << said_;
  EXPECT_NE(said_.find("no_such.so"), std::string::npos) << said_;
}

}  // namespace
}  // namespace predictor
