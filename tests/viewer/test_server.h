// A complete server that shows the first scenario on a free port and runs in a thread of the test.
#pragma once

#include <future>
#include <memory>
#include <string>
#include <thread>

#include "scenario/scenario_io.h"
#include "viewer/client.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"

namespace predictor::viewer {

class TestServer {
 public:
  struct Setup {
    AppSetup app{{"127.0.0.1", "localhost", "::1"}, false, false, NewAdmissionSecret()};
    ServerOptions server;
    std::vector<std::string> overrides;
  };

  explicit TestServer(Setup setup)
      : board_(std::make_unique<RunBoard>()),
        app_(setup.app,
             LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/box_9kg.yaml",
                          setup.overrides),
             {0.5, 0, 0.3}, board_.get(), &mailbox_, MonotonicNow),
        server_(OnFreePort(setup.server), &app_),
        thread_([this] { server_.Run(); }) {}
  TestServer() : TestServer(Setup()) {}
  ~TestServer() {
    server_.Stop();
    thread_.join();
  }

  std::uint16_t port() const { return server_.port(); }
  RunMailbox& mailbox() { return mailbox_; }
  const std::string& code() { return app_.admission().code(); }

  // Publishes a record in the same way as a run.
  void Publish(std::uint64_t tick) {
    TickRecord record = {};
    record.tick = tick;
    record.wall_ns = MonotonicNow();
    record.parameters = {1, 1, 1, 30, 5};
    record.hands[0].present = record.hands[1].present = 1;
    record.object.pose.q[0] = record.end_effector.pose.q[0] = 1;
    for (HandRecord& hand : record.hands)
      hand.real.pose.q[0] = hand.virtual_.pose.q[0] = 1, hand.wrench[0] = 20;
    board_->records.Publish(record);
  }
  void Publish(const TickRecord& record) { board_->records.Publish(record); }

  // Calls `what(app)` in the server's thread.
  template <class What>
  auto Do(What what) {
    std::packaged_task<decltype(what(app_))()> task([&] { return what(app_); });
    auto result = task.get_future();
    server_.Post([&task] { task(); });
    return result.get();
  }
  std::string Pin(Role role) {
    return Do([role](ViewerApp& app) { return app.admission().IssuePin(role, MonotonicNow()); });
  }
  std::string Token(Role role) {
    return Do([role](ViewerApp& app) { return app.admission().IssueToken(role); });
  }
  std::string WatchToken() {
    return Do([](ViewerApp& app) { return app.admission().IssueWatchToken(); });
  }
  std::size_t Clients() {
    return Do([](ViewerApp& app) { return app.hub().clients(); });
  }
  std::size_t Connections() {
    return Do([this](ViewerApp&) { return server_.connections(); });
  }

 private:
  static ServerOptions OnFreePort(ServerOptions options) {
    options.port = 0;
    return options;
  }

  std::unique_ptr<RunBoard> board_;
  RunMailbox mailbox_;
  ViewerApp app_;
  Server server_;
  std::thread thread_;
};

}  // namespace predictor::viewer
