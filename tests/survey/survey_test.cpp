// Tests the server of the questionnaire through plain sockets.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "scenario/pseudonym.h"
#include "survey/survey_app.h"
#include "viewer/client.h"
#include "viewer/protocol.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"

namespace predictor::survey {
namespace {

using testing_client::Get;
using testing_client::WebSocket;

class SurveyServer : public ::testing::Test {
 protected:
  void Start(std::optional<Condition> condition = {}) {
    SurveySetup setup;
    setup.hosts = {"127.0.0.1", "localhost", "::1"};
    setup.condition = condition;
    setup.clock = [this] { return viewer::MonotonicNow() + late_ns_; };
    setup.store = [this](const SurveyAnswer& answer) {
      if (full_) throw InputError("The disk is full.");
      stored_.push_back(answer);
    };
    app_ = std::make_unique<SurveyApp>(std::move(setup));
    viewer::ServerOptions options;
    options.port = 0;
    server_ = std::make_unique<viewer::Server>(options, app_.get());
    app_->OnOver([this] { server_->Stop(); });
    thread_ = std::thread([this] { server_->Run(); });
  }
  ~SurveyServer() override {
    if (!thread_.joinable()) return;
    server_->Stop();
    thread_.join();
  }

  WebSocket Connect(const std::string& head = "") {
    return WebSocket(server_->port(), "/ws", kSurveySubprotocol, head);
  }
  // Returns the welcome message, or null if the server does not admit the client.
  static viewer::Json Hello(WebSocket* socket, const viewer::Json& with) {
    viewer::Json hello = {{"type", "hello"}};
    hello.update(with);
    socket->SendText(hello.dump());
    const auto text = socket->NextText("welcome");
    return text ? viewer::Json::parse(*text) : viewer::Json();
  }
  static viewer::Json Answer() {
    viewer::Json answers;
    for (const Statement& s : Statements()) answers[s.name] = 2;
    return {{"type", "answer"}, {"consent", true}, {"condition", "real"}, {"answers", answers}};
  }

  std::atomic<std::uint64_t> late_ns_{0};
  std::atomic<bool> full_{false};
  std::vector<SurveyAnswer> stored_;  // read after the server has ended
  std::unique_ptr<SurveyApp> app_;
  std::unique_ptr<viewer::Server> server_;
  std::thread thread_;
};

TEST_F(SurveyServer, ServesOnlyThePageWithStrictHeaders) {
  Start();
  const auto page = Get(server_->port(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_NE(page.body.find("/survey.js"), std::string::npos);
  EXPECT_NE(page.head.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(Get(server_->port(), "/survey.js").head.find("text/javascript"), std::string::npos);
  EXPECT_EQ(Get(server_->port(), "/survey.css").status, 200);
  EXPECT_EQ(Get(server_->port(), "/survey.html").status, 404);
  EXPECT_EQ(Get(server_->port(), "/../survey.js").status, 404);
  EXPECT_EQ(Get(server_->port(), "/", "", "POST").status, 405);
  EXPECT_EQ(Get(server_->port(), "/", "", "GET", "evil.example").status, 421);
  EXPECT_EQ(Get(server_->port(), "/", "Origin: http://evil.example\r\n").status, 403);
}

// Compares the served files with the sources byte by byte.
TEST_F(SurveyServer, HasThePagesFilesCompiledIn) {
  for (const char* name : {"index.html", "survey.css", "survey.js"}) {
    std::ifstream file(std::string(PREDICTOR_SOURCE_DIR) + "/src/survey/page/" + name,
                       std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(SurveyPageFile(name), text) << name;
  }
  EXPECT_TRUE(SurveyPageFile("other").empty());
}

TEST_F(SurveyServer, OpensItsWebSocketToItsOwnPageOnly) {
  Start();
  EXPECT_EQ(Connect("Origin: http://evil.example\r\n").status(), 403);
  EXPECT_EQ(WebSocket(server_->port(), "/ws", "predictor.v1").status(), 400);
  EXPECT_EQ(WebSocket(server_->port(), "/other", kSurveySubprotocol).status(), 404);
  EXPECT_EQ(Connect().status(), 101);
}

TEST_F(SurveyServer, AdmitsOneClientByTheCodeAndAgainByItsToken) {
  Start();
  {
    WebSocket wrong = Connect();
    wrong.SendText(R"({"type": "hello", "code": "wrong"})");
    EXPECT_TRUE(wrong.NextText("refused"));
    EXPECT_EQ(wrong.CloseCode(), 1008);
  }
  std::string token;
  {
    WebSocket first = Connect();
    const viewer::Json welcome = Hello(&first, {{"code", app_->code()}, {"token", nullptr}});
    ASSERT_TRUE(welcome.is_object());
    EXPECT_EQ(welcome["statements"].size(), kStatements);
    EXPECT_EQ(welcome["scale"][0]["score"], -2);
    EXPECT_TRUE(welcome["condition"].is_null());
    token = welcome["token"];
  }
  WebSocket second = Connect();
  EXPECT_TRUE(Hello(&second, {{"code", app_->code()}}).is_null());
  WebSocket again = Connect();
  EXPECT_TRUE(Hello(&again, {{"code", app_->code()}, {"token", token}}).is_object());
}

TEST_F(SurveyServer, StoresAnAnswerAndEnds) {
  Start(Condition::kEmulated);
  WebSocket socket = Connect();
  EXPECT_EQ(Hello(&socket, {{"code", app_->code()}})["condition"], "emulated");
  socket.SendText(Answer().dump());
  const auto reply = socket.NextText("stored");
  ASSERT_TRUE(reply);
  EXPECT_EQ(socket.CloseCode(), 1000);
  thread_.join();  // the server ends by itself
  ASSERT_EQ(stored_.size(), 1u);
  EXPECT_EQ(stored_[0].pseudonym, viewer::Json::parse(*reply)["pseudonym"]);
  EXPECT_TRUE(IsPseudonym(stored_[0].pseudonym));
  EXPECT_EQ(stored_[0].condition, Condition::kEmulated);  // the experimenter's condition counts
  EXPECT_EQ(stored_[0].scores[7], 2);
  EXPECT_EQ(app_->end(), SurveyEnd::kStored);
}

TEST_F(SurveyServer, StoresNothingWithoutConsent) {
  Start();
  WebSocket socket = Connect();
  Hello(&socket, {{"code", app_->code()}});
  viewer::Json answer = Answer();
  answer["consent"] = false;
  socket.SendText(answer.dump());
  const auto denied = socket.NextText("denied");
  ASSERT_TRUE(denied);
  EXPECT_EQ(viewer::Json::parse(*denied)["field"], "consent");
  socket.SendText(R"({"type": "decline"})");
  EXPECT_TRUE(socket.NextText("declined"));
  thread_.join();
  EXPECT_TRUE(stored_.empty());
  EXPECT_EQ(app_->end(), SurveyEnd::kDeclined);
}

TEST_F(SurveyServer, ReportsErrorsAndAcceptsTheCorrection) {
  Start();
  WebSocket socket = Connect();
  Hello(&socket, {{"code", app_->code()}});
  viewer::Json answer = Answer();
  answer["age"] = 423;
  socket.SendText(answer.dump());
  const viewer::Json denied = viewer::Json::parse(socket.NextText("denied").value());
  EXPECT_EQ(denied["field"], "age");
  EXPECT_NE(denied["reason"].get<std::string>().find("1 to 120"), std::string::npos);
  answer["age"] = 42;
  full_ = true;
  socket.SendText(answer.dump());
  EXPECT_EQ(viewer::Json::parse(socket.NextText("denied").value())["reason"], "The disk is full.");
  full_ = false;
  socket.SendText(answer.dump());
  EXPECT_TRUE(socket.NextText("stored"));
  thread_.join();
  ASSERT_EQ(stored_.size(), 1u);
  EXPECT_EQ(stored_[0].age, 42);
}

TEST_F(SurveyServer, AcceptsNoAnswerFromAClientThatWasNotAdmitted) {
  Start();
  WebSocket socket = Connect();
  socket.SendText(Answer().dump());
  EXPECT_EQ(socket.CloseCode(), 1008);
  server_->Stop();
  thread_.join();
  EXPECT_TRUE(stored_.empty());
}

TEST_F(SurveyServer, DisconnectsOnLargeManyOrInvalidMessages) {
  Start();
  std::string token;
  {
    WebSocket socket = Connect();
    token = Hello(&socket, {{"code", app_->code()}})["token"];
    socket.SendText(std::string(kLongestAnswer + 1, ' '));
    EXPECT_EQ(socket.CloseCode(), 1009);
  }
  for (const char* text : {"", "[", "[]", "{}", R"({"type": 1})", R"({"type": "other"})"}) {
    WebSocket socket = Connect();
    ASSERT_TRUE(Hello(&socket, {{"token", token}}).is_object());
    socket.SendText(text);
    EXPECT_EQ(socket.CloseCode(), 1003) << text;
  }
  WebSocket binary = Connect();
  binary.SendFrame(2, "x");
  EXPECT_EQ(binary.CloseCode(), 1003);
  WebSocket many = Connect();
  Hello(&many, {{"token", token}});
  for (int i = 0; i <= SurveyApp::kMaxMessages; ++i) many.SendText(R"({"type": "answer"})");
  EXPECT_EQ(many.CloseCode(), 1008);
}

TEST_F(SurveyServer, DoesNotWaitForTheCodeForEver) {
  Start();
  WebSocket socket = Connect();
  late_ns_ = SurveyApp::kHelloTime + 1;
  EXPECT_EQ(socket.CloseCode(), 1008);
}

}  // namespace
}  // namespace predictor::survey
