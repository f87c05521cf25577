// The main function of the viewer's process, which may only serve pages and data.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <optional>

#include "process/attached_run.h"
#include "process/child.h"
#include "scenario/operating_rules.h"
#include "scenario/paths.h"
#include "viewer/address.h"
#include "viewer/certificate.h"
#include "viewer/generations_json.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"
#include "viewer/viewer_process.h"

namespace predictor::viewer {
namespace {

constexpr std::size_t kLongestCommand = 4096;  // longest command from the console [bytes]
// The time within which the viewer informs the pages that the run has ended.
constexpr std::chrono::milliseconds kFarewell{300};

// The names and addresses of the server, from the start message of the run's process.
struct Site {
  // `machine_names` is the result of MachineNames().
  Site(const Json& start, const std::vector<std::string>& machine_names)
      : tls(start["tls"]), address(start["address"].get<std::string>()), names(machine_names) {
    // A single certificate contains all names of this machine, so that users need to trust it only
    // once, regardless of the name that they use.
    std::vector<std::string> certified = names;
    if (IsLoopback(address)) names.resize(std::min<std::size_t>(names.size(), 3));
    std::vector<std::string> more = start["names"];
    if (address != "0.0.0.0" && address != "::") more.push_back(address);
    Add(more, &names);
    Add(names, &certified);
    options.address = address;
    options.port = start["port"];
    if (!tls) return;
    const std::string own = start["certificate"];
    certificate = own.empty()
                      ? SelfSignedCertificate(start["state_folder"].get<std::string>(), certified)
                      : ReadCertificate(own, start["key"].get<std::string>());
    if (!own.empty()) Add(certificate.names, &names);
    options.certificate_pem = certificate.certificate_pem;
    options.key_pem = certificate.key_pem;
  }
  static void Add(const std::vector<std::string>& more, std::vector<std::string>* to) {
    for (const std::string& name : more)
      if (std::find(to->begin(), to->end(), name) == to->end()) to->push_back(name);
  }
  // Returns the host that a person opens. If other machines may connect, this is the address under
  // which they reach this machine.
  std::string Host(std::uint16_t port) const {
    std::string host = "localhost";
    if (!IsLoopback(address)) {
      host = address;
      if (address == "0.0.0.0" || address == "::") {
        const auto seen = std::find_if(names.begin(), names.end(), [](const std::string& name) {
          return name.find_first_not_of("0123456789.") == std::string::npos &&
                 !name.starts_with("127.");
        });
        host = seen == names.end() ? "localhost" : *seen;
      }
    }
    if (host.find(':') != std::string::npos) host = "[" + host + "]";
    return host + ":" + std::to_string(port);
  }

  bool tls;
  std::string address;
  std::vector<std::string> names;
  Certificate certificate;
  ServerOptions options;
};

std::string StatusText(ViewerApp* app) {
  std::string text = "Viewer: " + std::to_string(app->hub().clients()) + " connected.";
  for (const ClientStatus& client : app->hub().Status()) {
    text += "\n  client " + std::to_string(client.id) + ", role " + Name(client.role);
    for (const LeaseKind kind : {LeaseKind::kControl, LeaseKind::kOperator})
      if (client.holds[static_cast<std::size_t>(kind)])
        text += std::string(", holds ") +
                (kind == LeaseKind::kControl ? "control" : "the operator's hands");
    if (client.headset) text += ", wears a headset";
    if (client.experimenter) text += ", sees the events to come";
    char line[80];
    std::snprintf(line, sizeof line, ": states received after %.1f ms, drawn after %.1f ms",
                  client.latency.received_ms, client.latency.rendered_ms);
    if (client.latency.received_ms > 0) text += line;
  }
  const std::size_t watching = app->foxglove().clients();
  if (watching > 0) text += "\n  Foxglove: " + std::to_string(watching) + " connected.";
  return text;
}

std::string PinText(const std::string& role, ViewerApp* app) {
  const auto named = RoleNamed(role);
  if (!named) return "The role of a pin must be one of: look, operator, control.";
  const std::string pin = app->admission().IssuePin(*named, MonotonicNow());
  return "Pin " + pin + " (" + role + "), valid for two minutes and for one client.";
}

// Returns the address at which a page is opened. The code in the fragment admits the client.
std::string UrlOf(const Site& site, const std::string& host, ViewerApp* app) {
  return std::string(site.tls ? "https://" : "http://") + host +
         "/#code=" + app->admission().code();
}

std::string Kick(const Json& line, ViewerApp* app) {
  const auto client = line.value("client", 0U);
  if (!app->hub().Kick(client, GenerationsOf(line["generations"])))
    return "There is no client " + std::to_string(client) +
           ". `status` lists the clients. Tokens of pages that are not connected have expired.";
  return "Client " + std::to_string(client) +
         " was disconnected, and its token is no longer valid.";
}

std::string KickFoxglove(const Json& line, ViewerApp* app) {
  app->admission().Renew(GenerationsOf(line["generations"]));
  const std::string ended = "Earlier addresses are no longer valid; `foxglove` creates a new one.";
  return (app->foxglove().Kick() == 0 ? "Foxglove was not connected. "
                                      : "Foxglove was disconnected. ") +
         ended;
}

std::string KickAll(const Json& line, ViewerApp* app) {
  app->hub().KickAll(GenerationsOf(line["generations"]));
  app->foxglove().Kick();
  return "All clients were disconnected, because one was removed while the viewer was starting.";
}

std::string Revoke(const std::string& name, ViewerApp* app) {
  const auto lease = LeaseNamed(name);
  if (!lease) return "A lease must be one of: control, operator.";
  app->hub().Revoke(*lease);
  return std::string("No one holds the lease ") + Name(*lease) + " now.";
}

// Executes a command of the console. The answer is a text for a person.
std::string Obey(const std::string& text, const Site& site, const std::string& host,
                 ViewerApp* app) {
  const Json line = Json::parse(text, nullptr, false);
  if (!line.is_object()) return "This request is not supported.";
  const std::string what = line.value("do", "");
  if (what == "pin") return PinText(line.value("role", ""), app);
  if (what == "foxglove")
    return "Foxglove: " + std::string(site.tls ? "wss://" : "ws://") + host +
           "/?token=" + app->admission().IssueWatchToken();
  if (what == "status") return StatusText(app);
  if (what == "kick") return Kick(line, app);
  if (what == "kick foxglove") return KickFoxglove(line, app);
  if (what == "kick all") return KickAll(line, app);
  if (what == "revoke") return Revoke(line.value("lease", ""), app);
  if (what == "end") {
    app->EndRun(line.value("text", "The run has ended."), line.value("results_follow", false));
    return "";
  }
  return "This request is not supported.";
}

// Returns the files that are read or made before the server starts, which are the models and the
// certificate.
Preparation PreparationOf(const Json& start) {
  Preparation may;
  may.listen = true;
  may.read = ModelFolders(start["folder"].get<std::string>());
  const std::string certificate = start["certificate"], folder = start["state_folder"];
  if (const std::string report = start["report"]; !report.empty()) may.read.emplace_back(report);
  if (!certificate.empty()) {
    may.read.emplace_back(certificate);
    may.read.emplace_back(start["key"].get<std::string>());
  } else if (start["tls"]) {
    MakeCertificateFolder(folder);
    may.write.emplace_back(folder);
  }
  return may;
}

// Returns "" if there is no report. If the result is empty, the page does not offer a report.
std::string ReadReport(const std::string& file) {
  if (file.empty()) return "";
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void Serve(const Json& start) {
  const std::vector<std::string> machine_names = MachineNames();
  InitialiseTls();
  Prepare(PreparationOf(start));
  AttachedRun run(start);
  Shared<RunMailbox> mailbox(kMailboxDescriptor, true);
  const Site site(start, machine_names);
  std::optional<const Shared<EvaluationBoard>> states;
  if (start["judged"]) states.emplace(kReadDescriptor, false);
  AppSetup setup;
  setup.states = states ? &**states : nullptr;
  setup.why_not_judged = start["why_not_judged"];
  setup.hosts = site.names;
  setup.tls = site.tls;
  setup.code_once =
      RulesFor(run.scenario).single_use_access_code && start["replay"]["duration"] == 0;
  setup.replay = start["replay"];
  setup.secret = start["secret"];
  setup.generations = GenerationsOf(start["generations"]);
  setup.last_client = start["last_client"];
  setup.scenarios = start["scenarios"];
  setup.notice = start["notice"];
  setup.results = start["results"];
  setup.report = ReadReport(start["report"]);
  setup.origins = start["foxglove_origins"].get<std::vector<std::string>>();
  setup.notify = [](const std::string& text) {
    SendLine(kControlDescriptor, {{"say", text}}, false);
  };
  ViewerApp app(setup, run.scenario, run.object_start, &*run.board, &*mailbox, MonotonicNow);
  Server server(site.options, &app);
  const std::string host = site.Host(server.port());
  GiveUpRights(start, "The viewer");
  server.Watch(
      kControlDescriptor, kLongestCommand,
      [&](const std::string& text) {
        const std::string code = app.admission().code();
        const std::string answer = Obey(text, site, host, &app);
        if (!answer.empty()) SendLine(kControlDescriptor, {{"say", answer}}, false);
        Json done = {{"done", true}};
        if (app.admission().code() != code) done["url"] = UrlOf(site, host, &app);
        SendLine(kControlDescriptor, done, false);
      },
      [&] { app.ended() ? server.Finish(kFarewell) : server.Stop(); });
  SendLine(kControlDescriptor,
           {{"ready", UrlOf(site, host, &app)},
            {"generations", ToJson(app.admission().generations())},
            {"port", server.port()},
            {"fingerprint", site.certificate.fingerprint}},
           false);
  server.Run();
}

}  // namespace

int ViewerMain() { return ChildMain("viewer", Serve); }

}  // namespace predictor::viewer
