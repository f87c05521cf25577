// Follows the data about a person in a study from the recording to the deletion.
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

class Forget : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.path() / name; }
  // Runs the program and returns its standard output.
  std::string Do(const std::vector<std::string>& arguments, int code = 0) {
    Child child(arguments);
    EXPECT_EQ(child.Wait(), code) << child.errors();
    errors_ = child.errors();
    return child.output();
  }
  std::string Text(const std::string& name) const {
    std::ifstream file(Path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  const test::TemporaryFolder folder_;
  std::string errors_;
};

TEST_F(Forget, APersonIsInAllResultsAndThenInNone) {
  std::string person = Do({"pseudonym"});
  ASSERT_EQ(person.size(), 9u) << person;
  person.pop_back();
  const std::string run = Path("run.mcap");
  std::ofstream(Path("p07.yaml")) << "pseudonym: " + person +
                                         "\nconsent: {version: study-2, date: 2026-11-20}\n"
                                         "handedness: left\n"
                                         "body: {height: 1.58, mass: 52, sex: female}\n";
  Do({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "1", "--record", run,
      "--participant", Path("p07.yaml")});
  Do({"evaluate", run, "--no-intervals", "--csv", Path("table.csv"), "--json", Path("any.json"),
      "--quiet"});
  Do({"report", run, "-o", Path("page.html"), "--quiet"});
  Do({"share", run, "-o", Path("shared.mcap"), "--quiet"});
  const auto json = nlohmann::json::parse(Text("any.json"));
  EXPECT_EQ(json["person"]["participant"]["pseudonym"], person);
  EXPECT_EQ(json["person"]["participant"]["handedness"], "left");
  EXPECT_EQ(json["person"]["height_m"], 1.58);
  EXPECT_NE(Text("run.person.html").find("participant " + person + ", consent study-2 of 2026"),
            std::string::npos);
  EXPECT_NE(Text("page.html").find("pseudonym=" + person), std::string::npos);
  EXPECT_NE(Text("table.csv").find(",pseudonym\n"), std::string::npos);
  EXPECT_EQ(Text("shared.mcap").find(person), std::string::npos);
  std::ofstream(Path("other.txt")) << "of another person";

  // Without a terminal, the command only lists the files.
  Do({"forget", person, folder_.path()}, 2);
  EXPECT_NE(errors_.find("run.mcap"), std::string::npos) << errors_;
  EXPECT_NE(errors_.find("--yes"), std::string::npos) << errors_;
  EXPECT_TRUE(fs::exists(run));

  const auto result =
      nlohmann::json::parse(Do({"forget", person, folder_.path(), "--yes", "--json", "-"}));
  EXPECT_EQ(result["deleted"], 7);
  EXPECT_EQ(result["left"], 0);
  EXPECT_EQ(result.dump().find(person), std::string::npos);
  std::vector<std::string> left;
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
    left.push_back(entry.path().filename());
  EXPECT_EQ(left, std::vector<std::string>{"other.txt"});

  EXPECT_NE(Do({"forget", person, folder_.path()}).find("Files deleted: 0"), std::string::npos);
  Do({"simulate", Scenario("box_9kg"), "--record", run, "--label", "pseudonym=Anna"}, 2);
  EXPECT_NE(errors_.find("--participant"), std::string::npos) << errors_;
  Do({"forget", "AnnaSmith", folder_.path(), "--yes"}, 2);
  EXPECT_NE(errors_.find("not a pseudonym"), std::string::npos) << errors_;
  Do({"forget", person, Path("missing"), "--yes"}, 2);
}

}  // namespace
}  // namespace predictor
