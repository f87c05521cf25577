// The viewer's side: a process that can do nothing but serve.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include "process/attached_run.h"
#include "process/child.h"
#include "viewer/address.h"
#include "viewer/certificate.h"
#include "viewer/scene_description.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"
#include "viewer/viewer_process.h"

namespace predictor {
namespace {

constexpr std::size_t kLongestCommand = 4096;        // of the console [bytes]
constexpr std::chrono::milliseconds kFarewell{300};  // for the pages to hear that the run has ended

// How the server is called and reached, out of what the run said.
struct Site {
  explicit Site(const Json& start)
      : tls(start["tls"]), address(start["address"].get<std::string>()), names(MachineNames()) {
    // One certificate with all of this machine's names, however it is served: whoever trusts it
    // once need not do so again.
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
  // What a person opens: the address of this machine that others see, if any may.
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
  if (!named) return "A pin is for one of: look, operator, control.";
  const std::string pin = app->admission().IssuePin(*named, MonotonicNow());
  return "Pin " + pin + " (" + role + "), good for two minutes and one client.";
}

// Where a page is opened: the code in the fragment admits.
std::string UrlOf(const Site& site, const std::string& host, ViewerApp* app) {
  return std::string(site.tls ? "https://" : "http://") + host +
         "/#code=" + app->admission().code();
}

// The run keeps what is revoked, for the next process.
void TellRevoked(const std::string& key, const Site& site, const std::string& host,
                 ViewerApp* app) {
  SendLine(kControlDescriptor, {{"revoked", key}, {"url", UrlOf(site, host, app)}}, false);
}

std::string Kick(std::uint32_t client, const Site& site, const std::string& host, ViewerApp* app) {
  const std::optional<std::string> key = app->hub().Kick(client);
  if (!key) return "There is no client " + std::to_string(client) + ": `status` tells who is in.";
  TellRevoked(*key, site, host, app);
  return "Client " + std::to_string(client) + " is out, and its token is worth nothing any more.";
}

std::string KickFoxglove(const Site& site, const std::string& host, ViewerApp* app) {
  const std::vector<std::string> tokens = app->foxglove().Kick();
  for (const std::string& token : tokens)
    TellRevoked(app->admission().Revoke(token), site, host, app);
  app->hub().RenewTokens();
  if (tokens.empty()) return "No Foxglove is connected.";
  return "Foxglove is out; its address is worth nothing any more. `foxglove` gives another.";
}

// What the console asks for; the answer is for a person.
std::string Obey(const std::string& text, const Site& site, const std::string& host,
                 ViewerApp* app) {
  const Json line = Json::parse(text, nullptr, false);
  if (!line.is_object()) return "This is not understood.";
  const std::string what = line.value("do", "");
  if (what == "pin") return PinText(line.value("role", ""), app);
  if (what == "foxglove")
    return "Foxglove: " + std::string(site.tls ? "wss://" : "ws://") + host +
           "/?token=" + app->admission().IssueWatchToken();
  if (what == "status") return StatusText(app);
  if (what == "kick") return Kick(line.value("client", 0U), site, host, app);
  if (what == "kick foxglove") return KickFoxglove(site, host, app);
  if (what == "end") {
    app->EndRun(line.value("text", "The run has ended."));
    return "";
  }
  if (what == "revoke") {
    const auto lease = LeaseNamed(line.value("lease", ""));
    if (!lease) return "A lease is one of: control, operator.";
    app->hub().Revoke(*lease);
    return std::string("Nobody holds the lease ") + Name(*lease) + " now.";
  }
  return "This is not understood.";
}

void Serve(const Json& start) {
  AttachedRun run(start);
  Shared<RunMailbox> mailbox(kMailboxDescriptor, true);
  const Site site(start);
  AppSetup setup;
  setup.hosts = site.names;
  setup.tls = site.tls;
  setup.code_once = run.scenario.HasRealArms() && start["replay"]["duration"] == 0;
  setup.replay = start["replay"];
  setup.secret = start["secret"];
  setup.revoked = start["revoked"].get<std::vector<std::string>>();
  setup.scenarios = start["scenarios"];
  setup.notice = start["notice"];
  setup.origins = start["foxglove_origins"].get<std::vector<std::string>>();
  setup.tell = [](const std::string& text) {
    SendLine(kControlDescriptor, {{"say", text}}, false);
  };
  ViewerApp app(setup, run.scenario, run.object_start, &*run.board, &*mailbox, MonotonicNow);
  Server server(site.options, &app);
  const std::string host = site.Host(server.port());
  GiveUpRights(start, "The viewer");
  server.Watch(
      kControlDescriptor, kLongestCommand,
      [&](const std::string& text) {
        const std::string answer = Obey(text, site, host, &app);
        if (!answer.empty()) SendLine(kControlDescriptor, {{"say", answer}}, false);
      },
      [&] { app.ended() ? server.Finish(kFarewell) : server.Stop(); });
  SendLine(kControlDescriptor,
           {{"ready", UrlOf(site, host, &app)},
            {"port", server.port()},
            {"fingerprint", site.certificate.fingerprint}},
           false);
  server.Run();
}

}  // namespace

int ViewerMain() { return ChildMain("viewer", Serve); }

}  // namespace predictor
