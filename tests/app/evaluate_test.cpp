// `predictor evaluate` on recordings that the program made.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class Evaluate : public testing::Test {
 protected:
  std::string Record(const std::string& scenario, const std::vector<std::string>& more = {}) {
    const std::string recording = folder_.path() / (scenario + ".mcap");
    std::vector<std::string> arguments = {
        "simulate", Scenario(scenario.c_str()), "--quiet", "--duration", "3", "--record",
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
  EXPECT_TRUE(fs::exists(csv));
  EXPECT_TRUE(fs::exists(folder_.path() / "box_9kg.person.html"));
  Child again({"evaluate", recording});
  EXPECT_EQ(again.Wait(), 2);
  EXPECT_NE(again.errors().find("--force"), std::string::npos) << again.errors();
}

// The text of a page that `report` makes of these recordings.
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
                       "Not evaluable: posture, loads and scores of the person. The "
                       "scenario does not describe the operator's body."));
  EXPECT_FALSE(Contains(refused, "person-scores"));
  const std::string given =
      ReportOf({unknown, "--set", "operator.body={height: 1.62, mass: 58, sex: female}", "--set",
                "operator.stance={ground: [1.0, 0.05, -0.85], facing: 180 deg}"},
               page);
  EXPECT_TRUE(Contains(given, "Body: female, 1.62 m, 58 kg."));
  const std::string both = ReportOf({known, unknown}, page);
  EXPECT_TRUE(Contains(both, "Lower back (L5/S1), compression [N], modelled"));
  EXPECT_TRUE(Contains(both, ": Not evaluable: posture, loads"));
}

TEST_F(Evaluate, ComparesTwoDesigns) {
  const std::string light = Record("box_9kg"), heavy = Record("box_18kg");
  Child child({"evaluate", light, "--against", heavy, "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_EQ(json["against"]["recording"], "box_18kg.mcap");
  EXPECT_TRUE(json["against"]["quantities"].contains("lower_back.compression_n"));
}

TEST_F(Evaluate, OfAnUnknownPlaceIsRefusedWithWhatToDo) {
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

}  // namespace
}  // namespace predictor
