// The run's side: starts the viewer's process, listens to it, starts it again if it dies.
#include "viewer/viewer_process.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "core/error.h"
#include "scenario/scenario_io.h"
#include "viewer/admission.h"
#include "viewer/control_channel.h"
#include "viewer/leases.h"

namespace predictor {
namespace {

constexpr int kFirstDescriptor = 3;  // of the board; then the mailbox, then the control channel
constexpr int kSafeDescriptor = 16;  // beyond those that are replaced
constexpr auto kStartTime = std::chrono::seconds(60);
constexpr auto kEndTime = std::chrono::seconds(2);
constexpr auto kFirstPause = std::chrono::milliseconds(500);  // before it is started again
constexpr auto kLongestPause = std::chrono::seconds(60);
constexpr auto kHealthy =
    std::chrono::seconds(60);  // after so long a life the pause is short again

bool IsLoopback(const std::string& address) {
  in_addr v4;
  in6_addr v6;
  if (inet_pton(AF_INET, address.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == 127;
  return inet_pton(AF_INET6, address.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

void Check(const ViewerOptions& options) {
  if (!IsLoopback(options.address) && !options.expose)
    throw InputError("The viewer's address " + options.address +
                     " can be reached from other machines. Allow that by --expose, or leave the "
                     "address at 127.0.0.1.");
  if (options.certificate.empty() != options.key.empty())
    throw InputError("A certificate and its key belong together: give both or none.");
}

Json ToJson(const Scenario& scenario, const ViewerOptions& o) {
  const Vector3& p = o.object_start;
  Json scenarios = Json::array();
  for (const ScenarioTitle& s : o.scenarios)
    scenarios.push_back({{"name", s.name}, {"title", s.title}});
  return {{"parent", getpid()},
          {"scenario", SaveScenario(scenario)},
          {"file", scenario.file.filename().string()},
          {"folder", std::filesystem::absolute(scenario.file).parent_path().string()},
          {"address", o.address},
          {"port", o.port},
          {"tls", o.tls || o.expose},
          {"certificate", o.certificate.string()},
          {"key", o.key.string()},
          {"state_folder", (o.state_folder.empty() ? StateFolder() : o.state_folder).string()},
          {"names", o.names},
          {"foxglove_origins", o.foxglove_origins},
          {"recording", o.recording},
          {"secret", o.secret.empty() ? NewAdmissionSecret() : o.secret},
          {"scenarios", scenarios},
          {"notice", o.notice},
          {"object_start", {p.x(), p.y(), p.z()}}};
}

// Owns a descriptor.
class Descriptor {
 public:
  explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
  ~Descriptor() { Reset(); }
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    Reset();
    descriptor_ = std::exchange(other.descriptor_, -1);
    return *this;
  }
  int get() const { return descriptor_; }
  void Reset() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }

 private:
  int descriptor_;
};

// The few variables that the viewer needs.
std::vector<std::string> Environment() {
  std::vector<std::string> variables;
  for (const char* name : {"PREDICTOR_PACKAGE_PATH", "LANG", "LC_ALL", "ASAN_OPTIONS",
                           "TSAN_OPTIONS", "UBSAN_OPTIONS"})
    if (const char* value = std::getenv(name)) variables.push_back(std::string(name) + "=" + value);
  return variables;
}

// Starts this program again as the viewer. By posix_spawn, which never copies the run's memory: a
// fork would make each of its pages fault once, in the loop too. Throws std::runtime_error.
pid_t Spawn(const std::array<int, 3>& descriptors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::vector<Descriptor> aside;  // none of the sources may be replaced before it is copied
  aside.reserve(descriptors.size());
  for (const int descriptor : descriptors)
    aside.emplace_back(fcntl(descriptor, F_DUPFD_CLOEXEC, kSafeDescriptor));
  for (std::size_t i = 0; i < aside.size(); ++i)
    posix_spawn_file_actions_adddup2(&actions, aside[i].get(),
                                     kFirstDescriptor + static_cast<int>(i));
  posix_spawn_file_actions_addclosefrom_np(&actions, kFirstDescriptor + 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // Ctrl-C at the terminal is for the run, which ends the viewer itself.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);

  std::string program = "predictor", subcommand = kViewerSubcommand;
  char* arguments[] = {program.data(), subcommand.data(), nullptr};
  std::vector<std::string> variables = Environment();
  std::vector<char*> environment;
  environment.reserve(variables.size() + 1);
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);
  pid_t pid = 0;
  const int error =
      posix_spawn(&pid, "/proc/self/exe", &actions, &attributes, arguments, environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw std::runtime_error(std::string("The viewer's process cannot be started: ") +
                             std::strerror(error));
  return pid;
}

std::string HowItEnded(int status) {
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::filesystem::path StateFolder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && state[0] == '/') return std::filesystem::path(state) / "predictor";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home != nullptr ? home : "/tmp") / ".local/state/predictor";
}

struct ViewerProcess::Impl {
  Impl(const Scenario& scenario, const ViewerOptions& options, int board, int mailbox, Tell t)
      : start(ToJson(scenario, options)),
        descriptors{board, mailbox},
        tell(std::move(t)),
        wake(eventfd(0, EFD_CLOEXEC)) {
    Start();
    WaitUntilReady();
    thread = std::thread([this] { Supervise(); });
  }
  ~Impl() {
    const std::uint64_t one = 1;
    if (write(wake.get(), &one, sizeof one) == sizeof one && thread.joinable()) thread.join();
    End();
  }

  void Start();
  void WaitUntilReady();
  void Supervise();
  bool Listen();
  bool Pause(std::chrono::milliseconds time);
  int End();
  void Hear(const Json& line);
  void Ask(const Json& line) {
    const std::lock_guard lock(mutex);
    SendLine(control.get(), line, false);
  }

  Json start;
  std::array<int, 2> descriptors;
  Tell tell;
  Descriptor wake;
  LineReader lines;
  std::chrono::steady_clock::time_point born;
  std::chrono::milliseconds pause{kFirstPause};
  std::thread thread;

  mutable std::mutex mutex;  // of what follows
  Descriptor control;
  pid_t pid = 0;
  bool ready = false;
  std::string url, fingerprint, error;
  std::uint16_t port = 0;
};

void ViewerProcess::Impl::Start() {
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    throw std::runtime_error("The viewer's process cannot be started: no socket.");
  Descriptor ours(pair[0]);
  const Descriptor theirs(pair[1]);
  const pid_t child = Spawn({descriptors[0], descriptors[1], theirs.get()});
  SendLine(ours.get(), start, true);
  const std::lock_guard lock(mutex);
  control = std::move(ours);
  pid = child;
  ready = false;
  lines = {};
  born = std::chrono::steady_clock::now();
}

void ViewerProcess::Impl::WaitUntilReady() {
  const auto end = std::chrono::steady_clock::now() + kStartTime;
  while (!ready) {
    pollfd wait{control.get(), POLLIN, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    const bool in_time = left.count() > 0 && poll(&wait, 1, static_cast<int>(left.count())) > 0;
    if (in_time && lines.Read(control.get())) {
      while (const auto line = lines.Next()) Hear(*line);
      continue;
    }
    const std::string status = HowItEnded(End());
    throw InputError(!error.empty() ? error
                                    : "The viewer's process did not start (" + status +
                                          "). Run without the viewer to go on.");
  }
}

// Until the viewer ends (true) or the run does (false).
bool ViewerProcess::Impl::Listen() {
  for (;;) {
    pollfd wait[] = {{control.get(), POLLIN, 0}, {wake.get(), POLLIN, 0}};
    if (poll(wait, 2, -1) < 0 && errno != EINTR) return false;
    if (wait[1].revents != 0) return false;
    if (wait[0].revents == 0) continue;
    if (!lines.Read(control.get())) return true;
    while (const auto line = lines.Next()) Hear(*line);
  }
}

// False if the run ends meanwhile.
bool ViewerProcess::Impl::Pause(std::chrono::milliseconds time) {
  pollfd wait{wake.get(), POLLIN, 0};
  return poll(&wait, 1, static_cast<int>(time.count())) == 0;
}

void ViewerProcess::Impl::Supervise() {
  while (Listen()) {
    const bool healthy = std::chrono::steady_clock::now() - born > kHealthy;
    const std::string how = HowItEnded(End());
    if (healthy) pause = kFirstPause;
    tell("The viewer has ended (" + how + "); the run goes on. It is started again.");
    if (!Pause(pause)) return;
    pause = std::min<std::chrono::milliseconds>(2 * pause, kLongestPause);
    try {
      start["port"] = port;
      Start();
    } catch (const std::exception& problem) {
      return tell(problem.what());
    }
  }
}

// Ends the process if it still runs; returns its wait status.
int ViewerProcess::Impl::End() {
  const std::lock_guard lock(mutex);
  control.Reset();  // the viewer ends when this does
  int status = 0;
  const auto patience = std::chrono::steady_clock::now() + kEndTime;
  while (pid > 0 && waitpid(pid, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience) kill(pid, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  pid = 0;
  return status;
}

// What the viewer says is shown to a person and otherwise believed in nothing.
void ViewerProcess::Impl::Hear(const Json& line) {
  const auto text = [&line](const char* name) {
    const auto found = line.find(name);
    return found != line.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  if (line.contains("error")) {
    error = text("error");
    if (thread.joinable()) tell("The viewer: " + error);
  } else if (line.contains("ready")) {
    std::string where;
    {
      const std::lock_guard lock(mutex);
      url = text("ready");
      fingerprint = text("fingerprint");
      if (line.contains("port") && line["port"].is_number_unsigned())
        port = line["port"].get<std::uint16_t>();
      ready = true;
      where = "Viewer: " + url;
      if (!fingerprint.empty()) where += "\n        certificate (SHA-256): " + fingerprint;
    }
    tell(where);
  } else if (line.contains("say")) {
    tell(text("say"));
  }
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

std::uint16_t ViewerProcess::port() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->port;
}

std::string ViewerProcess::fingerprint() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->fingerprint;
}

int ViewerProcess::pid() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ready ? impl_->pid : 0;
}

void ViewerProcess::AskPin(const std::string& role) { impl_->Ask({{"do", "pin"}, {"role", role}}); }
void ViewerProcess::Revoke(const std::string& lease) {
  impl_->Ask({{"do", "revoke"}, {"lease", lease}});
}
void ViewerProcess::AskFoxglove() { impl_->Ask({{"do", "foxglove"}}); }
void ViewerProcess::AskStatus() { impl_->Ask({{"do", "status"}}); }

}  // namespace predictor
