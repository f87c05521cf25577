// Implements the part of the viewer that belongs to the run's process. This part sends messages and
// the operator's requests to the viewer's process.
#include "viewer/viewer_process.h"

#include <pwd.h>
#include <unistd.h>

#include <cstdlib>

#include "core/error.h"
#include "core/text.h"
#include "process/attached_run.h"
#include "viewer/address.h"
#include "viewer/generations_json.h"
#include "viewer/leases.h"

namespace predictor::viewer {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr const char* kEverywhere = "0.0.0.0";
constexpr std::uint32_t kClientsOfOneStart = 10000;
constexpr auto kPatience = std::chrono::seconds(2);  // wait for the answer to a request

std::string AddressOf(const ViewerOptions& o) {
  if (!o.address.empty()) return o.address;
  return o.expose ? kEverywhere : kLoopback;
}

void Check(const ViewerOptions& options) {
  if (!IsAddress(AddressOf(options)))
    throw InputError(
        "'" + options.address +
        "' is not an address. Give a numeric address of this machine, for example 192.0.2.7.");
  if (!IsLoopback(AddressOf(options)) && !options.expose)
    throw InputError("The viewer's address " + options.address +
                     " can be reached from other machines. Allow other machines to connect with "
                     "--expose, or keep the address 127.0.0.1.");
  if (options.certificate.empty() != options.key.empty())
    throw InputError("A certificate needs its key, and vice versa. Give both or neither.");
}

// Returns the folder of the certificate, or "" if no certificate is needed.
std::filesystem::path StateFolderOf(const ViewerOptions& o) {
  if (!o.state_folder.empty() || !o.certificate.empty() || !(o.tls || o.expose))
    return o.state_folder;
  return StateFolder();
}

Json ToJson(const Scenario& scenario, const ViewerOptions& o, bool judged) {
  Check(o);
  Json line = RunLine(scenario, o.object_start);
  Json scenarios = Json::array();
  for (const ScenarioTitle& s : o.scenarios)
    scenarios.push_back({{"name", s.name}, {"title", Printable(s.title)}});
  line.update({{"address", AddressOf(o)},
               {"port", o.port},
               {"tls", o.tls || o.expose},
               {"certificate", o.certificate.string()},
               {"key", o.key.string()},
               {"state_folder", StateFolderOf(o).string()},
               {"names", o.names},
               {"foxglove_origins", o.foxglove_origins},
               {"replay", {{"duration", o.replay.duration}, {"first_tick", o.replay.first_tick}}},
               {"secret", o.secret.empty() ? NewAdmissionSecret() : o.secret},
               {"generations", ToJson(o.generations)},
               {"last_client", 0},
               {"scenarios", scenarios},
               {"notice", Printable(o.notice, Lines::kMany)},
               {"results", Json::parse(o.results.empty() ? "null" : o.results)},
               {"report", o.report.string()},
               {"judged", judged},
               {"why_not_judged", o.why_not_judged}});
  return line;
}

ChildSetup WithStates(ChildSetup setup, const Shared<EvaluationBoard>* states) {
  if (states) setup.reads = states->read_only_descriptor();
  return setup;
}

std::string Text(const Json& line, const char* name) {
  const auto found = line.find(name);
  return found != line.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::filesystem::path StateFolder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && state[0] == '/') return std::filesystem::path(state) / "predictor";
  const char* home = std::getenv("HOME");
  if (home == nullptr || home[0] != '/')
    if (const passwd* user = getpwuid(geteuid())) home = user->pw_dir;
  if (home == nullptr || home[0] != '/')
    throw InputError(
        "The page's certificate cannot be stored. Set HOME or XDG_STATE_HOME to a folder of your "
        "own.");
  return std::filesystem::path(home) / ".local/state/predictor";
}

// After a restart, the process numbers its clients from a different start. Therefore, `kick` never
// removes a client other than the one that `status` showed.
void ViewerProcess::HearReady(const Json& line) {
  bool unanswered = false, outdated = false;
  Json now;
  {
    const std::lock_guard lock(mutex_);
    fingerprint_ = Text(line, "fingerprint");
    unanswered = waits_since_.has_value();
    waits_since_.reset();
    now = ToJson(generations_);
    outdated = line.value("generations", Json()) != now;
    if (++starts_ == 1) return;  // first start: the constructor of `process_` is still running
    process_.Remember("last_client", kClientsOfOneStart * starts_);
  }
  if (unanswered)
    notify_(
        "The viewer restarted before it had answered the last request. A client that was to be "
        "removed is disconnected, and no client holds a lease.");
  // The generation changed while the process was starting.
  if (outdated) process_.Ask({{"do", "kick all"}, {"generations", now}});
}

void ViewerProcess::Hear(const Json& line) {
  if (line.contains("ready")) HearReady(line);
  if (line.contains("done")) {
    const std::lock_guard lock(mutex_);
    waits_since_.reset();
  }
  const std::string address = Text(line, line.contains("ready") ? "ready" : "url");
  if (address.empty()) return;
  std::string where;
  {
    const std::lock_guard lock(mutex_);
    url_ = address;
    where = "Viewer: " + url_;
    if (!fingerprint_.empty()) where += "\n        certificate (SHA-256): " + fingerprint_;
  }
  notify_(where);
}

// Sends a request that must not be lost. `if_absent` is the message for the case that no process is
// running.
void ViewerProcess::Ask(const Json& line, const std::string& if_absent) {
  bool hangs = false;
  {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    hangs = waits_since_ && now - *waits_since_ > kPatience;
    if (!waits_since_) waits_since_ = now;
  }
  if (!hangs && process_.Ask(line)) return;
  if (hangs || process_.pid() != 0) {
    notify_("The viewer does not respond and is being restarted. " + if_absent);
    process_.Kill();
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    waits_since_.reset();
  }
  notify_("The viewer is restarting. " + if_absent);
}

void ViewerProcess::Renew(std::uint32_t Generations::*which, Json line, const std::string& who) {
  {
    const std::lock_guard lock(mutex_);
    ++(generations_.*which);
    line["generations"] = ToJson(generations_);
    process_.Remember("generations", line["generations"]);
  }
  Ask(line, who + " is disconnected. All earlier tokens, pins and addresses are invalid.");
}

ViewerProcess::ViewerProcess(const Scenario& scenario, const ViewerOptions& options,
                             const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox,
                             Notify notify, const Shared<EvaluationBoard>* states)
    : notify_(std::move(notify)),
      generations_(options.generations),
      process_(WithStates({"The viewer", kViewerSubcommand,
                           ToJson(scenario, options, states != nullptr), board.descriptor(),
                           mailbox.descriptor(), notify_, [this](const Json& line) { Hear(line); }},
                          states)) {
  process_.Remember("last_client", kClientsOfOneStart);
}

std::string ViewerProcess::url() const {
  const std::lock_guard lock(mutex_);
  return url_;
}

std::string ViewerProcess::fingerprint() const {
  const std::lock_guard lock(mutex_);
  return fingerprint_;
}

Generations ViewerProcess::generations() const {
  const std::lock_guard lock(mutex_);
  return generations_;
}

void ViewerProcess::AskPin(const std::string& role) {
  process_.Ask({{"do", "pin"}, {"role", role}});
}
void ViewerProcess::Revoke(const std::string& lease) {
  Ask({{"do", "revoke"}, {"lease", lease}}, "No client holds a lease.");
}
void ViewerProcess::Kick(std::uint32_t client) {
  Renew(&Generations::pages, {{"do", "kick"}, {"client", client}},
        "Client " + std::to_string(client));
}
void ViewerProcess::KickFoxglove() {
  Renew(&Generations::watchers, {{"do", "kick foxglove"}}, "Foxglove");
}
void ViewerProcess::EndRun(const std::string& how, bool results_follow) {
  process_.Ask({{"do", "end"}, {"text", how}, {"results_follow", results_follow}});
}
void ViewerProcess::AskFoxglove() { process_.Ask({{"do", "foxglove"}}); }
void ViewerProcess::AskStatus() { process_.Ask({{"do", "status"}}); }

}  // namespace predictor::viewer
