// Records a run and processes the recording with the program's other commands.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>

#include "child.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class RecordedProgram : public testing::Test {
 protected:
  // Runs the program, keeps its output, and returns its exit code.
  int Do(const std::vector<std::string>& arguments) {
    Child child(arguments);
    const int code = child.Wait();
    printed_ = child.output();
    said_ = printed_ + child.errors();
    return code;
  }
  // Returns the number before " ticks" in the last output.
  long TicksSaid() const {
    std::smatch match;
    return std::regex_search(said_, match, std::regex("(\\d+) ticks")) ? std::stol(match[1]) : -1;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  const std::string file_ = folder_ / "run.mcap";
  std::string said_, printed_;
};

TEST_F(RecordedProgram, InRealTimeIsComputedAgainBitForBit) {
  ASSERT_EQ(Do({"run", Scenario("box_9kg"), "--no-viewer", "--duration", "2", "--record", file_,
                "--label", "person=7"}),
            0)
      << said_;
  EXPECT_NE(said_.find("Recorded " + file_), std::string::npos) << said_;
  ASSERT_EQ(Do({"verify", file_}), 0) << said_;
  EXPECT_GT(TicksSaid(), 2000) << said_;
}

// The run's table, its JSON output, its recording and the report must all contain the prediction of
// `check`.
TEST_F(RecordedProgram, StatesWhetherItsHapticLoopWasPredictedUnstable) {
  const std::string summary = folder_ / "summary.json", page = folder_ / "page.html";
  for (const bool unstable : {false, true}) {
    const std::string mass = unstable ? "operator.hand.mass=5" : "operator.hand.mass=1";
    const std::string file = folder_ / (mass + ".mcap");
    ASSERT_EQ(Do({"simulate", Scenario("bar_circle"), "--set", mass, "--duration", "0.1",
                  "--record", file, "--json", summary, "--force"}),
              0)
        << said_;
    EXPECT_EQ(printed_.find("PREDICTED UNSTABLE") != std::string::npos, unstable) << printed_;
    std::ifstream stream(summary);
    const auto json = nlohmann::json::parse(stream);
    EXPECT_EQ(json["predicted_unstable"], unstable);
    EXPECT_EQ(json["stability_margin"].get<double>() < 1, unstable);
    ASSERT_EQ(Do({"report", file, "-o", page, "--quiet"}), 0) << said_;
    std::ifstream report(page);
    const std::string html{std::istreambuf_iterator<char>(report), {}};
    EXPECT_EQ(html.find("PREDICTED UNSTABLE") != std::string::npos, unstable);
    EXPECT_EQ(html.find("predicted stable") != std::string::npos, !unstable);
    fs::remove(page);
  }
}

TEST_F(RecordedProgram, ReportsContactIfAFixtureCanTouchTheObject) {
  for (const char* name : {"slide_on_table", "single_arm"}) {
    const std::string file = folder_ / (std::string(name) + ".mcap"), page = file + ".html";
    ASSERT_EQ(Do({"simulate", Scenario(name), "--quiet", "--duration", "3", "--record", file}), 0);
    ASSERT_EQ(Do({"report", file, "-o", page, "--quiet"}), 0) << said_;
    std::ifstream report(page);
    const std::string html{std::istreambuf_iterator<char>(report), {}};
    const bool has_fixture = std::string(name) == "slide_on_table";
    EXPECT_EQ(html.find("Contact: what the device cannot render") != std::string::npos,
              has_fixture);
    EXPECT_EQ(html.find("impedance-2") != std::string::npos, has_fixture);  // two sides
  }
}

TEST_F(RecordedProgram, IsNotOverwritten) {
  ASSERT_EQ(Do({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "1", "--record", file_}),
            0);
  const auto size = fs::file_size(file_);
  EXPECT_EQ(Do({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "1", "--record", file_}),
            2);
  EXPECT_NE(said_.find(file_), std::string::npos) << said_;
  EXPECT_EQ(fs::file_size(file_), size);
}

TEST_F(RecordedProgram, CutIsRecovered) {
  ASSERT_EQ(Do({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "4", "--record", file_}),
            0);
  fs::resize_file(file_, fs::file_size(file_) * 2 / 3);
  ASSERT_EQ(Do({"repair", file_}), 0) << said_;
  const long kept = TicksSaid();
  EXPECT_GT(kept, 1000) << said_;
  const std::string mended = folder_ / "run.repaired.mcap";
  ASSERT_EQ(Do({"verify", mended}), 0) << said_;
  EXPECT_EQ(TicksSaid(), kept) << said_;
}

// Damage to a recording before its first tick must not make any tick unreadable. If a later chunk
// is damaged, the table must end before this chunk, and a message must report the damage.
TEST_F(RecordedProgram, DamagedIsReadAsFarAsItIsWhole) {
  ASSERT_EQ(Do({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "2", "--record", file_}),
            0);
  ASSERT_EQ(Do({"verify", file_}), 0) << said_;
  const long all = TicksSaid();
  const auto size = static_cast<long>(fs::file_size(file_));
  const auto flip = [this](long at) {
    std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(at);
    const int byte = file.get();
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 0x10));
  };
  for (const long at : {2L, 30L, 200L, 5000L, 40'000L}) {
    flip(at);
    ASSERT_EQ(Do({"verify", file_}), 0) << at << ": " << said_;
    EXPECT_EQ(TicksSaid(), all);
    EXPECT_NE(said_.find("damaged before its first tick"), std::string::npos) << said_;
    flip(at);
  }
  flip(size * 2 / 3);
  EXPECT_EQ(Do({"export", "data", file_, "cobot.q", "--quiet"}), 2);
  const std::string last = printed_.substr(printed_.rfind('\n', printed_.size() - 2) + 1);
  const long rows = std::count(printed_.begin(), printed_.end(), '\n') - 1;
  EXPECT_EQ(std::stol(last), rows);
  EXPECT_GT(rows, all / 3);
  EXPECT_LT(rows, all);
  EXPECT_NE(said_.find("The table ends at tick " + std::to_string(rows) + "."), std::string::npos)
      << said_;
}

// The first three joints of this cobot belong to its mobile base.
TEST_F(RecordedProgram, ChannelsHaveTheUnitsOfTheirJoints) {
  ASSERT_EQ(
      Do({"simulate", Scenario("mobile_base"), "--quiet", "--duration", "0.1", "--record", file_}),
      0)
      << said_;
  ASSERT_EQ(Do({"export", "data", file_, "cobot.*[1]", "cobot.*[2]", "--quiet"}), 0) << said_;
  EXPECT_TRUE(printed_.starts_with(
      "run.tick,run.run_time [s],cobot.q[1] [m],cobot.v[1] [m/s],cobot.torque[1] [N],"
      "cobot.q[2] [rad],cobot.v[2] [rad/s],cobot.torque[2] [N m]\n"))
      << printed_.substr(0, 300);
  ASSERT_EQ(Do({"export", "channels", file_}), 0) << said_;
  EXPECT_NE(printed_.find("\ncobot.q[1]  [m]"), std::string::npos);
}

TEST_F(RecordedProgram, ChannelsAreNumbersAsTheyWere) {
  ASSERT_EQ(
      Do({"simulate", Scenario("single_arm"), "--quiet", "--duration", "1", "--record", file_}), 0);
  const std::string csv = folder_ / "run.csv";
  ASSERT_EQ(Do({"export", "data", file_, "cobot.q", "--quiet", "-o", csv, "--json"}), 0) << said_;
  const auto json = nlohmann::json::parse(printed_);
  ASSERT_EQ(json["columns"].size(), 9u);
  EXPECT_EQ(json["columns"][2]["name"], "cobot.q[0]");
  EXPECT_EQ(json["columns"][2]["type"], "float64");
  EXPECT_EQ(json["columns"][2]["unit"], "rad");
  std::ifstream in(csv);
  std::string line;
  std::getline(in, line);
  EXPECT_TRUE(line.starts_with("run.tick,run.run_time [s],cobot.q[0] [rad],")) << line;
  int rows = 0;
  while (std::getline(in, line)) ++rows;
  EXPECT_GT(rows, 1000);
  EXPECT_EQ(json["rows"], rows);
  EXPECT_EQ(Do({"export", "data", file_, "--json"}), 2);
  EXPECT_NE(said_.find("cannot both go to standard output"), std::string::npos) << said_;
  EXPECT_EQ(Do({"export", "data", file_, "cobot.x"}), 2);
  ASSERT_EQ(Do({"export", "data", file_, "inputs.inputs[0]", "--quiet", "--every", "500"}), 0)
      << said_;
  EXPECT_TRUE(printed_.starts_with("run.tick,run.run_time [s],inputs.inputs[0].")) << printed_;
  ASSERT_EQ(Do({"export", "channels", file_}), 0);
  EXPECT_NE(printed_.find("\ninputs.inputs[0]."), std::string::npos);
  for (const char* stage : {"read", "simulate", "tick"})
    EXPECT_NE(printed_.find(std::string("\ntiming.") + stage + "  [us]  # computing time"),
              std::string::npos);
}

TEST_F(RecordedProgram, EventsAreATable) {
  ASSERT_EQ(Do({"simulate", Scenario("push"), "--quiet", "--record", file_}), 1) << said_;
  ASSERT_EQ(Do({"export", "events", file_, "--quiet"}), 0) << said_;
  EXPECT_TRUE(printed_.starts_with("tick,time [s],kind,text\n")) << printed_;
  const std::regex row("[0-9]+,[-0-9.e]+,[a-z]+,(\"([^\"]|\"\")*\"|[^\",]*)");
  std::istringstream lines(printed_);
  std::string line;
  std::getline(lines, line);
  int rows = 0;
  for (; std::getline(lines, line); ++rows) EXPECT_TRUE(std::regex_match(line, row)) << line;
  EXPECT_GT(rows, 2);
  EXPECT_NE(printed_.find("stop: force, right hand: "), std::string::npos) << printed_;
  // A report derives the events from the ticks. The report must show each event once in the stop's
  // description and once in the table.
  const std::string page = folder_ / "run.html";
  ASSERT_EQ(Do({"report", file_, "-o", page, "--quiet"}), 0) << said_;
  std::ifstream in(page);
  const std::string html{std::istreambuf_iterator<char>(in), {}};
  const auto count = [&html](const std::string& what) {
    int n = 0;
    for (std::size_t at = html.find(what); at != std::string::npos; at = html.find(what, at + 1))
      ++n;
    return n;
  };
  EXPECT_EQ(count("state RUN</li>"), 1);
  EXPECT_EQ(count("<td>state RUN</td>"), 1);
  EXPECT_EQ(Do({"export", "data", Scenario("push")}), 2);
}

// The paper criticises the emulated cobot for yielding too easily. The cause is that its joints
// have less friction than those of the real cobot.
TEST_F(RecordedProgram, OfACobotWithLessFrictionDiffersFromTheRealOne) {
  const std::string other = folder_ / "emulated.mcap";
  ASSERT_EQ(
      Do({"simulate", Scenario("bar_circle"), "--quiet", "--record", file_, "--set", "mode=direct",
          "--set", "cobot.joint_friction.viscous=2.5", "--label", "condition=real"}),
      0)
      << said_;
  ASSERT_EQ(Do({"simulate", Scenario("bar_circle"), "--quiet", "--seed", "2", "--record", other,
                "--label", "condition=emulated"}),
            0)
      << said_;
  ASSERT_EQ(Do({"compare", file_, "--with", other, "--quiet", "--json", "-"}), 0) << said_;
  const auto differ = nlohmann::json::parse(printed_);
  EXPECT_EQ(differ["a"], "real");
  EXPECT_EQ(differ["b"], "emulated");
  EXPECT_TRUE(differ["by_phase"]);
  EXPECT_EQ(differ["cycles"], 4);
  EXPECT_TRUE(differ["warnings"].empty()) << differ["warnings"];
  for (const auto& quantity : differ["perceived"])
    if (quantity["name"].get<std::string>().starts_with("viscosity")) {
      EXPECT_EQ(quantity["noticed"], "noticeable") << quantity;
      EXPECT_LT(quantity["difference"], -0.3) << quantity;
    }
  ASSERT_EQ(Do({"compare", file_, "--with", file_, "--quiet", "--json", "-"}), 0) << said_;
  const auto same = nlohmann::json::parse(printed_);
  for (const auto& channel : same["channels"]) EXPECT_EQ(channel["rmse"], 0) << channel;
  ASSERT_EQ(Do({"compare", file_, "--with", other}), 0);
  EXPECT_NE(printed_.find("real (a) against emulated (b): 4 cycles by phase"), std::string::npos)
      << printed_;
}

TEST_F(RecordedProgram, OfAnotherTaskIsComparedWithAWarning) {
  const std::string other = folder_ / "other.mcap";
  ASSERT_EQ(Do({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "2", "--record", file_}),
            0);
  ASSERT_EQ(
      Do({"simulate", Scenario("bar_circle"), "--quiet", "--duration", "2", "--record", other}), 0);
  ASSERT_EQ(Do({"compare", file_, "--with", other}), 0) << said_;
  EXPECT_NE(printed_.find("Warning: other has a different task from run: the object"),
            std::string::npos)
      << printed_;
}

TEST_F(RecordedProgram, StatesItsCobotsFriction) {
  fs::create_directory(folder_ / "scenarios");
  fs::copy(fs::path(PREDICTOR_SOURCE_DIR) / "assets", folder_ / "assets",
           fs::copy_options::recursive);
  ASSERT_EQ(Do({"simulate", Scenario("excite_cobot"), "--quiet", "--record", file_, "--set",
                "cobot.joint_friction={viscous: 2.5, coulomb: 0.4}"}),
            0)
      << said_;
  const std::string found = folder_ / "scenarios" / "found.yaml";
  ASSERT_EQ(Do({"identify", file_, "--quiet", "--json", "-", "-o", found}), 0) << said_;
  const auto result = nlohmann::json::parse(printed_);
  ASSERT_EQ(result["joints"].size(), 7);
  for (const auto& joint : result["joints"]) {
    EXPECT_NEAR(joint["viscous_nms_rad"]["value"], 2.5, 0.05 * 2.5) << joint;
    EXPECT_NEAR(joint["coulomb_nm"]["value"], 0.4, 0.05 * 0.4) << joint;
  }
  EXPECT_EQ(Do({"simulate", found, "--quiet", "--duration", "1"}), 0) << said_;
  // The program must keep an existing file unless --force is given.
  const auto written = [&] {
    std::ifstream in(found);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  std::ofstream(found) << "mine";
  EXPECT_EQ(Do({"identify", file_, "--quiet", "-o", found}), 2);
  EXPECT_NE(said_.find("--force"), std::string::npos) << said_;
  EXPECT_EQ(written(), "mine");
  EXPECT_EQ(Do({"identify", file_, "--quiet", "-o", found, "--force"}), 0) << said_;
  EXPECT_NE(written().find("joint_friction"), std::string::npos);
  // Two seconds with almost no motion do not contain enough data.
  const std::string still = folder_ / "still.mcap";
  ASSERT_EQ(
      Do({"simulate", Scenario("excite_cobot"), "--quiet", "--duration", "2", "--record", still}),
      0);
  EXPECT_EQ(Do({"identify", still}), 2) << said_;
  EXPECT_NE(said_.find("identification needs at least 10 s"), std::string::npos) << said_;
}

// On a nearly full disk, the program reports how much it kept, and its exit code indicates the
// failure.
TEST_F(RecordedProgram, OnANearlyFullDiskReportsHowMuchIsKept) {
  if (mount("none", folder_.c_str(), "tmpfs", 0, "size=4m") != 0)
    GTEST_SKIP() << "Nothing may be mounted here.";
  EXPECT_EQ(Do({"simulate", Scenario("box_9kg"), "--quiet", "--record", file_}), 3);
  const long kept = TicksSaid();
  EXPECT_GT(kept, 100) << said_;
  EXPECT_NE(said_.find("only 0.0 GB are free"), std::string::npos) << said_;
  EXPECT_EQ(Do({"verify", file_}), 0) << said_;
  EXPECT_EQ(TicksSaid(), kept) << said_;
  EXPECT_EQ(umount(folder_.c_str()), 0);
}

}  // namespace
}  // namespace predictor
