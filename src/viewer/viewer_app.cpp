#include "viewer/viewer_app.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/text.h"
#include "core/words.h"
#include "viewer/scene_description.h"

namespace predictor {
namespace {

constexpr std::uint64_t kMostRecords = kRecordRing / 2;  // between two states that are shown

HubSetup HubSetupOf(const Scenario& scenario, Json scene) {
  HubSetup setup;
  setup.replay = scene.contains("replay");
  setup.simulated = !scenario.HasRealArms() || setup.replay;
  for (const Json& entry : scene["scenarios"]) setup.scenarios.push_back(entry["name"]);
  setup.browser_operator = scenario.operator_.type == "browser";
  for (int h = 0; h < kHands; ++h) setup.present[static_cast<std::size_t>(h)] = scenario.Has(h);
  for (int k = 0; k < kParameters; ++k)
    setup.ranges[static_cast<std::size_t>(k)] = RangeOf(scenario, static_cast<Parameter>(k));
  setup.scene = std::move(scene);
  return setup;
}

// The value of `name` in "a=1&b=2"; empty if it is not there.
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

}  // namespace

bool IsOwnHost(std::string_view header, const std::vector<std::string>& hosts) {
  std::string_view name = header;
  if (name.starts_with('[')) {  // [::1]:8080
    const std::size_t end = name.find(']');
    if (end == std::string_view::npos) return false;
    const std::string_view rest = name.substr(end + 1);
    if (!rest.empty() && rest[0] != ':') return false;
    name = name.substr(1, end - 1);
  } else if (std::count(name.begin(), name.end(), ':') == 1) {
    name = name.substr(0, name.find(':'));
  }
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  return !name.empty() && std::any_of(hosts.begin(), hosts.end(), [&](const std::string& host) {
    return std::equal(name.begin(), name.end(), host.begin(), host.end(), same);
  });
}

bool IsOwnOrigin(std::string_view origin, std::string_view host, bool tls) {
  if (origin.empty()) return true;
  return origin == std::string(tls ? "https://" : "http://").append(host);
}

ViewerApp::ViewerApp(AppSetup setup, const Scenario& scenario, const Vector3& object_start,
                     const RunBoard* board, RunMailbox* mailbox, MonotonicClock clock)
    : setup_(std::move(setup)),
      scenario_(scenario),
      admission_(setup_.code_once, setup_.secret, setup_.revoked),
      board_(board),
      clock_(std::move(clock)) {
  assets_.AddPage();
  Json scene = DescribeScene(scenario, object_start, &assets_);
  scene["scenarios"] = setup_.scenarios;
  if (setup_.replay.value("duration", 0.0) > 0) {
    scene["replay"] = setup_.replay;
    scene["simulated"] = true;  // nothing moves
  }
  if (!setup_.notice.empty()) scene["notice"] = setup_.notice;
  foxglove_ = std::make_unique<Foxglove>(scenario, object_start, clock_);
  hub_ =
      std::make_unique<Hub>(HubSetupOf(scenario, std::move(scene)), &admission_, mailbox, clock_);
}

ViewerApp::~ViewerApp() = default;

// Status 200 if nothing is wrong.
HttpReply ViewerApp::Refusal(const HttpRequest& request) const {
  if (!IsOwnHost(request.host, setup_.hosts))
    return {421, "", "This server does not go by that name.\n"};
  return {};
}

HttpReply ViewerApp::Get(const HttpRequest& request) {
  if (const HttpReply refusal = Refusal(request); refusal.status != 200) return refusal;
  if (!IsOwnOrigin(request.origin, request.host, setup_.tls))
    return {403, "", "Pages of other origins are not served.\n"};
  if (request.method != "GET") return {405, "", "Only GET is understood.\n"};
  const Asset* asset = assets_.Find(request.target);
  if (asset == nullptr) return {404, "", "There is nothing here.\n"};
  constexpr std::string_view kBearer = "Bearer ";
  std::string_view token = request.authorization;
  const bool bearer = token.starts_with(kBearer);
  if (bearer) token.remove_prefix(kBearer.size());
  if (asset->needs_token && !(bearer && admission_.ByToken(token)))
    return {401, "", "A token is needed.\n"};
  return {200, asset->type, asset->bytes};
}

UpgradeReply ViewerApp::Upgrade(const HttpRequest& request) {
  if (const HttpReply refusal = Refusal(request); refusal.status != 200) return Refuse(refusal);
  const std::string_view target = request.target;
  if (target == "/ws") return UpgradePage(request);
  const std::string_view path = target.substr(0, target.find('?'));
  if (path != "/") return Refuse({404, "", "There is nothing here.\n"});
  return UpgradeFoxglove(request, target.substr(std::min(target.size(), path.size() + 1)));
}

UpgradeReply ViewerApp::UpgradePage(const HttpRequest& request) {
  if (!IsOwnOrigin(request.origin, request.host, setup_.tls))
    return Refuse({403, "", "Pages of other origins are not served.\n"});
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
  // Only what the console gives for it: an address is kept in bookmarks, logs and screenshots.
  const std::string token(QueryValue(query, "token"));
  if (!admission_.MayWatch(token))
    return Refuse({401, "", "A token that only looks is needed: ?token=...\n"});
  const std::string subprotocol = Foxglove::Choose(request.subprotocols);
  if (subprotocol.empty()) return Refuse({400, "", "The subprotocol must be foxglove.sdk.v1.\n"});
  if (foxglove_->clients() >= Foxglove::kMostClients)
    return Refuse({503, "", "Too many clients are connected already.\n"});
  return {{}, subprotocol, Foxglove::kLongestMessage, [this, token](Connection* connection) {
            return foxglove_->Open(connection, token);
          }};
}

void ViewerApp::EndRun(const std::string& text) {
  Tick();
  ended_ = true;
  hub_->EndRun(text);
  foxglove_->EndRun(text);
}

void ViewerApp::Tick() {
  hub_->Tick();
  if (admission_.TakeVoided() && setup_.tell)
    setup_.tell("A pin was guessed at wrongly five times and is void: `pin` gives another.");
  const std::uint64_t written = board_->records.written();
  TickRecord record;
  // The newest may be overwritten while it is read, if this process was held up: then the next.
  if (written == shown_ || !board_->records.Get(written - 1, &record)) return;
  const Peaks peaks = PeaksOf(std::exchange(shown_, written), written);
  TellOfReset(record);
  TellOfWarnings(record);
  hub_->Publish(
      std::make_shared<const std::string>(PackFrame(
          record, peaks, clock_(), board_->recording.load(std::memory_order_relaxed) != 0)),
      record.state);
  foxglove_->Publish(record);
}

// Of the records from `first` on, before `end`; of the newest alone, if there are too many.
Peaks ViewerApp::PeaksOf(std::uint64_t first, std::uint64_t end) const {
  Peaks peaks;
  TickRecord record;
  if (end - first > kMostRecords) first = end - kMostRecords;
  for (; first != end; ++first)
    if (board_->records.Get(first, &record)) peaks.See(record);
  return peaks;
}

void ViewerApp::TellOfReset(const TickRecord& record) {
  const RunState before = std::exchange(state_, record.state);
  const bool at_rest = before == RunState::kHeld || before == RunState::kUnpowered;
  if (!at_rest || before == record.state) return;
  if (const std::string kept = KeptThresholds(scenario_, record); !kept.empty()) hub_->Notify(kept);
}

// When one begins, and from time to time while it lasts, for those who come later.
void ViewerApp::TellOfWarnings(const TickRecord& record) {
  constexpr double kAgain = 10;  // [s]
  const bool again = record.tick > warned_ + static_cast<std::uint64_t>(kAgain * scenario_.rate);
  if (again) warnings_ = {};
  std::vector<std::string> told;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    for (std::string& words : NewWarnings(warnings_[hand], record.hands[hand], hand))
      told.push_back(std::move(words));
    warnings_[hand] = record.hands[hand].warnings;
  }
  if (told.empty()) return;
  warned_ = record.tick;
  hub_->Notify(Join(told, " "));
}

std::uint64_t MonotonicNow() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

}  // namespace predictor
