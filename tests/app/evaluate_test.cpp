// Tests `predictor evaluate` with recordings that the program made.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "child.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class Evaluate : public testing::Test {
 protected:
  std::string Record(const std::string& scenario, const std::vector<std::string>& more = {},
                     const std::string& duration = "3") {
    const std::string recording = folder_.path() / (scenario + ".mcap");
    std::vector<std::string> arguments = {
        "simulate", Scenario(scenario.c_str()), "--quiet", "--duration", duration, "--record",
        recording};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Child child(arguments);
    EXPECT_LE(child.Wait(), 1) << child.errors();
    return recording;
  }
  const test::TemporaryFolder folder_;
};

TEST_F(Evaluate, WritesTextPageJsonAndCsv) {
  const std::string recording = Record("box_9kg");
  const std::string csv = folder_.path() / "person.csv";
  Child child({"evaluate", recording, "--csv", csv, "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_TRUE(json["person"]["simulated"].get<bool>());
  EXPECT_GT(json["quantities"]["lower_back.compression_n"]["mean"].get<double>(), 300);
  ASSERT_GE(json["safety"]["margins"].size(), 3u);
  for (const auto& margin : json["safety"]["margins"])
    EXPECT_GT(margin["smallest"].get<double>(), 0) << margin;
  EXPECT_TRUE(fs::exists(csv));
  EXPECT_TRUE(fs::exists(folder_.path() / "box_9kg.person.html"));
  Child again({"evaluate", recording});
  EXPECT_EQ(again.Wait(), 2);
  EXPECT_NE(again.errors().find("--force"), std::string::npos) << again.errors();
}

TEST_F(Evaluate, UsesTheStatedWork) {
  const std::string recording = Record("box_9kg", {}, "8");
  Child child({"evaluate", recording, "--no-intervals", "--duration", "8h", "--coupling", "poor",
               "--grip-effort", "4", "--fatigue-trial", "0.5,60", "--limits",
               fs::path(PREDICTOR_SOURCE_DIR) / "assets/hand_activity_limits.csv", "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  std::size_t hands = 0;
  for (const auto& damage : json["damage"]) hands += damage["tool"] == "DUET" ? 1 : 0;
  EXPECT_EQ(hands, 2u);
  EXPECT_EQ(json["limits"].size(), 4u);
  EXPECT_EQ(json["hand_activity"][0]["normalized_peak_force"], 4);
  double weakest = 1;
  for (const auto& fatigue : json["fatigue"])
    weakest = std::min(weakest, fatigue["trial_capacity_at_end"].get<double>());
  EXPECT_LT(weakest, 0.99);
  EXPECT_GT(weakest, 0.5);
  const std::string assumptions = json["assumptions"].dump();
  EXPECT_NE(assumptions.find("eight hours"), std::string::npos) << assumptions;
  EXPECT_NE(assumptions.find("poor handles"), std::string::npos) << assumptions;
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--grip-effort", "11"},
                                                {"--duration", "3h"},
                                                {"--fatigue-trial", "2,60"},
                                                {"--fatigue-trial", "0.5"}}) {
    Child refused({"evaluate", recording, wrong[0], wrong[1], "--force"});
    EXPECT_EQ(refused.Wait(), 2) << wrong[0];
    EXPECT_NE(refused.errors().find(wrong[0]), std::string::npos) << refused.errors();
    EXPECT_EQ(refused.errors().find(".0"), std::string::npos) << refused.errors();
  }
}

// Returns the text of the page that `report` makes of these recordings.
std::string ReportOf(std::vector<std::string> arguments, const fs::path& page) {
  arguments.insert(arguments.begin(), "report");
  for (const std::string& more :
       {std::string("-o"), page.string(), std::string("--quiet"), std::string("--force")})
    arguments.push_back(more);
  Child child(arguments);
  EXPECT_EQ(child.Wait(), 0) << child.errors();
  std::ifstream file(page);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool Contains(const std::string& text, const char* what) {
  return text.find(what) != std::string::npos;
}

TEST_F(Evaluate, AReportShowsThePersonOrWhatIsMissing) {
  const std::string known = Record("box_9kg");
  const std::string page = folder_.path() / "page.html";
  const std::string html = ReportOf({known}, page);
  for (const char* part : {"<section id=\"person\"", "The operator was simulated", "from the side",
                           "from the front", "modelled", "person-scores", "NIOSH"})
    EXPECT_TRUE(Contains(html, part)) << part;
  const std::string unknown = Record("box_18kg", {"--set", "operator.body=null"});
  const std::string refused = ReportOf({unknown}, page);
  EXPECT_TRUE(Contains(refused,
                       "Posture, loads and scores of the person cannot be evaluated. The "
                       "scenario does not describe the operator's body."));
  EXPECT_FALSE(Contains(refused, "person-scores"));
  const std::string given =
      ReportOf({unknown, "--set", "operator.body={height: 1.62, mass: 58, sex: female}", "--set",
                "operator.stance={ground: [1.0, 0.05, -0.85], facing: 180 deg}"},
               page);
  EXPECT_TRUE(Contains(given, "Body: female, 1.62 m, 58 kg."));
  const std::string both = ReportOf({known, unknown}, page);
  EXPECT_TRUE(Contains(both, "Lower back (L5/S1), compression [N], modelled"));
  EXPECT_TRUE(Contains(both, ": Posture, loads and scores"));
}

TEST_F(Evaluate, ComparesTwoDesigns) {
  const std::string light = Record("box_9kg"), heavy = Record("box_18kg");
  const std::string page = folder_.path() / "compared.html";
  Child child({"evaluate", light, "--against", heavy, "--json", "-", "-o", page});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  std::ifstream file(page);
  const std::string html((std::istreambuf_iterator<char>(file)), {});
  EXPECT_TRUE(Contains(html, "box_9kg compared with box_18kg"));
  EXPECT_TRUE(Contains(html, "box_9kg − box_18kg (90 %)"));
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_EQ(json["against"]["recording"], "box_18kg.mcap");
  EXPECT_TRUE(json["against"]["quantities"].contains("lower_back.compression_n"));
}

TEST_F(Evaluate, OfSeveralRecordingsWritesTheResultsOfEach) {
  // The lift ends after 5 s.
  const std::string light = Record("box_9kg", {}, "7"), heavy = Record("box_18kg", {}, "7");
  const fs::path out = folder_.path() / "out";
  Child child({"evaluate", light, heavy, "--no-intervals", "-o", out, "--csv", out, "--json", out});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  for (const char* name : {"box_9kg", "box_18kg"}) {
    const std::string stem = out / (std::string(name) + ".person");
    EXPECT_TRUE(fs::exists(stem + ".html"));
    EXPECT_TRUE(fs::exists(stem + ".csv"));
    std::ifstream json(stem + ".json");
    EXPECT_EQ(nlohmann::json::parse(json)["recording"], std::string(name) + ".mcap");
  }
  std::ifstream job(out / "lifting_job.json"), table(out / "lifting_job.csv");
  const auto json = nlohmann::json::parse(job);
  ASSERT_EQ(json["recordings"].size(), 2u);
  std::size_t lifts = 0;
  for (const auto& recording : json["recordings"]) lifts += recording["lifts"].size();
  EXPECT_GE(lifts, 2u);
  std::string line;
  std::size_t rows = 0;
  while (std::getline(table, line)) ++rows;
  EXPECT_EQ(rows, 1 + lifts);
  EXPECT_GE(json["lifting_job"]["lifts"].get<int>(), 2);
  EXPECT_GT(json["lifting_job"]["unassisted_composite_lifting_index"].get<double>(),
            json["lifting_job"]["adapted_composite_lifting_index"].get<double>());
  Child one_track({"evaluate", light, heavy, "--track", "head.csv"});
  EXPECT_EQ(one_track.Wait(), 2);
  EXPECT_NE(one_track.errors().find("one by one"), std::string::npos) << one_track.errors();
  Child same_name({"evaluate", light, light, "--no-intervals", "--force"});
  EXPECT_EQ(same_name.Wait(), 2);
  EXPECT_NE(same_name.errors().find("Rename"), std::string::npos) << same_name.errors();
}

TEST_F(Evaluate, OfAnUnknownPlaceIsRefusedWithTheRemedy) {
  const std::string recording = Record("box_9kg", {"--set", "operator.stance=null"});
  Child child({"evaluate", recording});
  EXPECT_EQ(child.Wait(), 2);
  EXPECT_NE(child.errors().find("operator.stance"), std::string::npos) << child.errors();
  Child given({"evaluate", recording, "--quiet", "--no-intervals", "--set",
               "operator.stance={ground: [1, 0, -0.85], facing: 180 deg}"});
  EXPECT_EQ(given.Wait(), 0) << given.errors();
}

TEST_F(Evaluate, OfAnAbsurdBodyOrAForeignFileIsRefused) {
  const std::string recording = Record("box_9kg");
  Child giant({"evaluate", recording, "--set", "operator.body.height=5"});
  EXPECT_EQ(giant.Wait(), 2);
  EXPECT_NE(giant.errors().find("height"), std::string::npos) << giant.errors();
  const std::string foreign = folder_.path() / "foreign.mcap";
  std::ofstream(foreign) << "no recording";
  Child child({"evaluate", foreign});
  EXPECT_EQ(child.Wait(), 2);
}

TEST_F(Evaluate, JudgesAnImportedLogAndExportsIt) {
  const std::string log = folder_.path() / "log.csv", map = folder_.path() / "map.yaml";
  std::ofstream table(log);
  table << "time,x,y,z,w,i,j,k,fx,fy,fz\n";
  for (int n = 0; n < 300; ++n)
    table << 0.01 * n << ",500,0," << 100 + 0.1 * n << ",1,0,0,0,0,0,30\n";
  table.close();
  std::ofstream(map) << "unit: mm\nforce_unit: N\n"
                        "operator: {body: {height: 1.75, mass: 75, sex: male}, stance: {ground: "
                        "[0.95, 0, -0.85], facing: 180 deg}}\n"
                        "right_hand: {position: [x, y, z], rotation: [w, i, j, k], force: [fx, fy, "
                        "fz]}\n";
  const std::string person = folder_.path() / "log.person.csv";
  Child import({"import", log, "--map", map});
  ASSERT_EQ(import.Wait(), 0) << import.errors();
  EXPECT_NE(import.output().find("torque was not measured"), std::string::npos) << import.output();
  Child child({"evaluate", person, "--no-intervals", "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_EQ(json["person"]["operator"], "imported");
  EXPECT_NEAR(json["quantities"]["hands.right.force_n"]["mean"].get<double>(), 30, 1e-6);
  EXPECT_FALSE(json["quantities"].contains("hands.left.force_n"));
  Child exported({"export", "person", person, "-o", folder_.path() / "opensim"});
  ASSERT_EQ(exported.Wait(), 0) << exported.errors();
  EXPECT_TRUE(fs::exists(folder_.path() / "opensim" / "person.osim"));
}

// Measurements of other people's laboratory (examples/handover/README.md). The mean force and the
// duration were computed from the table.
TEST_F(Evaluate, JudgesAHandoverThatOthersMeasured) {
  const fs::path data = fs::path(PREDICTOR_SOURCE_DIR) / "examples/handover";
  std::ifstream table(data / "handover.csv");
  std::string line;
  std::getline(table, line);
  double sum = 0, rows = 0;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    ASSERT_EQ(row.size(), 23u);
    sum += std::hypot(row[7], row[8], row[9]);
    ++rows;
  }
  const std::string person = folder_.path() / "handover.person.csv";
  Child import({"import", data / "handover.csv", "--map", data / "handover.yaml", "-o", person});
  ASSERT_EQ(import.Wait(), 0) << import.errors();
  Child child({"evaluate", person, "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_FALSE(json["person"]["simulated"].get<bool>());
  EXPECT_EQ(json["person"]["reached"], 1);
  EXPECT_NEAR(json["held_s"].get<double>(), rows / 120, 0.02);
  EXPECT_NEAR(json["quantities"]["hands.right.force_n"]["mean"].get<double>(), sum / rows, 0.05);
  ASSERT_EQ(json["measured"]["parts"].size(), 3u);
  for (const auto& part : json["measured"]["parts"]) EXPECT_EQ(part["share_of_time"], 1);
}

// The table contains a head that rests above the place where the operator stands.
TEST_F(Evaluate, TakesAMeasuredHeadFromATable) {
  const std::string recording = Record("box_9kg"), table = folder_.path() / "head.csv";
  const auto write = [&](double height, const std::string& unit) {
    std::ofstream out(table);
    out << "time [s],head.p.x [" << unit << "],head.p.y [" << unit << "],head.p.z [" << unit
        << "],pulse [1/min]\n";
    for (int i = 0; i < 500; ++i) out << 0.01 * i << ",0.8,0.05," << height << ",72\n";
  };
  write(0.65, "m");
  const std::string csv = folder_.path() / "person.csv";
  Child child({"evaluate", recording, "--track", table, "--csv", csv, "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_GT(json["measured"]["parts"][0]["share_of_time"].get<double>(), 0.99);
  std::ifstream in(csv);
  std::string header;
  std::getline(in, header);
  EXPECT_TRUE(header.ends_with("measured.pulse [1/min]")) << header;
  write(650, "m");
  Child wrong({"evaluate", recording, "--track", table, "--force"});
  EXPECT_EQ(wrong.Wait(), 2);
  EXPECT_NE(wrong.errors().find("Check the unit"), std::string::npos) << wrong.errors();
}

}  // namespace
}  // namespace predictor
