// A user chooses another scenario on a page. `predictor run` must continue with this scenario and
// keep the command-line options that still apply.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>

#include "core/status.h"
#include "support/temporary_folder.h"
#include "viewer/client.h"
#include "viewer/frame.h"

namespace predictor::viewer {
namespace {

using testing_client::WebSocket;

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

class ChooseTest : public testing::Test {
 protected:
  ChooseTest() {
    const std::string scenario = std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml";
    const std::string summary = folder_ / "out.json", errors = folder_ / "errors";
    pid_ = fork();
    if (pid_ == 0) {
      dup2(open("/dev/null", O_RDONLY), 0);
      dup2(open(errors.c_str(), O_CREAT | O_WRONLY, 0600), 2);
      if (chdir(folder_.c_str()) != 0) _exit(126);
      execl(PREDICTOR_BINARY, "predictor", "run", scenario.c_str(), "--port", "0", "--stay",
            "--quiet", "--no-record", "--seed", "7", "--duration", "1", "--set", "name=Other",
            "--json", summary.c_str(), nullptr);
      _exit(127);
    }
  }
  ~ChooseTest() override {
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
  }

  std::string Errors() const { return ReadText(folder_ / "errors"); }
  // Returns the rest of the line after `what`, or an empty text if it does not appear within a
  // minute.
  std::string After(const std::string& what) const {
    for (int i = 0; i < 6000; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
      const std::string text = Errors();
      const std::size_t at = text.find(what);
      const std::size_t end = text.find('\n', at == std::string::npos ? at : at + what.size());
      if (at != std::string::npos && end != std::string::npos)
        return text.substr(at + what.size(), end - at - what.size());
    }
    return "";
  }
  int Wait() {
    int status = 0;
    waitpid(std::exchange(pid_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  // Waits until the server shows the expected scene to a page that reconnects. Returns the scene,
  // or null and no page after a minute.
  static nlohmann::json Back(std::uint16_t port, const std::string& token,
                             std::unique_ptr<WebSocket>* page,
                             const std::function<bool(const nlohmann::json& scene)>& wanted) {
    for (int i = 0; i < 600; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(100))) {
      *page = std::make_unique<WebSocket>(port);
      if ((*page)->status() != 101) continue;
      (*page)->SendText(R"({"type":"hello","token":")" + token + "\"}");
      const auto welcome = (*page)->NextText("welcome");
      if (!welcome) continue;
      const nlohmann::json scene = nlohmann::json::parse(*welcome)["scene"];
      if (wanted(scene)) return scene;
    }
    page->reset();
    return nullptr;
  }
  static bool Reaches(WebSocket* page, RunState wanted) {
    std::size_t at = 0;
    for (const FrameField& field : FrameFields())
      if (field.name == "state") at = field.offset;
    while (const auto message = page->Next()) {
      page->SendText(R"({"type":"heartbeat"})");
      if (message->opcode == 2 && message->payload[at] == static_cast<char>(wanted)) return true;
    }
    return false;
  }
  // Waits for the end of the run. The server disconnects a page that sends no heartbeats.
  static std::optional<nlohmann::json> End(WebSocket* page) {
    while (const auto message = page->Next()) {
      page->SendText(R"({"type":"heartbeat"})");
      if (message->opcode != 1) continue;
      const nlohmann::json text = nlohmann::json::parse(message->payload);
      if (text["type"] == "ended") return text;
    }
    return {};
  }
  // Takes control and chooses a scenario, until the server closes the connection because of the new
  // scenario. The server may still reserve control for a page that has just left, so the page
  // requests control every second.
  static bool Choose(WebSocket* page, const std::string& name) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = Clock::now() + std::chrono::minutes(1);
    Clock::time_point next{};
    do {
      if (Clock::now() >= next) {
        next = Clock::now() + std::chrono::seconds(1);
        page->SendText(R"({"type":"lease","what":"control","take":true})");
        page->SendText(R"({"type":"scenario","name":")" + name + "\"}");
      }
    } while (page->Next() && Clock::now() < end);
    return Clock::now() < end;
  }
  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
  pid_t pid_ = -1;
};

TEST_F(ChooseTest, KeepsSeedAndDurationAndReportsDroppedOptions) {
  const std::string url = After("Viewer: http://localhost:");
  const auto port = static_cast<std::uint16_t>(std::atoi(url.c_str()));
  std::string token;
  {
    WebSocket page(port);
    const nlohmann::json welcome =
        nlohmann::json::parse(page.Hello(url.substr(url.find("#code=") + 6)));
    EXPECT_EQ(welcome["scene"]["file"], "box_9kg");
    token = welcome["token"];
    ASSERT_TRUE(Reaches(&page, RunState::kHeld));
    const auto ended = End(&page);
    ASSERT_TRUE(ended);
    EXPECT_EQ((*ended)["results_follow"], true);
  }
  {
    std::unique_ptr<WebSocket> page;
    const nlohmann::json scene =
        Back(port, token, &page, [](const nlohmann::json& s) { return s.contains("results"); });
    ASSERT_TRUE(page);
    EXPECT_EQ(scene["results"]["how"], "The run ended as planned.");
    EXPECT_EQ(scene["results"]["figures"][0]["value"], "1.0 s");
    EXPECT_TRUE(Choose(page.get(), "single_arm"));
  }
  EXPECT_NE(After("runs without --set name=Other"), "") << Errors();
  // The port of the server must stay the same. A scenario that is chosen after a run must start
  // automatically.
  std::unique_ptr<WebSocket> page;
  const nlohmann::json scene =
      Back(port, token, &page, [](const nlohmann::json& s) { return !s.contains("results"); });
  ASSERT_TRUE(page);
  EXPECT_EQ(scene["file"], "single_arm");
  ASSERT_TRUE(Reaches(page.get(), RunState::kHeld));
  kill(pid_, SIGINT);
  EXPECT_EQ(Wait(), 0) << Errors();
  const nlohmann::json first = nlohmann::json::parse(ReadText(folder_ / "out.json"));
  const nlohmann::json second = nlohmann::json::parse(ReadText(folder_ / "out-2.json"));
  EXPECT_EQ(first["scenario"], "Other");
  EXPECT_NE(second["scenario"], "Other");
  for (const nlohmann::json& summary : {first, second}) {
    EXPECT_EQ(summary["seed"], 7);
    EXPECT_NEAR(summary["duration_s"], 1, 0.01);
  }
}

}  // namespace
}  // namespace predictor::viewer
