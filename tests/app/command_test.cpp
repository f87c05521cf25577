// The program as a script or a shell meets it: exit codes, streams, signals.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

TEST(ExitCode, TellsHowItEnded) {
  const struct {
    std::vector<std::string> arguments;
    int code;
  } cases[] = {
      {{"simulate", Scenario("box_9kg"), "--duration", "1", "--quiet"}, 0},
      {{"simulate", Scenario("push"), "--quiet"}, 1},
      {{"simulate", Scenario("no_such_scenario")}, 2},
      {{"simulate", Scenario("box_9kg"), "--set", "safety.force=-1"}, 2},
      {{"simulate"}, 2},
      {{"dance"}, 2},
      {{}, 2},
      {{"--help"}, 0},
      {{"run", "--help"}, 0},
      {{"--version"}, 0},
      {{"schema"}, 0},
      {{"schema", "--machine"}, 0},
      {{"check", Scenario("box_9kg"), "--no-search", "--quiet"}, 0},
      {{"check", Scenario("underdamped"), "--no-search", "--quiet"}, 1},
  };
  for (const auto& c : cases) {
    Child child(c.arguments);
    EXPECT_EQ(child.Wait(), c.code) << testing::PrintToString(c.arguments) << child.errors();
  }
}

TEST(ExitCode, OfARunThatNeverStartedComesWithTheArmAndItsDistance) {
  Child child({"simulate", Scenario("box_9kg"), "--quiet", "--set", "safety.align_tolerance=1e-9"});
  EXPECT_EQ(child.Wait(), 3);
  EXPECT_NE(child.errors().find("the left arm stayed"), std::string::npos) << child.errors();
}

TEST(ExitCode, OfAnUnknownCommandComesWithItsName) {
  Child child({"dance"});
  EXPECT_EQ(child.Wait(), 2);
  EXPECT_NE(child.errors().find("no command 'dance'"), std::string::npos) << child.errors();
}

TEST(ExitCode, OfNothingComesWithTheCommandsThatThereAre) {
  Child child(std::vector<std::string>{});
  EXPECT_EQ(child.Wait(), 2);
  for (const char* text : {"Subcommands:", "Run a scenario in real time", "calibrate"})
    EXPECT_NE(child.errors().find(text), std::string::npos) << child.errors();
}

// What was asked for and would not be done must not go unsaid.
TEST(ExitCode, OfOptionsThatWouldDoNothingComesWithTheirReason) {
  const struct {
    std::vector<std::string> options;
    const char* reason;
  } cases[] = {
      {{"--certificate", "c.pem", "--key", "k.pem"}, "--expose"},
      {{"--expose", "--certificate", "c.pem"}, "--key"},
      {{"--ros-tcp-allow", "192.0.2.0/24"}, "--ros-tcp"},
      {{"--ros-tcp-mode", "ros2"}, "--ros-tcp"},
      {{"--ros-tcp-port", "10001"}, "--ros-tcp"},
      {{"--port", "70000"}, "65535"},
      {{"--foxglove-origin", "app.foxglove.dev/path"}, "is no origin"},
      {{"--viewer", "off", "--expose"}, "no page"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> arguments = {"run", Scenario("box_9kg")};
    arguments.insert(arguments.end(), c.options.begin(), c.options.end());
    Child child(arguments);
    EXPECT_EQ(child.Wait(), 2) << testing::PrintToString(c.options);
    EXPECT_NE(child.errors().find(c.reason), std::string::npos) << child.errors();
  }
}

TEST(Help, OfEachStepOfCalibrateIsItsOwn) {
  const struct {
    const char *step, *says;
  } steps[] = {{"handle", "Weigh the handle"},
               {"bases", "--tip"},
               {"loop", "THE ARM MOVES"},
               {"push", "Only this arm"}};
  for (const auto& asked : steps) {
    Child child({"calibrate", asked.step, "--help"});
    EXPECT_EQ(child.Wait(), 0);
    for (const auto& [step, says] : steps)
      EXPECT_EQ(child.output().find(says) != std::string::npos, step == asked.step)
          << child.output();
    EXPECT_NE(child.output().find(std::string("Example: predictor calibrate ") + asked.step),
              std::string::npos)
        << child.output();
  }
  Child none({"calibrate"});
  EXPECT_EQ(none.Wait(), 2);
  EXPECT_NE(none.errors().find("handle, bases, loop and push"), std::string::npos) << none.errors();
}

TEST(Summary, GoesToStandardOutputAloneOrToAFile) {
  Child child({"simulate", Scenario("box_9kg"), "--duration", "1", "--summary", "-"});
  EXPECT_EQ(child.Wait(), 0);
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_EQ(summary["ticks"], 1000);
  EXPECT_DOUBLE_EQ(summary["duration_s"], 1);
  EXPECT_NE(child.errors().find("No safety stop."), std::string::npos);  // the table

  const fs::path file = fs::temp_directory_path() / ("summary-" + std::to_string(getpid()));
  Child other({"simulate", Scenario("box_9kg"), "--duration", "1", "--summary", file.string()});
  EXPECT_EQ(other.Wait(), 0);
  std::ifstream stream(file);
  EXPECT_EQ(nlohmann::json::parse(stream)["seed"], 1);
  fs::remove(file);
}

TEST(Summary, ThatCannotBeWrittenIsToldBeforeTheRunOrFails) {
  Child nowhere({"simulate", Scenario("box_9kg"), "--summary", "/no/such/folder/file"});
  EXPECT_EQ(nowhere.Wait(), 2);
  EXPECT_NE(nowhere.errors().find("cannot be written"), std::string::npos);
  EXPECT_EQ(nowhere.errors().find("Simulating"), std::string::npos);
  Child full({"simulate", Scenario("box_9kg"), "--duration", "1", "--summary", "-"}, "/dev/full");
  EXPECT_EQ(full.Wait(), 3);
}

// Whatever asks a run to end has the arms brought to rest first, and the summary told.
class Signals : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, Signals, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT));

TEST_P(Signals, EndARunAtRest) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off", "--summary", "-"});
  ASSERT_TRUE(child.Says("RUN")) << child.errors();
  child.Send(GetParam());
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_TRUE(summary["stop"].is_null());
  EXPECT_LT(summary["duration_s"], 29);
  EXPECT_GT(summary["ticks"], 0);
}

TEST(Signals, BeforeTheStartAreNoFailure) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off"});
  ASSERT_TRUE(child.Says("Device"));
  child.Send(SIGINT);
  EXPECT_EQ(child.Wait(), 0) << child.errors();
}

// The page's process, child of the run; 0 if there is none.
int ViewerOf(int run) {
  std::ifstream children("/proc/" + std::to_string(run) + "/task/" + std::to_string(run) +
                         "/children");
  for (int child = 0; children >> child;) {
    std::ifstream command("/proc/" + std::to_string(child) + "/cmdline");
    std::string text;
    std::getline(command, text);
    if (text.find("viewer-process") != std::string::npos) return child;
  }
  return 0;
}

// Whatever becomes of the page, the tick goes on, and no tick is lost by it.
TEST(Viewer, ThatIsKilledStopsNothing) {
  Child child({"run", Scenario("box_9kg"), "--port", "0", "--duration", "6", "--summary", "-"});
  ASSERT_TRUE(child.Says("/#code=")) << child.errors();
  ASSERT_TRUE(child.Says("RUN")) << child.errors();
  const int viewer = ViewerOf(child.pid());
  ASSERT_GT(viewer, 0);
  ASSERT_EQ(kill(viewer, SIGKILL), 0);
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_TRUE(summary["stop"].is_null());
  EXPECT_EQ(summary["ticks"], 6000);
}

TEST(Viewer, OfASecondRunOnTheSamePortIsRefusedInWords) {
  Child first({"run", Scenario("box_9kg"), "--port", "0"});
  ASSERT_TRUE(first.Says("/#code=")) << first.errors();
  const std::size_t at = first.errors().find("localhost:") + 10;
  const std::string port = first.errors().substr(at, first.errors().find('/', at) - at);
  Child second({"run", Scenario("box_9kg"), "--port", port});
  EXPECT_EQ(second.Wait(), 2);
  EXPECT_NE(second.errors().find("--port"), std::string::npos) << second.errors();
}

TEST(RosTcp, IsServedBesideTheRun) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off", "--ros-tcp", "--ros-tcp-port", "0",
               "--ros-tcp-mode", "ros2", "--duration", "1"});
  EXPECT_TRUE(child.Says("ROS-TCP   port ")) << child.errors();
  EXPECT_TRUE(child.Says("ROS2"));
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  Child wrong({"run", Scenario("box_9kg"), "--viewer", "off", "--ros-tcp", "--ros-tcp-port", "0",
               "--ros-tcp-allow", "everywhere"});
  EXPECT_EQ(wrong.Wait(), 2);
  EXPECT_NE(wrong.errors().find("is not a network"), std::string::npos);
}

TEST(Streams, ThatAreClosedEndNothing) {
  Child child({"run", Scenario("box_9kg"), "--viewer", "off", "--duration", "4"});
  ASSERT_TRUE(child.Says("RUN"));
  child.CloseStreams();
  EXPECT_GE(child.Wait(), 0);  // not killed by SIGPIPE
}

}  // namespace
}  // namespace predictor
