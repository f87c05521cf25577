#include "viewer/protocol.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "viewer/frame.h"

namespace predictor::viewer {
namespace {

constexpr std::size_t kLongestSecret = 80;
constexpr double kFarthest = 100;  // maximum distance of a hand from the origin [m]
// The tolerance of a quaternion's norm, because pages use single precision.
constexpr double kQuaternionSlip = 1e-2;
constexpr double kLargestTime = 1e15;    // [ms]
constexpr double kMaxReplaySteps = 1e6;  // maximum number of steps in one request to a replay
constexpr double kMaxReplaySpeed = 64;   // maximum speed of a replay
constexpr double kLargestClock = 9e18;   // [ns]

// Reads the members of a message. `good` becomes false when a member is missing or invalid.
class Reader {
 public:
  explicit Reader(const Json& message) : message_(message) {}

  std::string Text(const char* name) {
    const Json* value = Find(name);
    if (value && value->is_string() &&
        value->get_ref<const std::string&>().size() <= kLongestSecret)
      return value->get<std::string>();
    good_ = false;
    return {};
  }
  double Number(const char* name, double largest) {
    const Json* value = Find(name);
    return value ? Number(*value, largest) : Bad();
  }
  // Reads a monotonic clock's time [ns], given as a number or as a string of digits.
  std::uint64_t Clock(const char* name) {
    const Json* value = Find(name);
    if (value && value->is_number_unsigned()) return value->get<std::uint64_t>();
    if (!value || !value->is_string())
      return static_cast<std::uint64_t>(std::max(0.0, value ? Number(*value, kLargestClock) : 0));
    const auto& digits = value->get_ref<const std::string&>();
    std::uint64_t time = 0;
    const auto end = digits.data() + digits.size();
    Require(std::from_chars(digits.data(), end, time) == std::from_chars_result{end, {}});
    return time;
  }
  bool Flag(const char* name) {
    const Json* value = Find(name);
    if (value && value->is_boolean()) return value->get<bool>();
    good_ = false;
    return false;
  }
  template <std::size_t N>
  std::array<double, N> Numbers(const char* name, double largest) {
    std::array<double, N> numbers = {};
    const Json* value = Find(name);
    if (!value || !value->is_array() || value->size() != N) {
      good_ = false;
      return numbers;
    }
    for (std::size_t i = 0; i < N; ++i) numbers[i] = Number((*value)[i], largest);
    return numbers;
  }
  // `find` must know the name.
  template <class Find>
  auto Named(const char* name, Find find) {
    const auto found = find(Text(name));
    if (!found) good_ = false;
    return found.value_or(typename decltype(find(std::string()))::value_type{});
  }

  // Returns an empty object if the member is missing or no object.
  Json Object(const char* name) {
    const Json* value = Find(name);
    if (value && value->is_object()) return *value;
    good_ = false;
    return Json::object();
  }
  bool Has(const char* name) const { return message_.contains(name); }
  void Require(bool what) { good_ = good_ && what; }
  bool good() const { return good_; }

 private:
  const Json* Find(const char* name) {
    const auto found = message_.find(name);
    if (found != message_.end()) return &*found;
    good_ = false;
    return nullptr;
  }
  double Number(const Json& value, double largest) {
    if (!value.is_number()) return Bad();
    const double x = value.get<double>();
    return std::abs(x) <= largest ? x : Bad();  // false for NaN
  }
  double Bad() {
    good_ = false;
    return 0;
  }

  const Json& message_;
  bool good_ = true;
};

std::optional<InputKind> CommandNamed(const std::string& name) {
  if (name == "align") return InputKind::kAlign;
  if (name == "start") return InputKind::kStart;
  if (name == "reset") return InputKind::kReset;
  if (name == "end") return InputKind::kStop;
  return {};
}

std::optional<Parameter> ParameterNamed(const std::string& name) {
  for (int k = 0; k < kParameters; ++k)
    if (name == Name(static_cast<Parameter>(k))) return static_cast<Parameter>(k);
  return {};
}

std::optional<std::uint8_t> HandNamed(const std::string& name) {
  if (name == "left") return std::uint8_t{0};
  if (name == "right") return std::uint8_t{1};
  return {};
}

HelloRequest ReadHello(Reader* r) {
  using Kind = HelloRequest::Kind;
  r->Require(r->Has("code") + r->Has("pin") + r->Has("token") == 1);
  if (r->Has("pin")) return {Kind::kPin, r->Text("pin")};
  if (r->Has("token")) return {Kind::kToken, r->Text("token")};
  return {Kind::kCode, r->Text("code")};
}

// Reads a pose in W from `p` and `q`, and normalises `q`.
template <class Request>
void ReadPose(Reader* r, Request* request) {
  request->p = r->Numbers<3>("p", kFarthest);
  request->q = r->Numbers<4>("q", 2);
  double norm = 0;
  for (const double x : request->q) norm += x * x;
  norm = std::sqrt(norm);
  r->Require(std::abs(norm - 1) < kQuaternionSlip);
  if (r->good())
    for (double& x : request->q) x /= norm;
}

ReplayRequest ReadReplay(Reader* r) {
  r->Require(r->Has("play") + r->Has("seek") + r->Has("step") == 1);
  if (r->Has("seek")) return {InputKind::kSeek, r->Number("seek", kLargestTime)};
  if (r->Has("step")) return {InputKind::kStep, r->Number("step", kMaxReplaySteps)};
  const double speed = r->Number("play", kMaxReplaySpeed);
  r->Require(speed >= 0);
  return {InputKind::kPlay, speed};
}

HandRequest ReadHand(Reader* r) {
  HandRequest hand;
  hand.hand = r->Named("hand", HandNamed);
  hand.grip = r->Flag("grip");
  ReadPose(r, &hand);
  return hand;
}

HeadRegistration ReadRegistration(const Json& object, Reader* message) {
  Reader r(object);
  const HeadRegistration registration{r.Number("yaw", kLargestHeadYaw),
                                      r.Numbers<3>("t", kFarthestHead),
                                      r.Number("residual", kWorstHeadResidual)};
  message->Require(r.good() && registration.residual >= 0);
  return registration;
}

ImmersiveRequest ReadImmersive(Reader* r) {
  ImmersiveRequest headset;
  headset.active = r->Flag("active");
  if (r->Has("drawn")) headset.drawn_ns = r->Clock("drawn");
  headset.has_head = r->Has("p") || r->Has("q");
  if (headset.has_head) ReadPose(r, &headset);
  if (r->Has("posed")) headset.posed_ns = r->Clock("posed");
  if (r->Has("registration")) headset.registration = ReadRegistration(r->Object("registration"), r);
  return headset;
}

std::optional<PageRequest> Read(const std::string& type, Reader* r) {
  if (type == "hello") return ReadHello(r);
  if (type == "heartbeat") return HeartbeatRequest();
  if (type == "lease") return LeaseRequest{r->Named("what", LeaseNamed), r->Flag("take")};
  if (type == "stop") return StopRequest();
  if (type == "experimenter") return ExperimenterRequest();
  if (type == "command") return CommandRequest{r->Named("command", CommandNamed)};
  if (type == "parameter")
    return ParameterRequest{r->Named("parameter", ParameterNamed), r->Number("value", 1e6)};
  if (type == "scenario") return ScenarioRequest{r->Text("name")};
  if (type == "mark") return MarkRequest();
  if (type == "replay") return ReadReplay(r);
  if (type == "hand") return ReadHand(r);
  if (type == "ping") return PingRequest{r->Number("page_ms", kLargestTime)};
  if (type == "latency")
    return LatencyRequest{r->Number("offset_ms", kLargestTime),
                          r->Number("received_ms", kLargestTime),
                          r->Number("rendered_ms", kLargestTime)};
  if (type == "immersive") return ReadImmersive(r);
  return {};
}

}  // namespace

std::optional<PageRequest> ParsePageRequest(std::string_view text) {
  if (text.size() > kLongestMessage) return {};
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return {};
  Reader reader(message);
  const std::string type = reader.Text("type");
  std::optional<PageRequest> request = Read(type, &reader);
  return reader.good() ? request : std::nullopt;
}

std::string RefusedText(std::string_view reason) {
  return Json{{"type", "refused"}, {"reason", reason}}.dump();
}

std::string PongText(double page_ms, std::uint64_t server_ns) {
  return Json{{"type", "pong"}, {"page_ms", page_ms}, {"server_ns", server_ns}}.dump();
}

std::string DeniedText(std::string_view what, std::string_view reason) {
  return Json{{"type", "denied"}, {"what", what}, {"reason", reason}}.dump();
}

std::string NoticeText(std::string_view text) {
  return Json{{"type", "notice"}, {"text", text}}.dump();
}

std::string EndedText(std::string_view text, bool results_follow) {
  return Json{{"type", "ended"}, {"text", text}, {"results_follow", results_follow}}.dump();
}

std::string TokenText(std::string_view token) {
  return Json{{"type", "token"}, {"token", token}}.dump();
}

std::string HeadsetText(std::uint32_t client, const ImmersiveRequest& headset) {
  return Json{{"type", "headset"},
              {"client", client},
              {"active", headset.active},
              {"p", headset.p},
              {"q", headset.q}}
      .dump();
}

Json LeasesJson(const Leases& leases, std::size_t clients) {
  Json json = Json::object();
  for (const LeaseKind kind : {LeaseKind::kControl, LeaseKind::kOperator}) {
    const std::uint32_t holder = leases.Holder(kind);
    json[Name(kind)] = holder ? Json(holder) : Json(nullptr);
  }
  json["clients"] = clients;
  return json;
}

std::string LeasesText(const Leases& leases, std::size_t clients) {
  Json json = {{"type", "leases"}};
  json.update(LeasesJson(leases, clients));
  return json.dump();
}

std::string SceneText(const char* key, const Json& value) {
  return Json{{"type", key}, {key, value}}.dump();
}

Json FrameJson() {
  Json list = Json::array();
  for (const FrameField& field : FrameFields())
    list.push_back({{"name", field.name},
                    {"offset", field.offset},
                    {"type", field.type},
                    {"count", field.count}});
  return list;
}

}  // namespace predictor::viewer
