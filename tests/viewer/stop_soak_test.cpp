// Measures how long a stop request takes from a page to the run's mailbox while the server is as
// busy as possible. 64 viewers read. In addition, clients that were not admitted perform
// handshakes, guess codes and announce huge messages as fast as the server permits.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "support/soak.h"
#include "support/temporary_folder.h"
#include "viewer/certificate.h"
#include "viewer/test_server.h"
#include "viewer/tls_client.h"

namespace predictor::viewer {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing_client::ConnectTls;
using testing_client::Socket;
using testing_client::WebSocket;
using Clock = std::chrono::steady_clock;

constexpr double kLongestStop = 100;  // limit of the 99th percentile [ms]

class StopUnderLoad : public testing::TestWithParam<bool> {
 protected:
  StopUnderLoad() {
    TestServer::Setup setup;
    if (GetParam()) {
      const Certificate certificate = SelfSignedCertificate(folder_, {"localhost", "127.0.0.1"});
      setup.app.tls = true;
      setup.server.certificate_pem = certificate.certificate_pem;
      setup.server.key_pem = certificate.key_pem;
    }
    server_ = std::make_unique<TestServer>(setup);
    threads_.emplace_back([this] { WriteRecords(); });
  }
  ~StopUnderLoad() override {
    done_ = true;
    for (const int descriptor : viewers_) shutdown(descriptor, SHUT_RDWR);
    for (std::thread& thread : threads_) thread.join();
    server_.reset();
  }

  std::optional<Socket> Connect(const char* source) const {
    if (GetParam()) return ConnectTls(server_->port(), source);
    return Socket(server_->port(), 0, source);
  }
  // Returns null if the server does not admit the page.
  std::unique_ptr<WebSocket> Page() const {
    std::optional<Socket> socket = Connect("127.0.0.1");
    if (!socket) return nullptr;
    auto page = std::make_unique<WebSocket>(std::move(*socket), server_->port());
    // Neither a single token nor the read-only role admits this many pages.
    const std::string token = server_->Token(Role::kOperator);
    page->SendText("{\"type\":\"hello\",\"token\":\"" + token + "\"}");
    return page->NextText("welcome") ? std::move(page) : nullptr;
  }

  void AddViewer() {
    std::shared_ptr<WebSocket> page = Page();
    ASSERT_TRUE(page);
    viewers_.push_back(page->socket().descriptor());
    threads_.emplace_back([page] {
      while (const auto message = page->Next())
        if (message->opcode == 8) return;
    });
  }
  void AddAttacker(const char* source) {
    threads_.emplace_back([this, source] {
      // In reality, another machine would do this work, so the work must not take processor time
      // from the server.
      setpriority(PRIO_PROCESS, 0, 19);
      for (long k = 0; !done_; ++k, ++attempts_) Attack(k, source);
    });
  }

  void Attack(long k, const char* source) {
    if (k % 4 == 0) {
      Socket(server_->port(), 0, source).Send(std::string(500, static_cast<char>(k)));
      return;
    }
    std::optional<Socket> socket = Connect(source);
    if (!socket) return;
    if (k % 4 == 1) {
      WebSocket page(std::move(*socket), server_->port());
      page.SendText(R"({"type":"hello","code":"guess"})");
      admitted_ += page.NextText("welcome").has_value();
    } else if (k % 4 == 2) {
      WebSocket(std::move(*socket), server_->port())
          .SendRaw(std::string("\x81\xff\x00\x00\x00\xff\xff\xff\xff\xff", 10));
    } else {
      socket->Send("GET / HTTP/1.1\r\nX: " + std::string(65536, 'x'));
    }
  }

  void WriteRecords() {
    for (std::uint64_t tick = 1; !done_; ++tick, std::this_thread::sleep_for(milliseconds(4)))
      server_->Publish(tick);
  }

  // Returns the delay of the stop request [ms].
  double Stop(WebSocket* page) {
    const std::uint32_t before = server_->mailbox().stops.load();
    const auto start = Clock::now();
    EXPECT_TRUE(page->SendText(R"({"type":"stop"})"));
    while (server_->mailbox().stops.load() == before &&
           Clock::now() - start < std::chrono::seconds(60))
      std::this_thread::sleep_for(microseconds(50));
    EXPECT_EQ(server_->mailbox().stops.load(), before + 1);
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
  std::unique_ptr<TestServer> server_;
  std::atomic<bool> done_{false};
  std::atomic<long> attempts_{0}, admitted_{0};
  std::vector<int> viewers_;
  std::vector<std::thread> threads_;
};
INSTANTIATE_TEST_SUITE_P(PlainAndTls, StopUnderLoad, testing::Bool(),
                         [](const auto& tls) { return tls.param ? "Tls" : "Plain"; });

TEST_P(StopUnderLoad, GetsThroughSoak) {
  const long viewers = Count(8, 63), stops = Count(20, 1000);  // the 64th page stops the run
  for (long k = 0; k < viewers; ++k) ASSERT_NO_FATAL_FAILURE(AddViewer());
  const std::unique_ptr<WebSocket> page = Page();
  ASSERT_TRUE(page);
  for (const char* source : {"127.0.0.2", "127.0.0.3", "127.0.0.4"}) AddAttacker(source);
  std::vector<double> times;
  for (long k = 0; k < stops; ++k, std::this_thread::sleep_for(milliseconds(13)))
    times.push_back(Stop(page.get()));
  std::sort(times.begin(), times.end());
  const auto at = [&times](double p) {
    return times[static_cast<std::size_t>(p * static_cast<double>(times.size() - 1))];
  };
  std::printf(
      "%s, %ld viewers, %ld attempts of strangers: a stop took %.2f / %.2f / %.2f ms to the "
      "mailbox (p50 / p99 / max of %zu).\n",
      GetParam() ? "TLS" : "Plain", viewers + 1, attempts_.load(), at(0.5), at(0.99), times.back(),
      times.size());
  EXPECT_GT(attempts_.load(), 0);
  EXPECT_EQ(admitted_.load(), 0);
  if (Count(0, 1) == 1) {
    EXPECT_LT(at(0.99), kLongestStop);
  }
}

}  // namespace
}  // namespace predictor::viewer
