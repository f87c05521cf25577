// Tests the server over WebSockets, with pages and with other clients.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <random>

#include "support/soak.h"
#include "viewer/frame_offset.h"
#include "viewer/test_server.h"

namespace predictor::viewer {
namespace {

using std::chrono::milliseconds;
using testing_client::Message;
using testing_client::WebSocket;

std::string Hello(const std::string& kind, const std::string& secret) {
  return Json{{"type", "hello"}, {kind, secret}}.dump();
}

std::uint64_t TickOf(const std::string& frame) {
  std::uint64_t tick = 0;
  std::memcpy(&tick, frame.data(), sizeof tick);  // the first field
  return tick;
}

// Publishes one record per millisecond until it is destroyed.
class FakeRun {
 public:
  explicit FakeRun(TestServer* server)
      : thread_([this, server] {
          while (!done_) {
            server->Publish(++tick_);
            std::this_thread::sleep_for(milliseconds(1));
          }
        }) {}
  ~FakeRun() {
    done_ = true;
    thread_.join();
  }
  std::uint64_t tick() const { return tick_; }

 private:
  std::atomic<bool> done_{false};
  std::atomic<std::uint64_t> tick_{0};
  std::thread thread_;
};

// Waits at most ten seconds for `condition`.
template <class Condition>
bool Becomes(Condition condition) {
  for (int i = 0; i < 1000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return false;
}

TEST(WebSocketServer, WelcomesAndShowsStates) {
  TestServer server;
  WebSocket page(server.port());
  ASSERT_EQ(page.status(), 101);
  EXPECT_NE(page.answer().head.find("predictor.v1"), std::string::npos);
  const std::string welcome = page.Hello(server.code());
  EXPECT_NE(welcome.find("\"role\":\"control\""), std::string::npos);
  EXPECT_NE(welcome.find("Box of 9 kg"), std::string::npos);
  server.Publish(41);
  for (;;) {
    const auto message = page.Next();
    ASSERT_TRUE(message);
    if (message->opcode != 2) continue;
    EXPECT_EQ(message->payload.size(), FrameBytes());
    EXPECT_EQ(TickOf(message->payload), 41u);
    break;
  }
}

TEST(WebSocketServer, RefusesForeignPagesAndNames) {
  TestServer server;
  const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
  EXPECT_EQ(WebSocket(server.port(), "/ws", "predictor.v1", "Origin: " + own + "\r\n").status(),
            101);
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"})
    EXPECT_EQ(
        WebSocket(server.port(), "/ws", "predictor.v1", std::string("Origin: ") + origin + "\r\n")
            .status(),
        403)
        << origin;
  const std::string twice = "Host: localhost\r\nHost: localhost\r\n";
  EXPECT_EQ(WebSocket(server.port(), "/ws", "predictor.v1", twice).status(), 400);
  EXPECT_EQ(WebSocket(server.port(), "/ws", "predictor.v1", "Host: evil.example\r\n").status(),
            421);
  EXPECT_EQ(WebSocket(server.port(), "/ws", "").status(), 400);
  EXPECT_EQ(WebSocket(server.port(), "/ws", "other").status(), 400);
  EXPECT_EQ(WebSocket(server.port(), "/elsewhere").status(), 404);
  EXPECT_EQ(WebSocket(server.port(), "/ws/../ws").status(), 404);
}

TEST(WebSocketServer, RefusesWrongSecrets) {
  TestServer server;
  for (const char* kind : {"code", "pin", "token"}) {
    WebSocket page(server.port());
    page.SendText(Hello(kind, "123456"));
    const auto refused = page.NextText("refused");
    ASSERT_TRUE(refused) << kind;
    EXPECT_EQ(page.CloseCode(), 1008) << kind;
  }
  EXPECT_EQ(server.Clients(), 0u);
}

TEST(WebSocketServer, APinAdmitsAsItsRoleAndFiveTriesAreTheEnd) {
  TestServer server;
  WebSocket first(server.port());
  first.SendText(Hello("pin", server.Pin(Role::kOperator)));
  const auto welcome = first.NextText("welcome");
  ASSERT_TRUE(welcome);
  EXPECT_EQ(Json::parse(*welcome)["role"], "operator");
  const std::string pin = server.Pin(Role::kControl);
  for (int i = 0; i < 5; ++i) {
    WebSocket page(server.port());
    page.SendText(Hello("pin", pin == "111111" ? "222222" : "111111"));
    EXPECT_EQ(page.CloseCode(), 1008);
  }
  WebSocket late(server.port());
  late.SendText(Hello("pin", pin));
  EXPECT_FALSE(late.NextText("welcome"));
}

TEST(WebSocketServer, SixtyFourViewersAndNoMore) {
  TestServer server;
  std::vector<std::unique_ptr<WebSocket>> pages;
  for (int i = 0; i < 64; ++i) {
    pages.push_back(std::make_unique<WebSocket>(server.port()));
    ASSERT_NE(pages.back()->Hello(server.code()), "") << i;
  }
  WebSocket late(server.port());
  late.SendText(Hello("code", server.code()));
  EXPECT_EQ(late.CloseCode(), 1013);
  pages.clear();
  EXPECT_TRUE(Becomes([&] { return server.Clients() == 0; }));
  WebSocket next(server.port());
  EXPECT_NE(next.Hello(server.code()), "");
}

TEST(WebSocketServer, TwoViewersAndOneController) {
  TestServer server;
  WebSocket one(server.port()), two(server.port());
  const Json first = Json::parse(one.Hello(server.code()));
  two.Hello(server.code());
  one.SendText(R"({"type":"lease","what":"control","take":true})");
  for (;;) {
    const auto leases = two.NextText("leases");
    ASSERT_TRUE(leases);
    if (Json::parse(*leases)["control"] == first["client"]) break;
  }
  two.SendText(R"({"type":"command","command":"start"})");
  EXPECT_TRUE(two.NextText("denied"));
  RunInput input;
  EXPECT_FALSE(server.mailbox().inputs.Pop(&input));
  one.SendText(R"({"type":"command","command":"start"})");
  ASSERT_TRUE(Becomes([&] { return server.mailbox().inputs.Pop(&input); }));
  EXPECT_EQ(input.kind, InputKind::kStart);
}

TEST(WebSocketServer, AStopOfAViewOnlyClientReachesTheMailbox) {
  TestServer server;
  WebSocket page(server.port());
  page.SendText(Hello("pin", server.Pin(Role::kLook)));
  ASSERT_TRUE(page.NextText("welcome"));
  page.SendText(R"({"type":"stop"})");
  EXPECT_TRUE(Becomes([&] { return server.mailbox().stops.load() == 1; }));
}

TEST(WebSocketServer, AStopArrivesDespiteAFloodOfOtherMessages) {
  TestServer server;
  WebSocket page(server.port());
  page.Hello(server.code());
  for (int i = 0; i < 450; ++i) page.SendText(R"({"type":"ping","page_ms":1})");
  page.SendText(R"({"type":"stop"})");
  EXPECT_TRUE(Becomes([&] { return server.mailbox().stops.load() == 1; }));
}

// ---- invalid messages ---------------------------------------------------------------------------

TEST(WebSocketServer, RefusesMessagesThatAreTooLarge) {
  TestServer server;
  WebSocket page(server.port());
  page.Hello(server.code());
  page.SendText("{\"type\":\"heartbeat\",\"x\":\"" + std::string(1100, 'x') + "\"}");
  EXPECT_EQ(page.CloseCode(), 1009);
  // The message announces a huge size but contains no data.
  WebSocket liar(server.port());
  liar.SendRaw(std::string("\x81\xff\x00\x00\x00\xff\xff\xff\xff\xff\x01\x02\x03\x04", 14));
  EXPECT_EQ(liar.CloseCode(), 1009);
  // The message is sent in fragments.
  WebSocket slicer(server.port());
  slicer.SendFrame(1, std::string(600, 'x'), false);
  slicer.SendFrame(0, std::string(600, 'x'), true);
  EXPECT_EQ(slicer.CloseCode(), 1009);
}

TEST(WebSocketServer, TakesFragmentsThatCompleteInTime) {
  TestServer::Setup setup;
  setup.server.message_time = milliseconds(10'000);
  TestServer server(setup);
  WebSocket page(server.port());
  const std::string hello = Hello("code", server.code());
  page.SendFrame(1, hello.substr(0, 5), false);
  page.SendFrame(9, "between");
  for (std::size_t i = 5; i < hello.size() - 1; ++i) page.SendFrame(0, hello.substr(i, 1), false);
  page.SendFrame(0, hello.substr(hello.size() - 1), true);
  EXPECT_TRUE(page.NextText("welcome"));
}

TEST(WebSocketServer, AMessageMustEndWithinASecond) {
  TestServer::Setup setup;
  setup.server.message_time = milliseconds(200);
  TestServer server(setup);
  WebSocket page(server.port());
  page.Hello(server.code());
  page.SendFrame(1, "{", false);
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(milliseconds(50));
    page.SendFrame(0, " ", false);
  }
  EXPECT_EQ(page.CloseCode(), 1008);
  // The limit must also apply if no frame is ever complete.
  WebSocket slow(server.port());
  slow.Hello(server.code());
  slow.SendRaw(std::string("\x81\x90\x01\x02\x03\x04{", 7));
  EXPECT_EQ(slow.CloseCode(), 1008);
}

TEST(WebSocketServer, RefusesInvalidMessages) {
  TestServer server;
  const auto code_after = [&](auto send) {
    WebSocket page(server.port());
    page.Hello(server.code());
    send(page);
    return page.CloseCode();
  };
  EXPECT_EQ(code_after([](WebSocket& p) { p.SendText("garbage"); }), 1003);
  EXPECT_EQ(code_after([](WebSocket& p) { p.SendFrame(2, "binary"); }), 1003);
  EXPECT_EQ(code_after([](WebSocket& p) { p.SendText("\xff\xfe"); }), 1007);
  EXPECT_EQ(code_after([](WebSocket& p) { p.SendFrame(3, "reserved"); }), 1002);
  EXPECT_EQ(code_after([](WebSocket& p) { p.SendRaw("\x81\x02{}"); }), 1002);  // not masked
  EXPECT_EQ(code_after([](WebSocket& p) {
              p.SendText(
                  "{\"type\":\"stop\"} "
                  "{\"type\":\"stop\"}");
            }),
            1003);
  EXPECT_EQ(server.mailbox().stops.load(), 0u);
}

TEST(WebSocketServer, SoakSurvivesBinaryGarbage) {
  TestServer server;
  std::mt19937 random(7);
  for (long i = 0; i < Count(100, 10'000); ++i) {
    WebSocket page(server.port());
    if (i % 2) page.Hello(server.code());
    std::string garbage(1 + random() % 3000, '\0');
    for (char& c : garbage) c = static_cast<char>(random());
    page.SendRaw(garbage);
  }
  WebSocket page(server.port());
  EXPECT_NE(page.Hello(server.code()), "");
  EXPECT_EQ(server.mailbox().stops.load(), 0u);
}

TEST(WebSocketServer, AFloodIsCutOff) {
  TestServer server;
  WebSocket page(server.port());
  page.Hello(server.code());
  std::thread flood([&] {
    for (int i = 0; i < 200'000; ++i)
      if (!page.SendText(R"({"type":"heartbeat"})")) break;
  });
  EXPECT_TRUE(Becomes([&] { return server.Clients() == 0; }));
  flood.join();
  EXPECT_EQ(testing_client::Get(server.port(), "/").status, 200);
}

TEST(WebSocketServer, AFloodOfPingsIsCutOff) {
  TestServer server;
  WebSocket page(server.port());
  page.Hello(server.code());
  std::thread flood([&] {
    for (int i = 0; i < 200'000; ++i)
      if (!page.SendFrame(9, "x")) break;
  });
  EXPECT_TRUE(Becomes([&] { return server.Clients() == 0; }));
  flood.join();
}

// ---- slow readers -------------------------------------------------------------------------------

// A client that does not read must not delay any other client. When this client reads again, it
// first receives the data that was already in transit, which is less than half a second of states.
// After that it receives the newest state.
TEST(WebSocketServer, AClientThatDoesNotReadFindsTheNewestStateLater) {
  TestServer server;
  WebSocket sleeper(server.port()), other(server.port());
  ASSERT_NE(sleeper.Hello(server.code()), "");
  ASSERT_NE(other.Hello(server.code()), "");
  std::uint64_t fell_asleep = 0, woke = 0;
  int states = 0;
  {
    FakeRun run(&server);
    fell_asleep = run.tick();
    while (states < 120) {
      const auto message = other.Next();
      ASSERT_TRUE(message);
      states += message->opcode == 2;
    }
    woke = run.tick();
    int stale = 0;
    for (;;) {
      const auto message = sleeper.Next();
      ASSERT_TRUE(message);
      if (message->opcode == 2 && TickOf(message->payload) >= woke) break;
      stale += message->opcode == 2;
    }
    EXPECT_GT(woke, fell_asleep);
    EXPECT_LE(stale, 30);
  }
}

TEST(WebSocketServer, AClientThatNeverReadsIsCutOffInTheEnd) {
  TestServer::Setup setup;
  setup.server.idle_time = milliseconds(500);
  TestServer server(setup);
  WebSocket sleeper(server.port(), "/ws", "predictor.v1", "", 4096);
  ASSERT_NE(sleeper.Hello(server.code()), "");
  FakeRun run(&server);
  EXPECT_TRUE(Becomes([&] { return server.Clients() == 0; }));
}

// In this test, a client sends but does not read. The number of answers that wait for this client
// must be bounded.
TEST(WebSocketServer, AClientThatSendsAndNeverReadsIsDisconnected) {
  TestServer::Setup setup;
  setup.server.max_waiting_text = 2000;
  TestServer server(setup);
  {
    WebSocket fits(server.port());  // the welcome itself is longer
    fits.SendText(Hello("code", server.code()));
    EXPECT_TRUE(Becomes([&] { return server.Clients() == 0; }));
  }
}

TEST(WebSocketServer, StatesComeAtMostSixtyTimesASecond) {
  TestServer server;
  WebSocket page(server.port());
  ASSERT_NE(page.Hello(server.code()), "");
  FakeRun run(&server);
  std::uint64_t first_sent = 0, last_sent = 0;
  int states = 0;
  while (states < 61) {
    const auto message = page.Next();
    ASSERT_TRUE(message);
    if (message->opcode != 2) continue;
    std::memcpy(&last_sent, message->payload.data() + FrameOffset("sent_ns"), 8);
    if (states++ == 0) first_sent = last_sent;
  }
  EXPECT_GE(static_cast<double>(last_sent - first_sent) * 1e-9, 0.95);
}

}  // namespace
}  // namespace predictor::viewer
