// Tests controllers outside the program that fail. The arms must come to rest, a message must give
// the reason, and the recording must be complete or repairable. Replays must not need the
// controller.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "child.h"
#include "support/find_plugins.h"
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
  // Records a run of a scenario that can find the library.
  int Run(const std::string& controller) {
    test::FindPlugins();
    std::vector<std::string> arguments = {"simulate",   Scenario("box_9kg"),
                                          "--duration", "6",
                                          "--record",   file_,
                                          "--set",      "cobot.controller={" + controller + "}"};
    const int code = Do(arguments);
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
    EXPECT_NE(said_.find("At rest after"), std::string::npos) << said_;
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

TEST_F(FailingController, ThatEndsAsAProcessStopsTheRun) {
  ASSERT_EQ(Run(Program("crash")), 1) << said_;
  ExpectStop("the cobot's controller no longer answers. Read what its program printed");
}

// The library crashes the program as well. `repair` must recover all but the last second.
TEST_F(FailingController, ThatCrashesAsALibraryLeavesARecordingThatCanBeRepaired) {
  EXPECT_NE(Run(Library("crash")), 0);
  ASSERT_EQ(Do({"repair", file_}), 0) << said_;
  const long kept = TicksSaid();
  EXPECT_GT(kept, 2400) << said_;
  ASSERT_EQ(Do({"verify", folder_ / "run.repaired.mcap"}), 0) << said_;
  EXPECT_EQ(TicksSaid(), kept);
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
  EXPECT_NE(said_.find("it allocates heap memory in"), std::string::npos) << said_;
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
