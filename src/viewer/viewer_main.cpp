// The viewer's side: a process that can do nothing but serve.
#include <fcntl.h>
#include <grp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "core/error.h"
#include "scenario/scenario_io.h"
#include "viewer/certificate.h"
#include "viewer/control_channel.h"
#include "viewer/scene_description.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"
#include "viewer/viewer_process.h"

namespace predictor {
namespace {

enum : int { kBoard = 3, kMailbox = 4, kControl = 5 };  // descriptors
enum : int { kEnded = 0, kBadInput = 2, kFailed = 3 };  // exit codes

constexpr uid_t kNobody = 65534;
constexpr rlim_t kMostMemory = 3ul << 30;  // address space [bytes]
constexpr rlim_t kMostDescriptors = 512;
constexpr std::size_t kLongestCommand = 4096;  // of the console [bytes]

void Limit(int resource, rlim_t most) {
  const rlimit limit{most, most};
  if (setrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0)
    throw std::runtime_error("The viewer cannot limit itself.");
}

// Ends with the run, however that ends. (The kernel forgets it when the user changes.)
void DieWithParent(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) std::_Exit(kEnded);
}

// Before anything is read.
void LimitResources() {
  prctl(PR_SET_NAME, "viewer");
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_DUMPABLE, 0);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_NOFILE, kMostDescriptors);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  Limit(RLIMIT_AS, kMostMemory);
#endif
}

// When all is read and the port is open: no user, no files, no processes.
void DropPrivileges() {
  if (geteuid() == 0 && (setgroups(0, nullptr) != 0 || setresgid(kNobody, kNobody, kNobody) != 0 ||
                         setresuid(kNobody, kNobody, kNobody) != 0))
    throw std::runtime_error("The viewer cannot give up its rights as root.");
  Limit(RLIMIT_FSIZE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  Limit(RLIMIT_NPROC, 0);
#endif
}

Json ReadStart() {
  LineReader lines;
  for (;;) {
    if (const auto line = lines.Next()) return *line;
    if (!lines.Read(kControl)) std::_Exit(kEnded);
  }
}

bool IsLoopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.");
}

// How the server is called and reached, out of what the run said.
struct Site {
  explicit Site(const Json& start)
      : tls(start["tls"]), address(start["address"].get<std::string>()) {
    names = MachineNames();
    if (IsLoopback(address)) names.resize(std::min<std::size_t>(names.size(), 3));
    for (const std::string& name : start["names"].get<std::vector<std::string>>()) Add(name);
    if (address != "0.0.0.0" && address != "::") Add(address);
    options.address = address;
    options.port = start["port"];
    if (!tls) return;
    const std::string own = start["certificate"];
    certificate = own.empty()
                      ? SelfSignedCertificate(start["state_folder"].get<std::string>(), names)
                      : ReadCertificate(own, start["key"].get<std::string>());
    for (const std::string& name : certificate.names) Add(name);
    options.certificate_pem = certificate.certificate_pem;
    options.key_pem = certificate.key_pem;
  }
  void Add(const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
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
  for (const ClientLatency& client : app->hub().latencies()) {
    char line[128];
    std::snprintf(line, sizeof line,
                  "\n  client %u: received after %.1f ms, rendered after %.1f ms", client.client,
                  client.latency.received_ms, client.latency.rendered_ms);
    text += line;
  }
  return text;
}

std::string PinText(const std::string& role, ViewerApp* app) {
  const auto named = RoleNamed(role);
  if (!named) return "A pin is for one of: look, operator, control.";
  const std::string pin = app->admission().IssuePin(*named, MonotonicNow());
  return "Pin " + pin + " (" + role + "), good for two minutes and one client.";
}

// What the console asks for; the answer is for a person.
std::string Obey(const std::string& text, const std::string& host, bool tls, ViewerApp* app) {
  const Json line = Json::parse(text, nullptr, false);
  if (!line.is_object()) return "This is not understood.";
  const std::string what = line.value("do", "");
  if (what == "pin") return PinText(line.value("role", ""), app);
  if (what == "foxglove")
    return "Foxglove: " + std::string(tls ? "wss://" : "ws://") + host +
           "/?token=" + app->admission().IssueToken(Role::kLook);
  if (what == "status") return StatusText(app);
  if (what == "revoke") {
    const auto lease = LeaseNamed(line.value("lease", ""));
    if (!lease) return "A lease is one of: control, operator.";
    app->hub().Revoke(*lease);
    return std::string("Nobody holds the lease ") + Name(*lease) + " now.";
  }
  return "This is not understood.";
}

Vector3 ToVector(const Json& list) {
  return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

int Serve(const Json& start) {
  const Shared<RunBoard> board(kBoard, false);
  Shared<RunMailbox> mailbox(kMailbox, true);
  if ((*board).magic != RunBoard::kMagic || (*board).bytes != sizeof(RunBoard))
    throw std::runtime_error("The shared memory is not that of this version's run.");
  const Scenario scenario =
      ParseScenario(start["scenario"], start["file"], start["folder"].get<std::string>());
  const Site site(start);
  AppSetup setup;
  setup.hosts = site.names;
  setup.tls = site.tls;
  setup.code_once = !IsSimulated(scenario);
  setup.recording = start["recording"];
  setup.secret = start["secret"];
  setup.scenarios = start["scenarios"];
  setup.notice = start["notice"];
  setup.origins = start["foxglove_origins"].get<std::vector<std::string>>();
  ViewerApp app(setup, scenario, ToVector(start["object_start"]), &*board, &*mailbox, MonotonicNow);
  Server server(site.options, &app);
  const std::string host = site.Host(server.port());
  DropPrivileges();
  DieWithParent(start["parent"]);
  server.Watch(
      kControl, kLongestCommand,
      [&](const std::string& text) {
        SendLine(kControl, {{"say", Obey(text, host, site.tls, &app)}}, false);
      },
      [&server] { server.Stop(); });
  SendLine(kControl,
           {{"ready", std::string(site.tls ? "https://" : "http://") + host +
                          "/#code=" + app.admission().code()},
            {"port", server.port()},
            {"fingerprint", site.certificate.fingerprint}},
           false);
  server.Run();
  return kEnded;
}

}  // namespace

int ViewerMain() {
  try {
    const Json start = ReadStart();
    DieWithParent(start["parent"]);
    LimitResources();
    return Serve(start);
  } catch (const InputError& error) {
    SendLine(kControl, {{"error", error.what()}}, false);
    return kBadInput;
  } catch (const std::exception& error) {
    SendLine(kControl, {{"error", error.what()}}, false);
    return kFailed;
  }
}

}  // namespace predictor
