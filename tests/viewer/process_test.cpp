// Tests the viewer's process: its rights, and what happens when it dies.
#include "support/process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "core/error.h"
#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"
#include "viewer/client.h"
#include "viewer/viewer_process.h"

namespace predictor::viewer {
namespace {

using testing_client::Get;
using testing_client::WebSocket;

using test::Becomes;
using test::StatusOf;

// Returns whether a process listens on all addresses of this machine, according to the kernel.
bool ListensEverywhere(std::uint16_t port) {
  char wanted[40];
  std::snprintf(wanted, sizeof wanted, " 00000000:%04X 00000000:0000 0A ", port);
  std::ifstream sockets("/proc/net/tcp");
  for (std::string line; std::getline(sockets, line);)
    if (line.find(wanted) != std::string::npos) return true;
  return false;
}

class ProcessTest : public testing::Test {
 protected:
  ProcessTest()
      : scenario_(LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml",
                               {"name=Overridden"})) {
    options_.port = 0;
    options_.state_folder = folder_;
  }
  ~ProcessTest() override { viewer_.reset(); }

  void Start() {
    viewer_ = std::make_unique<ViewerProcess>(scenario_, options_, board_, mailbox_,
                                              [this](const std::string& text) {
                                                const std::lock_guard lock(mutex_);
                                                reported_ += text + "\n";
                                              });
  }
  std::string reported() {
    const std::lock_guard lock(mutex_);
    return reported_;
  }
  int CountReported(const std::string& text) {
    const std::string all = reported();
    int count = 0;
    for (std::size_t at = 0; (at = all.find(text, at)) != std::string::npos; ++at) ++count;
    return count;
  }
  bool Reports(const std::string& text) {
    return Becomes([&] { return reported().find(text) != std::string::npos; });
  }
  // Returns whether the token admits a page.
  bool Admits(const std::string& token) const {
    WebSocket back(viewer_->port());
    back.SendText("{\"type\":\"hello\",\"token\":\"" + token + "\"}");
    return !back.NextText("refused").has_value();
  }
  std::string Code() const {
    const std::string url = viewer_->url();
    return url.substr(url.find("#code=") + 6);
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
  Scenario scenario_;
  ViewerOptions options_;
  Shared<RunBoard> board_;
  Shared<RunMailbox> mailbox_;
  std::mutex mutex_;
  std::string reported_;
  std::unique_ptr<ViewerProcess> viewer_;
};

TEST_F(ProcessTest, ServesThisRunsScenarioAndCarriesItsInputs) {
  Start();
  EXPECT_TRUE(Reports("Viewer: http://localhost:" + std::to_string(viewer_->port()) + "/#code="));
  WebSocket page(viewer_->port());
  EXPECT_NE(page.Hello(Code()).find("\"name\":\"Overridden\""), std::string::npos);
  EXPECT_TRUE(Becomes([&] { return mailbox_->clients.load() == 1; }));
  page.SendText(R"({"type":"stop"})");
  EXPECT_TRUE(Becomes([&] { return mailbox_->stops.load() == 1; }));
  TickRecord record = {};
  record.tick = 5;
  board_->records.Publish(record);
  for (;;) {
    const auto message = page.Next();
    ASSERT_TRUE(message);
    if (message->opcode == 2) break;
  }
}

TEST_F(ProcessTest, HasNoRights) {
  Start();
  const int pid = viewer_->pid();
  EXPECT_EQ(StatusOf(pid, "NoNewPrivs"), "1");
  if (geteuid() == 0) {
    EXPECT_EQ(StatusOf(pid, "Uid"), "65534\t65534\t65534\t65534");
    EXPECT_EQ(StatusOf(pid, "Gid"), "65534\t65534\t65534\t65534");
    EXPECT_EQ(StatusOf(pid, "CapEff"), "0000000000000000");
    EXPECT_EQ(StatusOf(pid, "Groups").find_first_of("0123456789"), std::string::npos);
  } else {
    EXPECT_EQ(std::stoul(StatusOf(pid, "Uid")), geteuid());
  }
  EXPECT_EQ(StatusOf(pid, "Threads"), "1");
  // The tests in tests/process check from inside which calls the sandbox refuses. This test checks
  // only that the sandbox is active. The sanitizers do not work inside the sandbox.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (StatusOf(getpid(), "Seccomp").empty()) GTEST_SKIP() << "This kernel has no seccomp.";
  EXPECT_EQ(StatusOf(pid, "Seccomp"), "2");
  EXPECT_GE(std::stoi(StatusOf(pid, "Seccomp_filters")),
            std::stoi(StatusOf(getpid(), "Seccomp_filters")) + 2);  // one for each stage
  EXPECT_EQ(reported().find("seccomp"), std::string::npos) << reported();
#endif
}

// The viewer must not be able to use its shared memory against the run.
TEST_F(ProcessTest, SharedMemoryIsSealed) {
  const int records = board_.descriptor(), inputs = mailbox_.descriptor();
  EXPECT_EQ(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, records, 0), MAP_FAILED);
  EXPECT_NE(pwrite(records, "x", 1, 0), 1);
  EXPECT_NE(ftruncate(records, 0), 0);
  EXPECT_NE(ftruncate(inputs, 0), 0);
  EXPECT_NE(fcntl(inputs, F_ADD_SEALS, F_SEAL_WRITE), 0);
  const Shared<RunBoard> seen(dup(records), false);
  board_->records.Publish({});  // the run itself can still write
  EXPECT_EQ((*seen).records.written(), 1u);
}

TEST_F(ProcessTest, ItsDeathIsReportedAndItRestartsOnTheSamePort) {
  Start();
  const int pid = viewer_->pid();
  const std::uint16_t port = viewer_->port();
  const std::string code = Code();
  WebSocket page(port);
  const std::string welcome = page.Hello(code);
  const std::string token = nlohmann::json::parse(welcome)["token"];
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  EXPECT_TRUE(Reports("The viewer has ended (signal 9); the run continues."));
  ASSERT_TRUE(Becomes([&] { return viewer_->pid() != 0 && viewer_->pid() != pid; }));
  EXPECT_EQ(viewer_->port(), port);
  EXPECT_EQ(Code(), code);  // the code stays the same with simulated arms
  EXPECT_EQ(Get(port, "/").status, 200);
  WebSocket back(port);
  back.SendText("{\"type\":\"hello\",\"token\":\"" + token + "\"}");
  EXPECT_TRUE(back.NextText("welcome"));  // admitted clients stay admitted
}

TEST_F(ProcessTest, EndsWithTheRun) {
  Start();
  const int pid = viewer_->pid();
  viewer_.reset();
  EXPECT_NE(kill(pid, 0), 0);
}

TEST_F(ProcessTest, AnswersTheConsole) {
  Start();
  viewer_->AskPin("look");
  ASSERT_TRUE(Reports("Pin "));
  const std::string text = reported();
  const std::string pin = text.substr(text.find("Pin ") + 4, 6);
  WebSocket page(viewer_->port());
  page.SendText("{\"type\":\"hello\",\"pin\":\"" + pin + "\"}");
  const auto welcome = page.NextText("welcome");
  ASSERT_TRUE(welcome);
  EXPECT_NE(welcome->find("\"role\":\"look\""), std::string::npos);
  page.SendText(R"({"type":"latency","offset_ms":0,"received_ms":4.5,"rendered_ms":9})");
  viewer_->AskStatus();
  EXPECT_TRUE(Reports("1 connected."));
  viewer_->AskPin("everything");
  EXPECT_TRUE(Reports("one of: look, operator, control"));
  viewer_->Revoke("control");
  EXPECT_TRUE(Reports("No one holds the lease control"));
  viewer_->AskFoxglove();
  EXPECT_TRUE(Reports("Foxglove: ws://localhost:" + std::to_string(viewer_->port()) + "/?token="));
}

// The disconnection is permanent, so the next process must also enforce it.
TEST_F(ProcessTest, RemovesAClient) {
  Start();
  WebSocket page(viewer_->port());
  const auto welcome = nlohmann::json::parse(page.Hello(Code()));
  const std::string token = welcome["token"];
  const std::string code = Code();
  for (int i = 1; i <= 25; ++i) {  // the maximum number of answers that are shown without a pause
    viewer_->Kick(4711);
    ASSERT_TRUE(Becomes([&] { return CountReported("no client 4711") == i; }));
  }
  viewer_->Kick(welcome["client"].get<std::uint32_t>());
  EXPECT_EQ(page.CloseCode(), 1008);
  EXPECT_TRUE(Reports("Client 1 was disconnected, and its token is no longer valid."));
  EXPECT_EQ(viewer_->generations(), (Generations{26, 0}));
  EXPECT_FALSE(Admits(token));
  EXPECT_NE(Code(), code);
  const int pid = viewer_->pid();
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  ASSERT_TRUE(Becomes([&] { return viewer_->pid() != 0 && viewer_->pid() != pid; }));
  EXPECT_FALSE(Admits(token));
}

// The request to remove a client arrives while the viewer's process does not exist or can no longer
// answer.
TEST_F(ProcessTest, RemovesAClientWhileItRestarts) {
  Start();
  WebSocket page(viewer_->port());
  const std::string token = nlohmann::json::parse(page.Hello(Code()))["token"];
  const int pid = viewer_->pid();
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  viewer_->Kick(1);  // the stopped process does not receive this
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  ASSERT_TRUE(Becomes([&] { return viewer_->pid() != 0 && viewer_->pid() != pid; }));
  EXPECT_TRUE(Reports("The viewer restarted before it had answered the last request."));
  EXPECT_FALSE(Admits(token));
}

TEST_F(ProcessTest, RemovesAClientAfterItsDeath) {
  Start();
  WebSocket page(viewer_->port());
  const std::string token = nlohmann::json::parse(page.Hello(Code()))["token"];
  const int pid = viewer_->pid();
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  ASSERT_TRUE(Reports("The viewer has ended"));  // and the next process has not started yet
  viewer_->Kick(1);
  viewer_->Revoke("control");
  ASSERT_TRUE(Becomes([&] { return viewer_->pid() != 0 && viewer_->pid() != pid; }));
  EXPECT_FALSE(Admits(token));
  EXPECT_TRUE(Reports("Client 1 is disconnected"));
  // The new process must use other client numbers than the first one.
  WebSocket other(viewer_->port());
  EXPECT_GT(nlohmann::json::parse(other.Hello(Code()))["client"].get<std::uint32_t>(), 1u);
}

// If a viewer hangs, the program must end it after the second request at the latest.
TEST_F(ProcessTest, AViewerThatDoesNotAnswerIsReplaced) {
  Start();
  WebSocket page(viewer_->port());
  const std::string token = nlohmann::json::parse(page.Hello(Code()))["token"];
  const int pid = viewer_->pid();
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  viewer_->Kick(1);
  std::this_thread::sleep_for(std::chrono::milliseconds(2100));
  viewer_->Kick(1);
  EXPECT_TRUE(
      Reports("The viewer does not respond and is being restarted. Client 1 is disconnected"));
  ASSERT_TRUE(Becomes([&] { return viewer_->pid() != 0 && viewer_->pid() != pid; }));
  EXPECT_FALSE(Admits(token));
}

TEST_F(ProcessTest, ReportsWhyItCannotStart) {
  Start();
  ViewerOptions same = options_;
  same.port = viewer_->port();
  const auto refused = [&](const ViewerOptions& options) -> std::string {
    try {
      const ViewerProcess second(scenario_, options, board_, mailbox_, [](const std::string&) {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refused(same).find("--port"), std::string::npos);
  ViewerOptions open = options_;
  open.address = "0.0.0.0";
  EXPECT_NE(refused(open).find("other machines"), std::string::npos);
  ViewerOptions half = options_;
  half.certificate = "a.pem";
  EXPECT_NE(refused(half).find("both or neither"), std::string::npos);
  half.key = "a.key";
  half.tls = true;
  EXPECT_NE(refused(half).find("a.pem"), std::string::npos);
}

TEST_F(ProcessTest, UsesTlsWithOtherMachinesAndShowsItsFingerprint) {
  options_.tls = true;  // at first only for this machine
  Start();
  EXPECT_TRUE(viewer_->url().starts_with("https://localhost:")) << viewer_->url();
  const std::string for_itself = viewer_->fingerprint();
  viewer_.reset();
  options_.expose = true;  // needs no address
  Start();
  // Clients that already trust the certificate need not confirm it again.
  EXPECT_EQ(viewer_->fingerprint(), for_itself);
  EXPECT_TRUE(ListensEverywhere(viewer_->port()));
  EXPECT_TRUE(viewer_->url().starts_with("https://")) << viewer_->url();
  EXPECT_EQ(viewer_->fingerprint().size(), 95u);
  EXPECT_TRUE(Reports(viewer_->fingerprint()));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "viewer.pem"));
  const std::string fingerprint = viewer_->fingerprint();
  viewer_.reset();
  Start();
  EXPECT_EQ(viewer_->fingerprint(), fingerprint);
}

}  // namespace
}  // namespace predictor::viewer
