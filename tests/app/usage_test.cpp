// Tests the command line: help, misspelt words, existing files, and a first scenario.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "child.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr int kBadInput = 2;

TEST(Usage, AMisspeltNameGetsASuggestion) {
  const struct {
    std::vector<std::string> arguments;
    std::string error, hint;
  } cases[] = {
      {{"simulat", "x.yaml"},
       "there is no command \"simulat\".",
       "Did you mean `predictor simulate`?"},
      {{"survey", "reprot"},
       "there is no command \"survey reprot\".",
       "Did you mean `predictor survey report`?"},
      {{"simulate", "x.yaml", "--duraton", "1"},
       "there is no option \"--duraton\".",
       "Did you mean --duration?"},
      {{"simulate", "x.yaml", "--duraton=1"},
       "there is no option \"--duraton\".",
       "Did you mean --duration?"},
      {{"simulate", "x.yaml", "--sed", "1"},
       "there is no option \"--sed\".",
       "Did you mean --seed?"},
      {{"--seed", "1", "simulate", "x.yaml"},
       "there is no option \"--seed\" before the command.",
       "Write --seed after `predictor simulate`."},
      {{"--sed", "1"},
       "there is no option \"--sed\" before the command.",
       "Give the command first. `predictor --help` shows how to use it."},
      {{"calibrate"}, "a command is missing.", "The commands are handle, bases, loop, push."},
      {{"help", "chek"}, "there is no command \"chek\".", "Did you mean `predictor check`?"},
      {{"simulate"}, "SCENARIO is missing.", "`predictor simulate --help` shows how to use it."},
      {{"replay", "x.mcap", "y.mcap"},
       "unexpected argument \"y.mcap\".",
       "`predictor replay --help` shows how to use it."},
      {{"replay", "x.mcap", "--port", "abc"},
       "--port must be 0 to 65535, not abc.",
       "`predictor replay --help` shows how to use it."},
      {{"calibrate", "loop", "--machine", "x", "--arm", "up"},
       "--arm must be one of left,right, not up.",
       "`predictor calibrate loop --help` shows how to use it."},
  };
  for (const auto& c : cases) {
    Child child(c.arguments);
    EXPECT_EQ(child.Wait(), kBadInput);
    EXPECT_EQ(child.errors(), "predictor: error: " + c.error + "\nhint: " + c.hint + "\n");
    EXPECT_EQ(child.output(), "");
  }
}

TEST(Usage, ValuesOfTheScenarioAreNamedByTheOptionThatWasTyped) {
  Child child({"simulate", Scenario("box_9kg"), "--duration", "abc"});
  EXPECT_EQ(child.Wait(), kBadInput);
  EXPECT_NE(child.errors().find("--duration"), std::string::npos) << child.errors();
  EXPECT_EQ(child.errors().find("--set"), std::string::npos) << child.errors();
}

TEST(Help, ListsCommandsInGroupsAndEnvironmentAndExitCodes) {
  Child child({"--help"});
  EXPECT_EQ(child.Wait(), 0);
  for (const char* text : {"\nRun:\n", "\nAnalyse:\n", "\nRig:\n", "\nTools:\n",
                           "Exit codes:", "PREDICTOR_PACKAGE_PATH", "Examples:"})
    EXPECT_NE(child.output().find(text), std::string::npos) << text << child.output();
}

TEST(Help, WithoutACommandIsTheListOfCommands) {
  Child list({"--help"}), help({"help"});
  EXPECT_EQ(list.Wait(), 0);
  EXPECT_EQ(help.Wait(), 0);
  EXPECT_EQ(help.output(), list.output());
}

TEST(Help, OfEachCommandHasExamplesAndDefaultsAndFitsTheTerminal) {
  for (const std::vector<std::string>& command : {std::vector<std::string>{"run"},
                                                  {"simulate"},
                                                  {"replay"},
                                                  {"init"},
                                                  {"check"},
                                                  {"report"},
                                                  {"compare"},
                                                  {"verify"},
                                                  {"identify"},
                                                  {"reproduce"},
                                                  {"survey", "ask"},
                                                  {"survey", "report"},
                                                  {"survey", "remove"},
                                                  {"devices"},
                                                  {"calibrate", "handle"},
                                                  {"calibrate", "bases"},
                                                  {"calibrate", "loop"},
                                                  {"calibrate", "push"},
                                                  {"export", "data"},
                                                  {"export", "events"},
                                                  {"export", "channels"},
                                                  {"export", "scene"},
                                                  {"export", "person"},
                                                  {"import"},
                                                  {"share"},
                                                  {"forget"},
                                                  {"pseudonym"},
                                                  {"repair"}}) {
    std::vector<std::string> by_option = command, by_command = command;
    by_option.emplace_back("--help");
    by_command.insert(by_command.begin(), "help");
    Child child(by_option), same(by_command);
    EXPECT_EQ(child.Wait(), 0);
    EXPECT_EQ(same.Wait(), 0);
    EXPECT_EQ(child.output(), same.output());
    EXPECT_NE(child.output().find("Example"), std::string::npos) << child.output();
    std::istringstream lines(child.output());
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
    EXPECT_EQ(child.output().find("PREDICTOR_PACKAGE_PATH  folders"), std::string::npos)
        << "the text below the help of the whole program:\n"
        << child.output();
  }
  Child run({"help", "run"});
  EXPECT_EQ(run.Wait(), 0);
  for (const char* text : {"--[no-]viewer", "[default: 8080]", "--[no-]stay", "\nRecording:\n"})
    EXPECT_NE(run.output().find(text), std::string::npos) << text << run.output();
}

TEST(Version, NamesTheCommitTheFormatOfRecordingsAndTheEngines) {
  for (const char* how : {"version", "--version", "-V"}) {
    Child child({how});
    EXPECT_EQ(child.Wait(), 0);
    EXPECT_TRUE(std::regex_match(
        child.output(),
        std::regex("predictor \\d+\\.\\d+\\.\\d+( \\([0-9a-f]{7}\\+?\\))?, recording format \\d+, "
                   "MuJoCo \\d+\\.\\d+\\.\\d+(, DART \\d+\\.\\d+\\.\\d+)?\n")))
        << child.output();
  }
}

// Returns the completions that bash offers after "predictor " and `words`.
std::string Completed(const std::string& words) {
  const std::string script =
      "source <('" PREDICTOR_BINARY "' completion bash); COMP_WORDS=(predictor " + words +
      "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _predictor; "
      "echo \"${COMPREPLY[*]}\"";
  std::FILE* bash = popen(
      ("bash -c '" + std::regex_replace(script, std::regex("'"), "'\\''") + "'").c_str(), "r");
  std::string text;
  char piece[256];
  while (std::fgets(piece, sizeof piece, bash)) text += piece;
  EXPECT_EQ(pclose(bash), 0);
  return text;
}

TEST(Completion, OffersCommandsAndOptions) {
  EXPECT_EQ(Completed("sim"), "simulate\n");
  EXPECT_EQ(Completed("survey re"), "report remove\n");
  EXPECT_EQ(Completed("simulate --se"), "--set --seed\n");
}

TEST(ManualPage, DescribesEachCommand) {
  Child child({"man"});
  EXPECT_EQ(child.Wait(), 0);
  EXPECT_TRUE(child.output().starts_with(".TH PREDICTOR 1")) << child.output();
  for (const char* text : {".SS predictor run", ".SS predictor survey ask", ".SS predictor verify"})
    EXPECT_NE(child.output().find(text), std::string::npos) << text;
}

class Written : public testing::Test {
 protected:
  int Do(const std::vector<std::string>& arguments) {
    Child child(arguments);
    const int code = child.Wait();
    said_ = child.errors();
    printed_ = child.output();
    return code;
  }
  std::string Path(const char* name) const { return (folder_.path() / name).string(); }

  const test::TemporaryFolder folder_;
  std::string said_, printed_;
};

// A repeatable option takes one value each time, so the file after the value is the command's.
TEST_F(Written, ARepeatableOptionDoesNotTakeTheScenario) {
  const std::string scenario = Path("none.yaml");
  const std::vector<std::vector<std::string>> commands = {
      {"population", "-o", Path("study"), "--set", "duration=1", scenario},
      {"population", "-o", Path("study"), "--heights", "0.8,1.0", scenario},
      {"run", "--name", "laboratory", scenario},
      {"run", "--foxglove-origin", "https://app.foxglove.dev", scenario},
      {"simulate", "--label", "a=b", "--label", "c=d", scenario}};
  for (const std::vector<std::string>& command : commands) {
    EXPECT_EQ(Do(command), kBadInput) << command[0];
    EXPECT_NE(said_.find(scenario), std::string::npos) << command[0] << said_;
  }
}

TEST_F(Written, FilesAreReplacedByForceOnly) {
  const std::string recording = Path("a.mcap"), json = Path("a.json"), page = Path("a.html");
  const std::vector<std::vector<std::string>> commands = {
      {"simulate", Scenario("single_arm"), "--duration", "0.5", "--record", recording, "--quiet"},
      {"simulate", Scenario("single_arm"), "--duration", "0.5", "--json", json, "--quiet"},
      {"report", recording, "-o", page, "--quiet"},
      {"verify", recording, "--json", Path("v.json"), "--quiet"},
      {"export", "data", recording, "cobot.q", "-o", Path("a.csv"), "--quiet"},
      {"export", "events", recording, "-o", Path("e.csv"), "--quiet"},
      {"repair", recording, "--quiet"},
      {"share", recording, "--quiet"},
      {"init", Path("mine"), "--quiet"}};
  for (std::vector<std::string> command : commands) {
    ASSERT_EQ(Do(command), 0) << command[0] << said_;
    EXPECT_EQ(Do(command), kBadInput) << command[0];
    EXPECT_NE(said_.find("exists. Give another name, or use --force to replace the file."),
              std::string::npos)
        << command[0] << said_;
    command.emplace_back("--force");
    EXPECT_EQ(Do(command), 0) << command[0] << said_;
  }
}

TEST_F(Written, ResultsAreJsonOnRequest) {
  const std::string recording = Path("a.mcap");
  ASSERT_EQ(Do({"simulate", Scenario("single_arm"), "--duration", "0.5", "--record", recording}),
            0);
  ASSERT_EQ(Do({"verify", recording, "--json"}), 0);
  EXPECT_EQ(nlohmann::json::parse(printed_)["matches"], true);
  EXPECT_NE(said_.find("bit for bit"), std::string::npos) << said_;
  ASSERT_EQ(Do({"export", "channels", recording, "--json", "-q"}), 0);
  EXPECT_EQ(nlohmann::json::parse(printed_)[0]["name"], "run.tick");
  ASSERT_EQ(Do({"export", "events", recording, "--json"}), 0);
  EXPECT_EQ(nlohmann::json::parse(printed_)[0]["kind"], "state");
  ASSERT_EQ(Do({"export", "events", recording, "-o", Path("e.csv"), "--json"}), 0);
  EXPECT_FALSE(nlohmann::json::parse(printed_).empty());
  EXPECT_TRUE(fs::exists(Path("e.csv")));
  ASSERT_EQ(Do({"repair", recording, "--json", Path("r.json"), "-q"}), 0);
  EXPECT_EQ(printed_ + said_, "");
  std::ifstream in(Path("r.json"));
  EXPECT_EQ(nlohmann::json::parse(in)["was_complete"], true);
}

TEST_F(Written, OneLineIsJsonOnRequest) {
  ASSERT_EQ(Do({"version"}), 0);
  const std::string version = printed_;
  ASSERT_EQ(Do({"version", "--json"}), 0);
  EXPECT_EQ(nlohmann::json::parse(printed_)["version"].get<std::string>() + "\n", version);
  ASSERT_EQ(Do({"pseudonym", "--json", Path("p.json")}), 0);
  std::ifstream in(Path("p.json"));
  EXPECT_EQ(nlohmann::json::parse(in)["pseudonym"].get<std::string>() + "\n", printed_);
}

TEST_F(Written, TheResultOfInitIsJsonOnRequest) {
  ASSERT_EQ(Do({"init", Path("first"), "--json"}), 0) << said_;
  const auto result = nlohmann::json::parse(printed_);
  EXPECT_EQ(result["file"], Path("first.yaml"));
  EXPECT_EQ(result["end_effector"], "panda_link8");
  EXPECT_EQ(result["posture"].size(), 7U);
  EXPECT_EQ(result["fit"], true);
  EXPECT_NE(said_.find("Wrote "), std::string::npos) << said_;
  EXPECT_EQ(Do({"init", Path("second"), "--json", Path("no/such/folder")}), kBadInput);
  EXPECT_FALSE(fs::exists(Path("second.yaml")));
}

TEST_F(Written, TheResultOfSurveyRemoveKeepsNoPseudonym) {
  for (const char* name : {"a.mcap.K7QM2XPX.real.survey.json", "K7QM2XPX.emulated.survey.json"})
    std::ofstream(Path(name)) << "{}";
  ASSERT_EQ(Do({"survey", "remove", "K7QM2XPX", folder_.path().string(), "--json"}), 0) << said_;
  EXPECT_EQ(nlohmann::json::parse(printed_), (nlohmann::json{{"removed_answers", 2}}));
  EXPECT_NE(said_.find("Removed 2 answers by K7QM2XPX."), std::string::npos) << said_;
}

// A scenario that `init` writes must run without changes, even for arms with grippers and for
// robots with several arms.
TEST_F(Written, FirstScenariosPassTheirCheckAndRun) {
  fs::copy(std::string(PREDICTOR_SOURCE_DIR) + "/docs/tutorials/my_cobot.urdf", Path("mine.urdf"));
  const std::string robots = "package://example-robot-data/robots/";
  const std::vector<std::vector<std::string>> kinds = {
      {"--arms", "2"},
      {"--arms", "1"},
      {"--arms", "2", "--object", "bar"},
      {"--arms", "1", "--object", "ball"},
      {"--arms", "2", "--urdf", Path("mine.urdf")},
      {"--arms", "1", "--urdf", robots + "ur_description/urdf/ur5_robot.urdf"},
      {"--arms", "2", "--urdf", robots + "panda_description/urdf/panda.urdf"},
      {"--arms", "2", "--urdf", robots + "z1_description/urdf/z1.urdf"},
      {"--arms", "1", "--urdf", robots + "baxter_description/urdf/baxter.urdf", "--end-effector",
       "left_gripper"}};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::string name = Path(("first" + std::to_string(k)).c_str());
    std::vector<std::string> init = {"init", name};
    init.insert(init.end(), kinds[k].begin(), kinds[k].end());
    ASSERT_EQ(Do(init), 0) << said_;
    EXPECT_NE(printed_.find("Wrote " + name + ".yaml."), std::string::npos) << printed_;
    EXPECT_EQ(Do({"check", name + ".yaml", "--no-search"}), 0) << printed_ << said_;
    EXPECT_EQ(Do({"simulate", name + ".yaml"}), 0) << printed_ << said_;
  }
}

TEST_F(Written, InitQuotesANameWithSpacesAndRefusesAnUnusableOne) {
  const std::string name = Path("it's: mine");
  ASSERT_EQ(Do({"init", name}), 0) << said_;
  const std::string prefix = "Next: predictor check ";
  const std::size_t start = printed_.find(prefix) + prefix.size();
  const std::string word = printed_.substr(start, printed_.find("; predictor run") - start);
  EXPECT_EQ(std::system(("test -f " + word).c_str()), 0) << word;
  EXPECT_EQ(Do({"check", name + ".yaml", "--no-search"}), 0) << printed_ << said_;
  for (const std::string bad : {"", "two\nlines", "folder/"}) {
    EXPECT_EQ(Do({"init", bad}), kBadInput) << bad;
    EXPECT_NE(said_.find("cannot be the name of a file"), std::string::npos) << said_;
  }
}

TEST_F(Written, InitReportsWhichLinksItLeavesOut) {
  ASSERT_EQ(Do({"init", Path("panda"), "--urdf",
                "package://example-robot-data/robots/panda_description/urdf/panda.urdf"}),
            0);
  EXPECT_NE(printed_.find("The link panda_hand_tcp, which 7 joints move, holds the object"),
            std::string::npos)
      << printed_;
  EXPECT_NE(printed_.find("panda_leftfinger, panda_rightfinger"), std::string::npos) << printed_;
}

TEST_F(Written, InitNamesAWeakRobotsRemedy) {
  EXPECT_EQ(Do({"init", Path("weak"), "--urdf",
                "package://example-robot-data/robots/talos_data/robots/talos_left_arm.urdf"}),
            kBadInput);
  EXPECT_NE(said_.find("--end-effector LINK"), std::string::npos) << said_;
  EXPECT_FALSE(fs::exists(Path("weak.yaml")));
  EXPECT_EQ(Do({"init", Path("no"), "--end-effector", "panda_hand"}), kBadInput);
  EXPECT_NE(said_.find("--urdf FILE"), std::string::npos) << said_;
}

}  // namespace
}  // namespace predictor
