#include "survey/survey_app.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "scenario/pseudonym.h"
#include "viewer/protocol.h"
#include "viewer/rate_limit.h"
#include "viewer/viewer_app.h"

namespace predictor::survey {
namespace {

constexpr double kControlFrameRate = 20;  // maximum per second; a browser answers one ping in ten

struct ServedFile {
  const char* path;
  const char* name;
  const char* type;
};
constexpr std::array<ServedFile, 3> kFiles = {{
    {"/", "index.html", "text/html; charset=utf-8"},
    {"/survey.css", "survey.css", "text/css; charset=utf-8"},
    {"/survey.js", "survey.js", "text/javascript; charset=utf-8"},
}};

// If a request must be rejected regardless of its target, returns the reply that rejects it.
// Otherwise, returns status 200.
viewer::HttpReply WhyRefused(const viewer::HttpRequest& request,
                             const std::vector<std::string>& hosts) {
  if (const viewer::HttpReply wrong = viewer::CheckHost(request, hosts); wrong.status != 200)
    return wrong;
  if (!viewer::IsOwnOrigin(request.origin, request.host, false))
    return {403, "", "Requests from other origins are refused.\n"};
  return {};
}

viewer::Json StatementList() {
  viewer::Json list = viewer::Json::array();
  for (const Statement& s : Statements())
    list.push_back({{"name", s.name}, {"aspect", s.aspect}, {"text", s.text}});
  return list;
}

viewer::Json ScaleList() {
  viewer::Json list = viewer::Json::array();
  for (std::size_t i = 0; i < kScores; ++i)
    list.push_back({{"score", kLowestScore + static_cast<int>(i)}, {"name", ScoreNames()[i]}});
  return list;
}

}  // namespace

// The connection of one page, which may not be admitted yet.
class SurveyApp::Client final : public viewer::Session {
 public:
  Client(SurveyApp* app, viewer::Connection* connection)
      : app_(app), connection_(connection), opened_ns_(app->setup_.clock()) {
    app_->clients_.push_back(this);
  }
  ~Client() override {
    std::erase(app_->clients_, this);
    if (ended_ && app_->over_) std::exchange(app_->over_, nullptr)();
  }

  void OnText(std::string_view text) override {
    if (ended_) return;
    if (++messages_ > kMaxMessages) return Close(viewer::CloseCode::kRefused, "Too many messages.");
    const viewer::Json message = viewer::Json::parse(text, nullptr, false);
    const auto type = message.is_object() ? message.find("type") : message.end();
    if (type == message.end() || !type->is_string())
      return Close(viewer::CloseCode::kNotUnderstood, "The message is invalid.");
    if (!admitted_) return Hello(message);
    if (*type == "answer") return Answer(text);
    if (*type == "decline") return Decline();
    Close(viewer::CloseCode::kNotUnderstood, "The message type is unknown.");
  }
  void OnBinary() override { Close(viewer::CloseCode::kNotUnderstood, "Messages must be text."); }
  void OnControlFrame() override {
    if (!control_frames_.Take(app_->setup_.clock()))
      Close(viewer::CloseCode::kRefused, "Too many messages.");
  }

  void Tick(std::uint64_t now_ns) {
    if (!admitted_ && now_ns - opened_ns_ > kHelloTime)
      Close(viewer::CloseCode::kRefused, "The code did not arrive in time.");
  }
  void Close(viewer::CloseCode code, const std::string& reason) {
    connection_->Close(code, reason);
  }

 private:
  void Hello(const viewer::Json& message) {
    const auto text = [&](const char* key) {
      const auto found = message.find(key);
      return found != message.end() && found->is_string() ? found->get<std::string>() : "";
    };
    auto grant = app_->admission_.ByToken(text("token"));
    if (!grant) grant = app_->admission_.ByCode(text("code"));
    if (text("type") != "hello" || !grant) {
      Say({{"type", "refused"},
           {"reason", "The address was already used, or the address is incomplete."}});
      return Close(viewer::CloseCode::kRefused, "Not admitted.");
    }
    admitted_ = true;
    connection_->Admitted();
    const auto& condition = app_->setup_.condition;
    Say({{"type", "welcome"},
         {"token", grant->token},
         {"consent", ConsentText()},
         {"condition", condition ? viewer::Json(Name(*condition)) : viewer::Json(nullptr)},
         {"statements", StatementList()},
         {"scale", ScaleList()},
         {"oldest", kOldest},
         {"longest_comment", kLongestComment}});
  }

  void Answer(std::string_view text) {
    if (app_->end_ != SurveyEnd::kNone)
      return Close(viewer::CloseCode::kRefused, "An answer was already given.");
    try {
      SurveyAnswer answer = ParseSurveyForm(text);
      if (app_->setup_.condition) answer.condition = *app_->setup_.condition;
      if (answer.pseudonym.empty()) answer.pseudonym = DrawPseudonym();
      app_->setup_.store(answer);
      Say({{"type", "stored"}, {"pseudonym", answer.pseudonym}});
      End(SurveyEnd::kStored);
    } catch (const InputError& error) {
      Say({{"type", "denied"}, {"field", error.key()}, {"reason", error.what()}});
    }
  }

  void Decline() {
    if (app_->end_ != SurveyEnd::kNone)
      return Close(viewer::CloseCode::kRefused, "An answer was already given.");
    Say({{"type", "declined"}});
    End(SurveyEnd::kDeclined);
  }

  void End(SurveyEnd end) {
    app_->end_ = end;
    ended_ = true;
    Close(viewer::CloseCode::kNormal, "Thank you.");
  }

  void Say(const viewer::Json& message) { connection_->SendText(message.dump()); }

  SurveyApp* app_;
  viewer::Connection* connection_;
  std::uint64_t opened_ns_;
  int messages_ = 0;
  viewer::RateLimit control_frames_{kControlFrameRate};
  bool admitted_ = false;
  bool ended_ = false;  // whether this client ended the survey
};

SurveyApp::SurveyApp(SurveySetup setup)
    : setup_(std::move(setup)), admission_(true, viewer::NewAdmissionSecret()) {}

SurveyApp::~SurveyApp() = default;

viewer::HttpReply SurveyApp::Get(const viewer::HttpRequest& request) {
  if (const viewer::HttpReply refusal = WhyRefused(request, setup_.hosts); refusal.status != 200)
    return refusal;
  if (request.method != "GET") return {405, "", "Only GET is supported.\n"};
  for (const ServedFile& file : kFiles)
    if (request.target == file.path) return {200, file.type, SurveyPageFile(file.name)};
  return {404, "", "Not found.\n"};
}

viewer::UpgradeReply SurveyApp::Upgrade(const viewer::HttpRequest& request) {
  const auto refuse = [](const viewer::HttpReply& reply) {
    return viewer::UpgradeReply{reply, {}, 0, {}};
  };
  if (const viewer::HttpReply refusal = WhyRefused(request, setup_.hosts); refusal.status != 200)
    return refuse(refusal);
  if (request.target != "/ws") return refuse({404, "", "Not found.\n"});
  const auto& offered = request.subprotocols;
  if (std::find(offered.begin(), offered.end(), kSurveySubprotocol) == offered.end())
    return refuse({400, "", "The subprotocol must be predictor.survey.v1.\n"});
  return {{}, kSurveySubprotocol, kLongestAnswer, [this](viewer::Connection* connection) {
            return std::make_unique<Client>(this, connection);
          }};
}

void SurveyApp::Tick() {
  const std::uint64_t now = setup_.clock();
  for (Client* client : std::vector<Client*>(clients_)) client->Tick(now);
}

}  // namespace predictor::survey
