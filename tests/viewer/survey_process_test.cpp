// `predictor survey` must store an answer from inside its sandbox.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/child_process.h"
#include "support/process.h"
#include "support/temporary_folder.h"
#include "viewer/client.h"

namespace predictor::viewer {
namespace {

TEST(SurveyProcess, StoresAnAnswerWithoutFurtherRights) {
  const test::TemporaryFolder folder, other;
  const std::string json = other / "result.json";
  Child survey({"survey", "ask", folder.path().string(), "--port", "0", "--condition", "real",
                "--json", json});
  ASSERT_TRUE(survey.Says("(works in one browser only)")) << survey.errors();
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (!test::StatusOf(getpid(), "Seccomp").empty()) {
    EXPECT_EQ(test::StatusOf(survey.pid(), "Seccomp"), "2");
  }
#endif
  const std::string text = survey.errors();
  const std::string host = "localhost:", mark = "/#code=";
  const std::size_t port = text.find(host) + host.size(), code = text.find(mark) + mark.size();
  testing_client::WebSocket page(static_cast<std::uint16_t>(std::stoi(text.substr(port))), "/ws",
                                 "predictor.survey.v1");
  page.SendText(
      nlohmann::json{{"type", "hello"}, {"code", text.substr(code, text.find(' ', code) - code)}}
          .dump());
  const auto welcome = page.NextText("welcome");
  ASSERT_TRUE(welcome);
  nlohmann::json answers;
  const nlohmann::json reported = nlohmann::json::parse(*welcome);
  for (const nlohmann::json& statement : reported["statements"])
    answers[statement["name"].get<std::string>()] = 2;
  page.SendText(nlohmann::json{
      {"type", "answer"},
      {"consent", true},
      {"condition", "real"},
      {"comment", "from a test"},
      {"answers",
       answers}}.dump());
  const auto answer = page.Next();
  ASSERT_TRUE(answer);
  ASSERT_EQ(nlohmann::json::parse(answer->payload)["type"], "stored") << answer->payload;
  EXPECT_EQ(survey.Wait(), 0) << survey.errors();
  ASSERT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  std::ifstream file(std::filesystem::directory_iterator(folder.path())->path());
  const std::string stored{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(stored.find("from a test"), std::string::npos) << stored;
  std::ifstream result(json);
  EXPECT_EQ(nlohmann::json::parse(result)["stored"], true);
}

}  // namespace
}  // namespace predictor::viewer
