// Tests `predictor continue` with recordings that the program made.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

class ContinueCommandTest : public testing::Test {
 protected:
  std::string Record(const std::string& scenario, const std::string& seconds,
                     const std::vector<std::string>& more = {}) {
    const std::string recording = folder_.path() / "run.mcap";
    std::vector<std::string> arguments = {"simulate",   Scenario(scenario.c_str()),
                                          "--quiet",    "--force",
                                          "--duration", seconds,
                                          "--record",   recording};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Child child(arguments);
    EXPECT_LE(child.Wait(), 1) << child.errors();
    return recording;
  }
  const test::TemporaryFolder folder_;
};

TEST_F(ContinueCommandTest, WritesTextPageAndJson) {
  const std::string recording = Record("push", "9");
  Child child({"continue", recording, "--draws", "20", "--horizon", "0.5", "--json", "-"});
  ASSERT_EQ(child.Wait(), 0) << child.errors();
  const auto json = nlohmann::json::parse(child.output());
  EXPECT_EQ(json["stop"]["cause"], "force");
  EXPECT_EQ(json["draws"].size(), 20U);
  EXPECT_GE(json["predicted"]["peak_force_n"]["p5"]["value"].get<double>(), 30);
  EXPECT_FALSE(json["simulated_operator"].is_null());
  EXPECT_TRUE(fs::exists(folder_.path() / "run.continued.html"));
  EXPECT_NE(child.errors().find("at least 30"), std::string::npos) << child.errors();
  Child again({"continue", recording});
  EXPECT_EQ(again.Wait(), 2);
  EXPECT_NE(again.errors().find("--force"), std::string::npos) << again.errors();
}

TEST_F(ContinueCommandTest, OtherCommandsStateThatTheValuesOfAStoppedRunAreBounds) {
  const std::string recording = Record("push", "9");
  Child evaluate({"evaluate", recording, "--no-intervals"});
  ASSERT_EQ(evaluate.Wait(), 0) << evaluate.errors();
  EXPECT_NE(evaluate.output().find("lower bounds"), std::string::npos) << evaluate.output();
  Child compare({"compare", recording, "--with", recording});
  ASSERT_EQ(compare.Wait(), 0) << compare.errors();
  EXPECT_NE(compare.output().find("lower bounds"), std::string::npos) << compare.output();
}

TEST_F(ContinueCommandTest, OfARunWithoutAStopIsRefused) {
  const std::string recording = Record("box_9kg", "1");
  Child child({"continue", recording});
  EXPECT_EQ(child.Wait(), 2);
  EXPECT_NE(child.errors().find("no stop"), std::string::npos) << child.errors();
}

TEST_F(ContinueCommandTest, OfAnotherStopOrModeIsRefused) {
  const std::string direct = Record("push", "9", {"--set", "mode=direct"});
  Child child({"continue", direct});
  EXPECT_EQ(child.Wait(), 2);
  EXPECT_NE(child.errors().find("direct"), std::string::npos) << child.errors();
  const std::string vibrates =
      Record("box_9kg", "6", {"--set", "events=[{event: control_delay, trigger: {after: 2}}]"});
  Child other({"continue", vibrates});
  EXPECT_EQ(other.Wait(), 2);
  EXPECT_NE(other.errors().find("oscillat"), std::string::npos) << other.errors();
}

}  // namespace
}  // namespace predictor
