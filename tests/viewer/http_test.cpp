// Tests the server over plain HTTP.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "support/soak.h"
#include "viewer/test_server.h"

namespace predictor::viewer {
namespace {

using testing_client::Answer;
using testing_client::Get;
using testing_client::Socket;

TestServer::Setup Impatient() {
  TestServer::Setup setup;
  setup.server.head_time = std::chrono::milliseconds(300);
  return setup;
}

TEST(Http, ServesThePageWithStrictHeaders) {
  TestServer server;
  const Answer page = Get(server.port(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_NE(page.body.find("<html"), std::string::npos);
  for (const char* header :
       {"Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
        "connect-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'\r\n",
        "X-Content-Type-Options: nosniff\r\n", "Referrer-Policy: no-referrer\r\n",
        "X-Frame-Options: DENY\r\n", "Cross-Origin-Opener-Policy: same-origin\r\n",
        "Cache-Control: no-store\r\n", "Content-Type: text/html; charset=utf-8\r\n"}) {
    EXPECT_NE(page.head.find(header), std::string::npos) << header << page.head;
  }
  EXPECT_EQ(page.head.find("Access-Control-"), std::string::npos);
  const Answer missing = Get(server.port(), "/missing");
  EXPECT_EQ(missing.status, 404);
  EXPECT_NE(missing.head.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
}

TEST(Http, ModelsNeedAToken) {
  TestServer server;
  const std::string path = "/models/0/model.urdf";
  EXPECT_EQ(Get(server.port(), path).status, 401);
  EXPECT_EQ(Get(server.port(), path, "Authorization: Bearer wrong\r\n").status, 401);
  const std::string token = server.Token(Role::kLook);
  EXPECT_EQ(Get(server.port(), path, "Authorization: Basic " + token + "\r\n").status, 401);
  EXPECT_EQ(Get(server.port(), path + "?token=" + token).status, 404);
  const Answer urdf = Get(server.port(), path, "Authorization: Bearer " + token + "\r\n");
  EXPECT_EQ(urdf.status, 200);
  EXPECT_NE(urdf.body.find("<robot name=\"panda\""), std::string::npos);
  const Answer mesh =
      Get(server.port(), "/models/0/0.dae", "Authorization: Bearer " + token + "\r\n");
  EXPECT_EQ(mesh.status, 200);
  EXPECT_NE(mesh.head.find("Content-Length: " + std::to_string(mesh.body.size())),
            std::string::npos);
}

TEST(Http, ServesNothingElse) {
  TestServer server;
  const std::string token = "Authorization: Bearer " + server.Token(Role::kControl) + "\r\n";
  for (const char* target : {"/index.html",
                             "/favicon.ico",
                             "//",
                             "/./",
                             "/models",
                             "/models/",
                             "/models/0",
                             "/models/0/",
                             "/models/9/model.urdf",
                             "/../../../../etc/passwd",
                             "/models/0/../../../../../etc/passwd",
                             "/models/0/%2e%2e/%2e%2e/etc/passwd",
                             "/models/0/..%2f..%2fetc%2fpasswd",
                             "/models/0/%252e%252e%252fetc%252fpasswd",
                             "/models/0/..%5c..%5cetc%5cpasswd",
                             "/models/0/..\\..\\etc\\passwd",
                             "/models/0/%c0%ae%c0%ae/etc/passwd",
                             "/models/0/....//....//etc/passwd",
                             "/models/0/model.urdf%00.dae",
                             "/etc/passwd",
                             "/proc/self/environ",
                             "http://127.0.0.1/etc/passwd",
                             "*",
                             "/ws"}) {
    const Answer answer = Get(server.port(), target, token);
    EXPECT_TRUE(answer.status == 404 || answer.status == 400) << target << " " << answer.status;
    EXPECT_EQ(answer.body.find("root:"), std::string::npos);
  }
}

TEST(Http, OnlyGetIsUnderstood) {
  TestServer server;
  for (const char* method :
       {"HEAD", "POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH", "NONSENSE"}) {
    const Answer answer = Get(server.port(), "/", "", method);
    EXPECT_EQ(answer.status, 405) << method;
    EXPECT_NE(answer.head.find("Allow: GET\r\n"), std::string::npos);
  }
}

TEST(Http, TakesNoBody) {
  TestServer server;
  EXPECT_EQ(Get(server.port(), "/", "Content-Length: 5\r\n\r\nhello").status, 413);
  EXPECT_EQ(Get(server.port(), "/", "Content-Length: 99999999999\r\n").status, 413);
  EXPECT_EQ(Get(server.port(), "/", "Transfer-Encoding: chunked\r\n\r\n5\r\nhello").status, 413);
  const int both =
      Get(server.port(), "/", "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n").status;
  EXPECT_TRUE(both == 400 || both == 413) << both;
}

TEST(Http, AcceptsOnlyItsOwnNames) {
  TestServer server;
  const std::string port = std::to_string(server.port());
  for (const std::string& host : {"localhost:" + port, "LOCALHOST:" + port, "127.0.0.1:" + port,
                                  "[::1]:" + port, std::string("localhost")})
    EXPECT_EQ(Get(server.port(), "/", "", "GET", host).status, 200) << host;
  for (const std::string& host :
       std::vector<std::string>{"evil.example:" + port, "localhost.evil.example:" + port,
                                "127.0.0.1.evil.example", "192.168.0.1:" + port, "0.0.0.0:" + port})
    EXPECT_EQ(Get(server.port(), "/", "", "GET", host).status, 421) << host;
}

// The rules are from RFC 9112, section 3.2.
TEST(Http, RefusesAHostThatIsNotOne) {
  TestServer server;
  const std::string port = std::to_string(server.port());
  const std::string next = std::to_string(server.port() == 65535 ? 1 : server.port() + 1);
  for (const std::string& host : std::vector<std::string>{
           "localhost:" + next, "localhost:" + port + "0", "localhost:0" + port,
           "localhost:", "localhost:" + port + "@evil.example", "evil.example@localhost:" + port,
           "[::1", "[::1]evil.example", "[::1]" + port, "localhost:1:2", "localhost/:" + port,
           "local host", "localhost:+80", "localhost:-1"})
    EXPECT_EQ(Get(server.port(), "/", "", "GET", host).status, 400) << host;
  const std::string own = "Host: localhost:" + port + "\r\n";
  for (const std::string& second : {own, std::string("Host: evil.example\r\n"),
                                    std::string("Host:\r\n"), "hOST: localhost:" + port + "\r\n"})
    EXPECT_EQ(Get(server.port(), "/", second, "GET", "localhost:" + port).status, 400) << second;
  Socket none(server.port());
  none.Send("GET / HTTP/1.1\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(testing_client::ParseAnswer(none.ReceiveAll()).status, 400);
}

TEST(Http, RefusesForeignOrigins) {
  TestServer server;
  const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
  EXPECT_EQ(Get(server.port(), "/", "Origin: " + own + "\r\n").status, 200);
  for (const std::string& origin :
       std::vector<std::string>{"http://evil.example", "null", own + "0", "https" + own.substr(4),
                                "http://127.0.0.1", own + "/"})
    EXPECT_EQ(Get(server.port(), "/", "Origin: " + origin + "\r\n").status, 403) << origin;
}

TEST(Http, RefusesInvalidRequests) {
  TestServer server;
  for (const std::string& bytes :
       {std::string("GET\r\n\r\n"), std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
        std::string(300, '\xff') + "\r\n\r\n", std::string("GET / HTTP/9.9\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nno colon\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: a\r\n b\r\nX\x01: y\r\n\r\n")}) {
    Socket socket(server.port());
    socket.Send(bytes);
    const Answer answer = testing_client::ParseAnswer(socket.ReceiveAll());
    EXPECT_GE(answer.status, 400) << bytes;
    EXPECT_LT(answer.status, 500) << bytes;
  }
  EXPECT_EQ(Get(server.port(), "/").status, 200);
}

TEST(Http, BoundsTheHead) {
  TestServer server;
  EXPECT_EQ(Get(server.port(), "/", "X: " + std::string(7000, 'x') + "\r\n").status, 200);
  EXPECT_EQ(Get(server.port(), "/", "X: " + std::string(9000, 'x') + "\r\n").status, 431);
  EXPECT_EQ(Get(server.port(), "/" + std::string(100'000, 'x')).status, 431);
}

TEST(Http, KeepsAConnectionForMoreRequests) {
  TestServer server;
  Socket socket(server.port());
  const std::string host = "Host: 127.0.0.1:" + std::to_string(server.port()) + "\r\n";
  socket.Send("GET / HTTP/1.1\r\n" + host + "\r\nGET /x HTTP/1.1\r\n" + host + "\r\n");
  const std::string all = socket.ReceiveAll();
  EXPECT_NE(all.find("HTTP/1.1 200"), std::string::npos);
  EXPECT_NE(all.find("HTTP/1.1 404"), std::string::npos);
}

// ---- timeouts -----------------------------------------------------------------------------------

TEST(Http, AHeadThatDoesNotEndIsCutOff) {
  TestServer server(Impatient());
  std::vector<Socket> sockets;
  for (int i = 0; i < 20; ++i) {
    sockets.emplace_back(server.port());
    sockets.back().Send("GET / HTTP/1.1\r\nX-");
  }
  // A client that occasionally sends a byte must not extend its time limit. The server must end the
  // connection even while bytes arrive.
  int cut_off = 0;
  for (int k = 0; k < 200 && cut_off < 20; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    cut_off = 0;
    for (Socket& socket : sockets) cut_off += !socket.Send("x");
  }
  EXPECT_EQ(cut_off, 20);
  EXPECT_EQ(Get(server.port(), "/").status, 200);
}

// The number of slow clients is larger than the number of connections that the server accepts. The
// server must still serve the newest request.
TEST(Http, SlowClientsDoNotKeepOthersOut) {
  TestServer server;  // with long time-outs, so that no client times out
  std::vector<Socket> sockets;
  for (int i = 0; i < 600; ++i) {
    sockets.emplace_back(server.port());
    ASSERT_TRUE(sockets.back().Send("GET / HT"));
  }
  EXPECT_EQ(Get(server.port(), "/").status, 200);
  EXPECT_LE(server.Connections(), 256u + 2);
  EXPECT_TRUE(sockets.front().Ended());
}

// If one address opens too many connections, the server must close only connections of this
// address.
TEST(Http, OneAddressDoesNotKeepOthersOut) {
  TestServer::Setup setup;
  setup.server.max_guests_per_address = 4;
  TestServer server(setup);  // patient
  Socket quiet(server.port(), 0, "127.0.0.2");
  std::vector<Socket> many;
  for (int i = 0; i < 300; ++i) {
    many.emplace_back(server.port(), 0, "127.0.0.3");
    ASSERT_TRUE(many.back().Send("GET / HT"));
  }
  EXPECT_TRUE(many.front().Ended());
  quiet.Send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(testing_client::ParseAnswer(quiet.ReceiveAll()).status, 200);
}

TEST(Http, SoakTakesManyConnections) {
  TestServer server;
  const long count = Count(1'000, 10'000);
  for (long i = 0; i < count; ++i) {
    switch (i % 4) {
      case 0:
        Socket(server.port());
        break;
      case 1:
        Socket(server.port()).Send("GET / HTTP/1.1\r\n");
        break;
      case 2:
        Socket(server.port()).Send("\x80\x81\x82");
        break;
      default:
        ASSERT_EQ(Get(server.port(), "/").status, 200) << i;
    }
  }
  EXPECT_EQ(Get(server.port(), "/").status, 200);
  for (int wait = 0; server.Connections() > 1 && wait < 100; ++wait)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_LE(server.Connections(), 1u);
}

// ---- the port -----------------------------------------------------------------------------------

struct Nothing : Application {
  HttpReply Get(const HttpRequest&) override { return {404, "", ""}; }
  UpgradeReply Upgrade(const HttpRequest&) override { return {}; }
  void Tick() override {}
};

std::string Refused(const ServerOptions& options) {
  Nothing application;
  try {
    const Server server(options, &application);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Port, InUseIsAnErrorWithARemedy) {
  TestServer server;
  ServerOptions options;
  options.port = server.port();
  const std::string error = Refused(options);
  EXPECT_NE(error.find("port " + std::to_string(server.port())), std::string::npos) << error;
  EXPECT_NE(error.find("--port"), std::string::npos) << error;
}

TEST(Port, ToOtherMachinesNeedsTls) {
  ServerOptions options;
  options.port = 0;
  for (const char* address : {"0.0.0.0", "::"}) {
    options.address = address;
    EXPECT_NE(Refused(options).find("TLS"), std::string::npos) << address;
  }
  options.address = "no address";
  EXPECT_NE(Refused(options).find("numeric"), std::string::npos);
}

}  // namespace
}  // namespace predictor::viewer
