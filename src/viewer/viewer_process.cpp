// The run's side of the viewer: what its process is told, and what a person may ask of it.
#include "viewer/viewer_process.h"

#include <pwd.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>

#include "core/error.h"
#include "process/attached_run.h"
#include "process/supervised_process.h"
#include "scenario/scenario_io.h"
#include "viewer/address.h"
#include "viewer/admission.h"
#include "viewer/leases.h"

namespace predictor {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr const char* kEverywhere = "0.0.0.0";

std::string AddressOf(const ViewerOptions& o) {
  if (!o.address.empty()) return o.address;
  return o.expose ? kEverywhere : kLoopback;
}

void Check(const ViewerOptions& options) {
  if (!IsAddress(AddressOf(options)))
    throw InputError("'" + options.address +
                     "' is no address: give one of this machine's in numbers, as 192.0.2.7.");
  if (!IsLoopback(AddressOf(options)) && !options.expose)
    throw InputError("The viewer's address " + options.address +
                     " can be reached from other machines. Allow that by --expose, or leave the "
                     "address at 127.0.0.1.");
  if (options.certificate.empty() != options.key.empty())
    throw InputError("A certificate and its key belong together: give both or none.");
}

// Where the certificate is kept; empty if none is needed.
std::filesystem::path StateFolderOf(const ViewerOptions& o) {
  if (!o.state_folder.empty() || !o.certificate.empty() || !(o.tls || o.expose))
    return o.state_folder;
  return StateFolder();
}

Json ToJson(const Scenario& scenario, const ViewerOptions& o) {
  Json line = RunLine(scenario, o.object_start);
  Json scenarios = Json::array();
  for (const ScenarioTitle& s : o.scenarios)
    scenarios.push_back({{"name", s.name}, {"title", s.title}});
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
               {"revoked", o.revoked},
               {"scenarios", scenarios},
               {"notice", o.notice}});
  return line;
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
        "There is no place for the page's certificate: set HOME or XDG_STATE_HOME to a folder of "
        "your own.");
  return std::filesystem::path(home) / ".local/state/predictor";
}

struct ViewerProcess::Impl {
  Impl(const Scenario& scenario, const ViewerOptions& options, int board, int mailbox, Tell t)
      : tell(std::move(t)),
        revoked(options.revoked),
        process({"The viewer",
                 kViewerSubcommand,
                 ToJson(scenario, options),
                 {board, mailbox},
                 tell,
                 [this](const Json& line) { Hear(line); }}) {}

  void Hear(const Json& line);

  Tell tell;
  mutable std::mutex mutex;  // of what follows
  std::string url, fingerprint;
  std::vector<std::string> revoked;

  SupervisedProcess process;  // uses the others
};

void ViewerProcess::Impl::Hear(const Json& line) {
  if (const std::string key = Text(line, "revoked"); !key.empty()) {
    const std::lock_guard lock(mutex);
    if (revoked.size() >= Admission::kMostRevoked || key.size() > Admission::kLongestKey) return;
    revoked.push_back(key);
    process.Remember("revoked", revoked);
  }
  const std::string address = Text(line, line.contains("ready") ? "ready" : "url");
  if (address.empty()) return;
  std::string where;
  {
    const std::lock_guard lock(mutex);
    url = address;
    if (line.contains("ready")) fingerprint = Text(line, "fingerprint");
    where = "Viewer: " + url;
    if (!fingerprint.empty()) where += "\n        certificate (SHA-256): " + fingerprint;
  }
  tell(where);
}

ViewerProcess::ViewerProcess(const Scenario& scenario, const ViewerOptions& options,
                             const Shared<RunBoard>& board, const Shared<RunMailbox>& mailbox,
                             Tell tell) {
  Check(options);
  impl_ = std::make_unique<Impl>(scenario, options, board.descriptor(), mailbox.descriptor(),
                                 std::move(tell));
}

ViewerProcess::~ViewerProcess() = default;

std::string ViewerProcess::url() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->url;
}

std::uint16_t ViewerProcess::port() const { return impl_->process.port(); }

std::string ViewerProcess::fingerprint() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->fingerprint;
}

std::vector<std::string> ViewerProcess::revoked() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->revoked;
}

int ViewerProcess::pid() const { return impl_->process.pid(); }

void ViewerProcess::AskPin(const std::string& role) {
  impl_->process.Ask({{"do", "pin"}, {"role", role}});
}
void ViewerProcess::Revoke(const std::string& lease) {
  impl_->process.Ask({{"do", "revoke"}, {"lease", lease}});
}
void ViewerProcess::Kick(std::uint32_t client) {
  impl_->process.Ask({{"do", "kick"}, {"client", client}});
}
void ViewerProcess::KickFoxglove() { impl_->process.Ask({{"do", "kick foxglove"}}); }
void ViewerProcess::EndRun(const std::string& how) {
  impl_->process.Ask({{"do", "end"}, {"text", how}});
}
void ViewerProcess::AskFoxglove() { impl_->process.Ask({{"do", "foxglove"}}); }
void ViewerProcess::AskStatus() { impl_->process.Ask({{"do", "status"}}); }

}  // namespace predictor
