#include "viewer/viewer_app.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <optional>
#include <utility>

#include "core/person_json.h"
#include "core/text.h"
#include "core/words.h"
#include "scenario/operating_rules.h"
#include "viewer/scene_description.h"

namespace predictor::viewer {
namespace {

constexpr std::uint64_t kMaxRecords = kRecordRing / 2;  // most between two shown states
constexpr const char* kReportPath = "/report.html";

HubSetup HubSetupOf(const Scenario& scenario, Json scene) {
  HubSetup setup;
  setup.replay = scene.contains("replay");
  if (!setup.replay) setup.rules = RulesFor(scenario);
  for (const Json& entry : scene["scenarios"]) setup.scenarios.push_back(entry["name"]);
  setup.browser_operator = scenario.operator_.type == "browser";
  setup.present = scenario.hands();
  for (int k = 0; k < kParameters; ++k)
    setup.ranges[static_cast<std::size_t>(k)] = RangeOf(scenario, static_cast<Parameter>(k));
  setup.scene = std::move(scene);
  return setup;
}

// Returns the value of `name` in "a=1&b=2", or "" if it is missing.
std::string_view QueryValue(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (pair.size() > name.size() && pair.starts_with(name) && pair[name.size()] == '=')
      return pair.substr(name.size() + 1);
  }
  return {};
}

UpgradeReply Refuse(const HttpReply& reply) { return {reply, {}, 0, {}}; }

struct HostAndPort {
  std::string_view name, port;  // IPv6 address without brackets; port: digits, or empty
};

// Parses "name", "name:8080" and "[::1]:8080". Returns nothing for any other text.
std::optional<HostAndPort> ParseHost(std::string_view text) {
  const bool bracketed = text.starts_with('[');
  const std::size_t end = bracketed ? text.find(']') : std::min(text.find(':'), text.size());
  if (end == std::string_view::npos) return {};
  HostAndPort host{text.substr(bracketed ? 1 : 0, end - (bracketed ? 1 : 0)),
                   text.substr(end + (bracketed ? 1 : 0))};
  const auto in_name = [bracketed](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || (bracketed ? c == ':' : c == '-' || c == '_');
  };
  if (host.name.empty() || !std::all_of(host.name.begin(), host.name.end(), in_name)) return {};
  if (host.port.empty()) return host;
  const std::string_view digits = host.port.substr(1);
  if (host.port[0] != ':' || digits.empty() || digits.size() > 5 ||
      digits.find_first_not_of("0123456789") != std::string_view::npos)
    return {};
  host.port = digits;
  return host;
}

}  // namespace

HttpReply CheckHost(const HttpRequest& request, const std::vector<std::string>& hosts) {
  const HttpReply wrong = {400, "",
                           "The request needs one Host header with this server's name and port.\n"};
  if (request.host_count != 1) return wrong;
  const std::optional<HostAndPort> host = ParseHost(request.host);
  if (!host || (!host->port.empty() && host->port != std::to_string(request.port))) return wrong;
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  const bool own = std::any_of(hosts.begin(), hosts.end(), [&](const std::string& name) {
    return std::equal(name.begin(), name.end(), host->name.begin(), host->name.end(), same);
  });
  if (!own) return {421, "", "This server does not have the name in the request.\n"};
  return {};
}

bool IsOwnOrigin(std::string_view origin, std::string_view host, bool tls) {
  if (origin.empty()) return true;
  return origin == std::string(tls ? "https://" : "http://").append(host);
}

ViewerApp::ViewerApp(AppSetup setup, const Scenario& scenario, const Vector3& object_start,
                     const RunBoard* board, RunMailbox* mailbox, MonotonicClock clock)
    : setup_(std::move(setup)),
      scenario_(scenario),
      admission_(setup_.code_once, setup_.secret, setup_.generations),
      board_(board),
      clock_(std::move(clock)) {
  assets_.AddPage();
  Json scene = DescribeScene(scenario, object_start, &assets_);
  scene["scenarios"] = setup_.scenarios;
  if (setup_.replay.value("duration", 0.0) > 0) {
    scene["replay"] = setup_.replay;
    scene["simulated"] = true;  // nothing moves
  }
  scene["person"] = {{"judged", setup_.states != nullptr}};
  if (!setup_.states) scene["person"]["why"] = setup_.why_not_judged;
  if (!setup_.notice.empty()) scene["notice"] = setup_.notice;
  if (setup_.results.is_object()) scene["results"] = setup_.results;
  if (!setup_.report.empty()) {
    assets_.Add(kReportPath, {std::move(setup_.report), "text/html; charset=utf-8", true});
    scene["results"]["report"] = kReportPath;
  }
  foxglove_ = std::make_unique<Foxglove>(scenario, object_start, clock_);
  HubSetup hub = HubSetupOf(scenario, std::move(scene));
  hub.last_client = setup_.last_client;
  plans_ = !hub.replay && !setup_.results.is_object();
  hub_ = std::make_unique<Hub>(std::move(hub), &admission_, mailbox, clock_);
  if (plans_) hub_->PublishEvents(plan_.Text());
}

ViewerApp::~ViewerApp() = default;

HttpReply ViewerApp::Get(const HttpRequest& request) {
  if (const HttpReply refusal = CheckHost(request, setup_.hosts); refusal.status != 200)
    return refusal;
  if (!IsOwnOrigin(request.origin, request.host, setup_.tls))
    return {403, "", "Requests from other origins are refused.\n"};
  if (request.method != "GET") return {405, "", "Only GET is supported.\n"};
  const Asset* asset = assets_.Find(request.target);
  if (asset == nullptr) return {404, "", "Not found.\n"};
  constexpr std::string_view kBearer = "Bearer ";
  std::string_view token = request.authorization;
  const bool bearer = token.starts_with(kBearer);
  if (bearer) token.remove_prefix(kBearer.size());
  if (asset->needs_token && !(bearer && admission_.ByToken(token)))
    return {401, "", "A token is needed.\n"};
  return {200, asset->type, asset->bytes};
}

UpgradeReply ViewerApp::Upgrade(const HttpRequest& request) {
  if (const HttpReply refusal = CheckHost(request, setup_.hosts); refusal.status != 200)
    return Refuse(refusal);
  const std::string_view target = request.target;
  if (target == "/ws") return UpgradePage(request);
  const std::string_view path = target.substr(0, target.find('?'));
  if (path != "/") return Refuse({404, "", "Not found.\n"});
  return UpgradeFoxglove(request, target.substr(std::min(target.size(), path.size() + 1)));
}

UpgradeReply ViewerApp::UpgradePage(const HttpRequest& request) {
  if (!IsOwnOrigin(request.origin, request.host, setup_.tls))
    return Refuse({403, "", "Requests from other origins are refused.\n"});
  const auto& offered = request.subprotocols;
  if (std::find(offered.begin(), offered.end(), kSubprotocol) == offered.end())
    return Refuse({400, "", "The subprotocol must be predictor.v1.\n"});
  return {{}, kSubprotocol, kLongestMessage, [this](Connection* connection) {
            return hub_->Open(connection);
          }};
}

UpgradeReply ViewerApp::UpgradeFoxglove(const HttpRequest& request, std::string_view query) {
  const auto& origins = setup_.origins;
  if (!IsOwnOrigin(request.origin, request.host, setup_.tls) &&
      std::find(origins.begin(), origins.end(), request.origin) == origins.end())
    return Refuse({403, "", "This origin is not allowed.\n"});
  // Accepts only the token that the console issues for this purpose, because addresses are kept in
  // bookmarks, logs and screenshots.
  const std::string token(QueryValue(query, "token"));
  if (!admission_.MayWatch(token))
    return Refuse({401, "", "The address must contain a read-only token: ?token=...\n"});
  const std::string subprotocol = Foxglove::Choose(request.subprotocols);
  if (subprotocol.empty()) return Refuse({400, "", "The subprotocol must be foxglove.sdk.v1.\n"});
  if (foxglove_->clients() >= Foxglove::kMaxClients)
    return Refuse({503, "", "Too many clients are connected already.\n"});
  return {{}, subprotocol, Foxglove::kLongestMessage, [this](Connection* connection) {
            return foxglove_->Open(connection);
          }};
}

void ViewerApp::EndRun(const std::string& text, bool results_follow) {
  Tick();
  ended_ = true;
  hub_->EndRun(text, results_follow);
  foxglove_->EndRun(text);
}

void ViewerApp::Tick() {
  hub_->Tick();
  if (const std::string address = admission_.TakeLockedOut(); !address.empty() && setup_.notify)
    setup_.notify("The address " + address +
                  " entered five wrong pins and can no longer use the existing pins. Other clients "
                  "can still use it; the command `pin` creates a new pin for all clients.");
  ShowPerson();
  const std::uint64_t written = board_->records.written();
  TickRecord record;
  // If this process was delayed, the newest record may have been overwritten while it was read. If
  // so, the record is read again in the next tick.
  if (written == shown_ || !board_->records.Get(written - 1, &record)) return;
  const Peaks peaks = SeeRecords(std::exchange(shown_, written), written);
  ReportReset(record);
  ReportWarnings(record);
  ShowEvents(record);
  hub_->Publish(
      std::make_shared<const std::string>(PackFrame(
          record, peaks, clock_(), board_->recording.load(std::memory_order_relaxed) != 0)),
      record.state);
  foxglove_->Publish(record);
}

// Another process writes the states, so the viewer must not assume that they are valid.
void ViewerApp::ShowPerson() {
  if (!setup_.states) return;
  const std::uint64_t written = setup_.states->states.written();
  PersonState state;
  if (written == shown_person_ || !setup_.states->states.Get(written - 1, &state)) return;
  shown_person_ = written;
  hub_->PublishPerson(std::make_shared<const std::string>(PersonJson(state)));
}

// Returns the peaks of the records from `first` up to, but excluding, `end`. If there are too many
// records, only the newest ones are used.
Peaks ViewerApp::SeeRecords(std::uint64_t first, std::uint64_t end) {
  Peaks peaks;
  TickRecord record;
  if (end - first > kMaxRecords) first = end - kMaxRecords;
  for (; first != end; ++first) {
    if (!board_->records.Get(first, &record)) continue;
    peaks.See(record);
    plan_.See(record);
    ReportRefusal(record);
  }
  return peaks;
}

// The experimenter's pages receive an event at any time. The other pages receive an event, and a
// fixture that appears through an event, only when the event acts.
void ViewerApp::ShowEvents(const TickRecord& record) {
  if (plans_) hub_->PublishEvents(plan_.Text());
  const std::uint16_t events = std::exchange(events_, record.events);
  const std::uint8_t latest = std::exchange(latest_event_, record.latest_event);
  if (events == record.events && latest == record.latest_event) return;
  hub_->ChangeScene("fixtures", DescribeFixtures(scenario_, record.events));
  hub_->ChangeScene("acting", DescribeActing(scenario_, record.events, record.latest_event));
}

// If pages may not start a run, only the console states why a request was refused.
void ViewerApp::ReportRefusal(const TickRecord& record) {
  if (!RulesFor(scenario_).remote_start) return;
  if (const std::string why = refusals_.See(record); !why.empty()) hub_->Notify(why);
}

void ViewerApp::ReportReset(const TickRecord& record) {
  const RunState before = std::exchange(state_, record.state);
  const bool at_rest = before == RunState::kHeld || before == RunState::kUnpowered;
  if (!at_rest || before == record.state) return;
  if (const std::string kept = KeptThresholds(scenario_, record); !kept.empty()) hub_->Notify(kept);
}

// Sends a warning when its cause begins. Repeats the warning while the cause lasts, for clients
// that connect later.
void ViewerApp::ReportWarnings(const TickRecord& record) {
  constexpr double kAgain = 10;  // [s]
  const bool again = record.tick > warned_ + static_cast<std::uint64_t>(kAgain * scenario_.rate);
  if (again) warnings_ = {};
  std::vector<std::string> messages;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    for (std::string& words : NewWarnings(warnings_[hand], record.hands[hand], hand))
      messages.push_back(std::move(words));
    warnings_[hand] = record.hands[hand].warnings;
  }
  if (messages.empty()) return;
  warned_ = record.tick;
  hub_->Notify(Join(messages, " "));
}

std::uint64_t MonotonicNow() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

}  // namespace predictor::viewer
