// Tests the program as a script or a shell uses it: exit codes, streams and signals.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "child.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

TEST(ExitCode, ShowsHowItEnded) {
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
      {{"schema", "scenario"}, 0},
      {{"schema", "machine"}, 0},
      {{"schema", "summary"}, 0},
      {{"schema", "check"}, 0},
      {{"reference", "quantities"}, 0},
      {{"reference", "console"}, 0},
      {{"check", Scenario("box_9kg"), "--no-search", "--quiet"}, 0},
      {{"check", Scenario("underdamped"), "--no-search", "--quiet"}, 1},
      {{"check", Scenario("box_9kg"), "--only-walls"}, 2},  // needs --map
  };
  for (const auto& c : cases) {
    Child child(c.arguments);
    EXPECT_EQ(child.Wait(), c.code) << testing::PrintToString(c.arguments) << child.errors();
  }
}

// A file with an error is not an impossible combination of a controller and a hazard.
TEST(ExitCode, OfAHazardStudyNamesTheFileWithAnErrorAndLeavesAnEarlierStudyAlone) {
  const test::TemporaryFolder folder;
  const std::string wrong = folder / "wrong.yaml";
  std::ifstream right(Scenario("single_arm"));
  std::string text{std::istreambuf_iterator<char>(right), {}};
  text.replace(text.find("model: "), std::string("model: ").size(), "model: nowhere.urdf  # ");
  std::ofstream(wrong) << text;
  std::ofstream(folder / "hazards.csv") << "earlier\n";
  const std::string missing = Scenario("no_such_scenario");
  const std::pair<std::string, const char*> cases[] = {{missing, "no_such_scenario.yaml"},
                                                       {wrong, "nowhere.urdf"}};
  for (const auto& [file, named] : cases) {
    Child child({"hazards", Scenario("single_arm"), file, "--seeds", "1", "--quiet", "--force",
                 "-o", folder.path().string()});
    EXPECT_EQ(child.Wait(), 2) << file;
    EXPECT_TRUE(child.errors().starts_with("predictor: error: ")) << child.errors();
    EXPECT_NE(child.errors().find(named), std::string::npos) << child.errors();
    std::ifstream earlier(folder / "hazards.csv");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(earlier), {}), "earlier\n");
    EXPECT_FALSE(fs::exists(folder / "runs.csv"));
  }
}

TEST(ExitCode, OfARunThatNeverStartedNamesTheArmAndItsDistance) {
  Child child({"simulate", Scenario("box_9kg"), "--quiet", "--set", "safety.align_tolerance=1e-9"});
  EXPECT_EQ(child.Wait(), 3);
  EXPECT_NE(child.errors().find("the left arm remained"), std::string::npos) << child.errors();
}

TEST(ExitCode, OfARefusedStartGivesReasonPlaceAndRemedy) {
  Child child({"simulate", Scenario("box_9kg"), "--quiet", "--set", "rendering.joint_security=1",
               "--set", "rendering.joint_influence=1.1"});
  EXPECT_EQ(child.Wait(), 3);
  EXPECT_TRUE(child.errors().starts_with("predictor: error: the run did not start.\n"))
      << child.errors();
  for (const char* text : {"box_9kg.yaml:", "device.arms.left.posture: the arm starts with joint",
                           "Choose another posture, or move device.arms.left.base"})
    EXPECT_NE(child.errors().find(text), std::string::npos) << child.errors();
}

// The name of a scenario from elsewhere may contain control characters. Such control characters
// must not reach the terminal.
TEST(Terminal, ObeysNoNameOfAScenario) {
  const test::TemporaryFolder folder;
  const std::string file = Scenario("box_9kg"), recording = folder.path() / "e.mcap";
  const std::string name = R"(name="\e]0;owned\a\e[2J\u009b31m\u202eX\r")";
  const std::string shown = R"(\x1b]0;owned\x07\x1b[2J\u009b31m\u202eX)";
  const auto harmless = [](const std::string& text) {
    return text.find_first_of("\x1b\a\r") == std::string::npos &&
           text.find("\u009b") == std::string::npos && text.find("\u202e") == std::string::npos;
  };
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"simulate", file, "--set", name, "--duration", "0.2", "--record",
                                 recording},
        {"simulate", file, "--set", name, "--duration", "0.2", "--json", "-"},
        {"check", file, "--set", name, "--no-search"}}) {
    Child child(arguments);
    EXPECT_LE(child.Wait(), 1) << child.errors();
    EXPECT_TRUE(harmless(child.errors())) << arguments[0];
    const bool json = arguments.back() == "-";
    EXPECT_TRUE(json || harmless(child.output())) << arguments[0];
    EXPECT_NE((json ? child.errors() : child.output()).find(shown), std::string::npos)
        << arguments[0] << child.output();
  }
  Child replay({"replay", recording, "--port", "0", "--json"});
  EXPECT_TRUE(replay.Says("Press Ctrl-C")) << replay.errors();
  replay.Send(SIGINT);
  EXPECT_EQ(replay.Wait(), 0) << replay.errors();
  EXPECT_GT(nlohmann::json::parse(replay.output())["duration_s"], 0.1) << replay.output();
  EXPECT_TRUE(harmless(replay.errors()));
  EXPECT_NE(replay.errors().find(shown), std::string::npos) << replay.errors();
}

TEST(ExitCode, OfAnUnknownCommandNamesIt) {
  Child child({"dance"});
  EXPECT_EQ(child.Wait(), 2);
  EXPECT_NE(child.errors().find("no command \"dance\""), std::string::npos) << child.errors();
}

TEST(ExitCode, WithoutACommandListsTheCommands) {
  Child child(std::vector<std::string>{});
  EXPECT_EQ(child.Wait(), 2);
  for (const char* text : {"Analyse:", "Run a scenario in real time", "calibrate"})
    EXPECT_NE(child.errors().find(text), std::string::npos) << child.errors();
}

// An option that would have no effect must be refused with the reason.
TEST(ExitCode, OfOptionsWithoutEffectGivesTheReason) {
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
      {{"--foxglove-origin", "app.foxglove.dev/path"}, "is not an origin"},
      {{"--no-viewer", "--expose"}, "no page"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> arguments = {"run", Scenario("box_9kg")};
    arguments.insert(arguments.end(), c.options.begin(), c.options.end());
    Child child(arguments);
    EXPECT_EQ(child.Wait(), 2) << testing::PrintToString(c.options);
    EXPECT_NE(child.errors().find(c.reason), std::string::npos) << child.errors();
  }
}

// In real time, a person may hold the handles, so the detectors must be on.
TEST(ExitCode, OfARunWithoutOscillationDetectorsGivesTheReason) {
  const std::vector<std::string> off = {"--set", "safety.oscillation.enabled=false"};
  Child run({"run", Scenario("box_9kg"), "--no-viewer", "--no-record", off[0], off[1]});
  EXPECT_EQ(run.Wait(), 2);
  EXPECT_NE(run.errors().find(
                "safety.oscillation.enabled is false, which is allowed in virtual time only"),
            std::string::npos)
      << run.errors();
  Child simulate({"simulate", Scenario("box_9kg"), "--duration", "0.1", off[0], off[1]});
  EXPECT_EQ(simulate.Wait(), 0) << simulate.errors();
}

// DART's steps may take too long for real time, so the program must refuse DART.
TEST(ExitCode, OfARunWithDartGivesTheReason) {
  Child run({"run", Scenario("box_9kg"), "--no-viewer", "--no-record", "--set",
             "simulation.engine=dart"});
  EXPECT_EQ(run.Wait(), 2);
  for (const char* words : {"simulation.engine is dart, which runs in virtual time only",
                            "Set simulation.engine to mujoco, or use `predictor simulate`"})
    EXPECT_NE(run.errors().find(words), std::string::npos) << run.errors();
}

TEST(ExitCode, OfARunWithoutAllRepairsGivesTheReason) {
  const std::vector<std::string> paper = {"--set", "rendering.formulation=paper"};
  Child run({"run", Scenario("box_9kg"), "--no-viewer", "--no-record", paper[0], paper[1]});
  EXPECT_EQ(run.Wait(), 2);
  EXPECT_NE(run.errors().find("rendering.formulation lacks repairs"), std::string::npos)
      << run.errors();
  Child simulate({"simulate", Scenario("box_9kg"), "--duration", "0.1", paper[0], paper[1]});
  EXPECT_EQ(simulate.Wait(), 0) << simulate.errors();
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
    EXPECT_NE(child.output().find(std::string("Example:\n  predictor calibrate ") + asked.step),
              std::string::npos)
        << child.output();
  }
  Child none({"calibrate"});
  EXPECT_EQ(none.Wait(), 2);
  EXPECT_NE(none.errors().find("handle, bases, loop, push"), std::string::npos) << none.errors();
}

TEST(Summary, GoesToStandardOutputAloneOrToAFile) {
  Child child({"simulate", Scenario("box_9kg"), "--duration", "1", "--json", "-"});
  EXPECT_EQ(child.Wait(), 0);
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_EQ(summary["ticks"], 1000);
  EXPECT_DOUBLE_EQ(summary["duration_s"], 1);
  EXPECT_NE(child.errors().find("No safety stop."), std::string::npos);  // the summary table

  const fs::path file = fs::temp_directory_path() / ("summary-" + std::to_string(getpid()));
  Child other({"simulate", Scenario("box_9kg"), "--duration", "1", "--json", file.string()});
  EXPECT_EQ(other.Wait(), 0);
  std::ifstream stream(file);
  EXPECT_EQ(nlohmann::json::parse(stream)["seed"], 1);
  fs::remove(file);
}

TEST(Summary, ThatCannotBeWrittenIsReportedBeforeTheRunOrFails) {
  Child nowhere({"simulate", Scenario("box_9kg"), "--json", "/no/such/folder/file"});
  EXPECT_EQ(nowhere.Wait(), 2);
  EXPECT_NE(nowhere.errors().find("cannot be written"), std::string::npos);
  EXPECT_EQ(nowhere.errors().find("Simulating"), std::string::npos);
  Child full({"simulate", Scenario("box_9kg"), "--duration", "1", "--json", "-"}, "/dev/full");
  EXPECT_EQ(full.Wait(), 3);
}

// After any request to end, the run brings the arms to rest before it prints its summary.
class Signals : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, Signals, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT),
                         [](const auto& sent) {
                           return std::string("SIG") + sigabbrev_np(sent.param);
                         });

TEST_P(Signals, EndARunAtRest) {
  Child child({"run", Scenario("box_9kg"), "--no-viewer", "--json", "-"});
  ASSERT_TRUE(child.Says("RUN")) << child.errors();
  child.Send(GetParam());
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  const auto summary = nlohmann::json::parse(child.output());
  EXPECT_TRUE(summary["stop"].is_null());
  EXPECT_LT(summary["duration_s"], 29);
  EXPECT_GT(summary["ticks"], 0);
}

TEST(Signals, BeforeTheStartAreNotAFailure) {
  Child child({"run", Scenario("box_9kg"), "--no-viewer"});
  ASSERT_TRUE(child.Says("Device"));
  child.Send(SIGINT);
  EXPECT_EQ(child.Wait(), 0) << child.errors();
}

// Returns the viewer process, which is a child of the run, or 0 if there is none.
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

// If the viewer process dies, the run continues and loses no tick.
TEST(Viewer, ThatIsKilledStopsNothing) {
  Child child({"run", Scenario("box_9kg"), "--port", "0", "--duration", "6", "--json", "-"});
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

TEST(Viewer, OfASecondRunOnTheSamePortIsRefusedWithAMessage) {
  Child first({"run", Scenario("box_9kg"), "--port", "0"});
  ASSERT_TRUE(first.Says("/#code=")) << first.errors();
  const std::size_t at = first.errors().find("localhost:") + 10;
  const std::string port = first.errors().substr(at, first.errors().find('/', at) - at);
  Child second({"run", Scenario("box_9kg"), "--port", port});
  EXPECT_EQ(second.Wait(), 2);
  EXPECT_NE(second.errors().find("--port"), std::string::npos) << second.errors();
}

TEST(RosTcp, IsServedDuringTheRun) {
  Child child({"run", Scenario("box_9kg"), "--no-viewer", "--ros-tcp", "--ros-tcp-port", "0",
               "--ros-tcp-mode", "ros2", "--duration", "1"});
  EXPECT_TRUE(child.Says("ROS-TCP   port ")) << child.errors();
  EXPECT_TRUE(child.Says("ROS2"));
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  Child wrong({"run", Scenario("box_9kg"), "--no-viewer", "--ros-tcp", "--ros-tcp-port", "0",
               "--ros-tcp-allow", "everywhere"});
  EXPECT_EQ(wrong.Wait(), 2);
  EXPECT_NE(wrong.errors().find("is not an IPv4 network"), std::string::npos);
}

TEST(Streams, ThatAreClosedEndNothing) {
  Child child({"run", Scenario("box_9kg"), "--no-viewer", "--duration", "4"});
  ASSERT_TRUE(child.Says("RUN"));
  child.CloseStreams();
  EXPECT_GE(child.Wait(), 0);  // not killed by SIGPIPE
}

}  // namespace
}  // namespace predictor
