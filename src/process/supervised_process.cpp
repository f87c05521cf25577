#include "process/supervised_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "process/attached_run.h"

namespace predictor {
namespace {

constexpr int kSafeDescriptor = 16;  // beyond those that are replaced
constexpr auto kStartTime = std::chrono::seconds(60);
constexpr auto kEndTime = std::chrono::seconds(2);
constexpr auto kFirstPause = std::chrono::milliseconds(500);  // before it is started again
constexpr auto kHealthy =
    std::chrono::seconds(60);  // after so long a life the pause is short again

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

// The few variables that such a process needs.
std::vector<std::string> Environment() {
  std::vector<std::string> variables;
  for (const char* name : {"PREDICTOR_PACKAGE_PATH", "LANG", "LC_ALL", "ASAN_OPTIONS",
                           "TSAN_OPTIONS", "UBSAN_OPTIONS"})
    if (const char* value = std::getenv(name)) variables.push_back(std::string(name) + "=" + value);
  return variables;
}

// Starts this program again, with these descriptors from kBoardDescriptor on (negative: none).
// Throws std::runtime_error.
pid_t Spawn(std::string subcommand, const std::array<int, 3>& descriptors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::vector<Descriptor> aside;  // none of the sources may be replaced before it is copied
  aside.reserve(descriptors.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const int child = kBoardDescriptor + static_cast<int>(i);
    if (descriptors[i] < 0) {
      posix_spawn_file_actions_addclose(&actions, child);
      continue;
    }
    aside.emplace_back(fcntl(descriptors[i], F_DUPFD_CLOEXEC, kSafeDescriptor));
    posix_spawn_file_actions_adddup2(&actions, aside.back().get(), child);
  }
  posix_spawn_file_actions_addclosefrom_np(&actions, kControlDescriptor + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // Ctrl-C at the terminal is for the run, which ends the process itself.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);

  std::string program = "predictor";
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
    throw std::runtime_error("`predictor " + subcommand +
                             "` cannot be started: " + std::strerror(error));
  return pid;
}

std::string HowItEnded(int status) {
  if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

std::string Text(const Json& line, const char* name) {
  const auto found = line.find(name);
  return found != line.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

struct SupervisedProcess::Impl {
  explicit Impl(ChildSetup s) : setup(std::move(s)), wake(eventfd(0, EFD_CLOEXEC)) {
    setup.start["parent"] = getpid();
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

  ChildSetup setup;
  Descriptor wake;
  LineReader lines;
  std::chrono::steady_clock::time_point born;
  std::chrono::milliseconds pause{kFirstPause};
  std::thread thread;

  mutable std::mutex mutex;  // of what follows, and of setup.start
  Descriptor control;
  pid_t pid = 0;
  bool ready = false;
  std::string error;
  std::uint16_t port = 0;
};

void SupervisedProcess::Impl::Start() {
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    throw std::runtime_error(setup.name + "'s process cannot be started: no socket.");
  Descriptor ours(pair[0]);
  const Descriptor theirs(pair[1]);
  const pid_t child = Spawn(setup.subcommand, {setup.board, setup.mailbox, theirs.get()});
  SendLine(ours.get(), setup.start, true);
  const std::lock_guard lock(mutex);
  control = std::move(ours);
  pid = child;
  ready = false;
  lines = {};
  born = std::chrono::steady_clock::now();
}

void SupervisedProcess::Impl::WaitUntilReady() {
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
                                    : setup.name + "'s process did not start (" + status +
                                          "). Run without it to go on.");
  }
}

// Until the process ends (true) or the run does (false).
bool SupervisedProcess::Impl::Listen() {
  for (;;) {
    pollfd wait[2] = {{control.get(), POLLIN, 0}, {wake.get(), POLLIN, 0}};
    if (poll(wait, 2, -1) < 0 && errno != EINTR) return false;
    if (wait[1].revents != 0) return false;
    if (wait[0].revents == 0) continue;
    if (!lines.Read(control.get())) return true;
    while (const auto line = lines.Next()) Hear(*line);
  }
}

// False if the run ends meanwhile.
bool SupervisedProcess::Impl::Pause(std::chrono::milliseconds time) {
  pollfd wait{wake.get(), POLLIN, 0};
  return poll(&wait, 1, static_cast<int>(time.count())) == 0;
}

void SupervisedProcess::Impl::Supervise() {
  while (Listen()) {
    const bool healthy = std::chrono::steady_clock::now() - born > kHealthy;
    const std::string how = HowItEnded(End());
    if (healthy) pause = kFirstPause;
    setup.tell(setup.name + " has ended (" + how + "); the run goes on. It is started again.");
    if (!Pause(pause)) return;
    pause = std::min(2 * pause, setup.longest_pause);
    try {
      Start();
    } catch (const std::exception& problem) {
      return setup.tell(problem.what());
    }
  }
}

// Ends the process if it still runs; returns its wait status.
int SupervisedProcess::Impl::End() {
  const std::lock_guard lock(mutex);
  control.Reset();  // the process ends when this does
  int status = 0;
  const auto patience = std::chrono::steady_clock::now() + kEndTime;
  while (pid > 0 && waitpid(pid, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience) kill(pid, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  pid = 0;
  return status;
}

// What it says is shown to a person and otherwise believed in nothing.
void SupervisedProcess::Impl::Hear(const Json& line) {
  if (line.contains("error")) {
    error = Text(line, "error");
    if (thread.joinable()) setup.tell(setup.name + ": " + error);
    return;
  }
  if (line.contains("say")) return setup.tell(Text(line, "say"));
  if (line.contains("ready")) {
    const std::lock_guard lock(mutex);
    const auto told = line.find("port");
    if (told != line.end() && told->is_number_unsigned() && *told <= UINT16_MAX)
      setup.start["port"] = port = told->get<std::uint16_t>();
    ready = true;
  }
  setup.hear(line);
}

SupervisedProcess::SupervisedProcess(ChildSetup setup)
    : impl_(std::make_unique<Impl>(std::move(setup))) {}
SupervisedProcess::~SupervisedProcess() = default;

int SupervisedProcess::pid() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ready ? impl_->pid : 0;
}

std::uint16_t SupervisedProcess::port() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->port;
}

void SupervisedProcess::Ask(const Json& line) {
  const std::lock_guard lock(impl_->mutex);
  SendLine(impl_->control.get(), line, false);
}

void SupervisedProcess::Remember(const std::string& key, const Json& value) {
  const std::lock_guard lock(impl_->mutex);
  impl_->setup.start[key] = value;
}

}  // namespace predictor
