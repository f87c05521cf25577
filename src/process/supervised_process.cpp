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

#include "core/contained_thread.h"
#include "core/error.h"
#include "core/heartbeat.h"
#include "process/attached_run.h"
#include "process/said.h"

namespace predictor {
namespace {

constexpr int kSafeDescriptor = 16;  // lies above the descriptors that are replaced
constexpr auto kStartTime = std::chrono::seconds(60);
constexpr auto kEndTime = std::chrono::seconds(2);
constexpr auto kFirstPause = std::chrono::milliseconds(500);  // before the first restart
constexpr auto kHealthy =
    std::chrono::seconds(60);  // after running this long, the next pause is short again
constexpr auto kLook = std::chrono::milliseconds(50);  // interval between checks for signs of life
constexpr double kSilent = 0.3, kDead = 1;  // silence after which it is reported, or the process is
                                            // ended [s]

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

// Returns the few environment variables that a process alongside the run needs.
std::vector<std::string> Environment() {
  std::vector<std::string> variables;
  // LD_PRELOAD is passed on, because a library that replaces the clocks
  // (tests/support/slow_clock.cpp) must do so in all processes.
  for (const char* name :
       {"PREDICTOR_PACKAGE_PATH", "LANG", "LC_ALL", "LD_PRELOAD", "PREDICTOR_REAL_TIME",
        "LSLAPICFG", "ASAN_OPTIONS", "TSAN_OPTIONS", "UBSAN_OPTIONS"})
    if (const char* value = std::getenv(name)) variables.push_back(std::string(name) + "=" + value);
  return variables;
}

// Starts this program again. The process inherits these descriptors, numbered from kBoardDescriptor
// (a negative one is omitted). Throws std::runtime_error.
pid_t Spawn(std::string subcommand, const std::array<int, 5>& descriptors) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::vector<Descriptor> aside;  // copies, so that no source is replaced before it is used
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
  posix_spawn_file_actions_addclosefrom_np(&actions, kStreamDescriptor + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // Ctrl-C at the terminal is meant for the run, so this process does not receive the signal. The
  // run then ends the process.
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
                             "` could not be started: " + std::strerror(error));
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
  explicit Impl(ChildSetup s)
      : setup(std::move(s)), said(setup.name), wake(eventfd(0, EFD_CLOEXEC)) {
    setup.start["parent"] = getpid();
    pause = std::min(kFirstPause, setup.longest_pause);
    Start();
    WaitUntilReady();
    supervised = true;
    thread = std::thread([this] { Supervise(); });
  }
  ~Impl() {
    const std::uint64_t one = 1;
    if (write(wake.get(), &one, sizeof one) == sizeof one && thread.joinable()) thread.join();
    Reap();
  }

  void Start();
  void WaitUntilReady();
  enum class End { kOfTheRun, kOfTheProcess, kBySilence };
  void Supervise() noexcept;
  void Attend();
  void StartAgain();
  End Listen();
  bool IsAlive();
  bool Pause(std::chrono::milliseconds time);
  int Reap();
  void Hear(const Json& line);

  ChildSetup setup;
  SaidFilter said;
  Descriptor wake;
  LineReader lines;
  std::chrono::steady_clock::time_point born;
  std::chrono::milliseconds pause{kFirstPause};
  Heartbeat heartbeat;
  bool silent = false;      // the silence has been reported
  bool supervised = false;  // by a separate thread; set before it starts
  bool over = false;        // the run has ended
  std::string error;
  std::thread thread;

  mutable std::mutex mutex;  // protects the members below and setup.start
  Descriptor control;
  pid_t pid = 0;
  bool ready = false;
  std::uint16_t port = 0;
};

void SupervisedProcess::Impl::Start() {
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    throw std::runtime_error(setup.name + "'s process could not be started: no socket.");
  Descriptor ours(pair[0]);
  const Descriptor theirs(pair[1]);
  Json start;
  {
    const std::lock_guard lock(mutex);
    start = setup.start;
  }
  const pid_t child = Spawn(setup.subcommand,
                            {setup.board, setup.mailbox, theirs.get(), setup.reads, setup.streams});
  SendLine(ours.get(), start, true);
  heartbeat = {};
  silent = false;
  error.clear();
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
    const std::string status = HowItEnded(Reap());
    throw InputError(!error.empty() ? error
                                    : setup.name + "'s process did not start (" + status +
                                          "). To continue, start the run without this process.");
  }
}

// Returns false if the process has shown no sign of life, or has not become ready, for too long.
bool SupervisedProcess::Impl::IsAlive() {
  const auto now = std::chrono::steady_clock::now();
  if (!ready) return now - born < kStartTime;
  if (!setup.beats) return true;
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now.time_since_epoch());
  const double silence = heartbeat.Silence(setup.beats->load(std::memory_order_acquire),
                                           static_cast<std::uint64_t>(ns.count()));
  if (silence > kSilent && !silent)
    setup.notify(setup.name + " does not respond: " + setup.without +
                 ". Close other programs on this computer.");
  if (silence < kSilent && silent) setup.notify(setup.name + " responds again.");
  silent = silence > kSilent;
  return silence < kDead;
}

// Returns when the run or the process ends, or when the process is silent for too long.
SupervisedProcess::Impl::End SupervisedProcess::Impl::Listen() {
  for (;;) {
    pollfd wait[2] = {{control.get(), POLLIN, 0}, {wake.get(), POLLIN, 0}};
    const bool looks = setup.beats || !ready;
    if (poll(wait, 2, looks ? static_cast<int>(kLook.count()) : -1) < 0 && errno != EINTR)
      throw std::runtime_error(std::string("poll: ") + std::strerror(errno));
    if (wait[1].revents != 0) return End::kOfTheRun;
    if (!IsAlive()) return End::kBySilence;
    if (wait[0].revents == 0) continue;
    if (!lines.Read(control.get())) return End::kOfTheProcess;
    while (const auto line = lines.Next()) Hear(*line);
  }
}

// Waits for `time`. Returns false if the run ends during the pause.
bool SupervisedProcess::Impl::Pause(std::chrono::milliseconds time) {
  pollfd wait{wake.get(), POLLIN, 0};
  if (poll(&wait, 1, static_cast<int>(time.count())) < 0) std::this_thread::sleep_for(time);
  return wait.revents == 0;
}

// This function returns when the run ends. It reports errors and starts the process again.
void SupervisedProcess::Impl::Supervise() noexcept {
  pthread_setname_np(pthread_self(), "supervisor");
  while (!over) {
    Contain([this] { Attend(); },
            [this](const char* why) {
              setup.notify(setup.name + ": " + why + ". Supervision continues.");
            });
    over = over || !Pause(kLook);
  }
}

void SupervisedProcess::Impl::Attend() {
  while (!over) {
    if (pid == 0) {
      StartAgain();
      continue;
    }
    const End end = Listen();
    over = end == End::kOfTheRun;
    if (over) return;
    if (std::chrono::steady_clock::now() - born > kHealthy)
      pause = std::min(kFirstPause, setup.longest_pause);
    if (end == End::kBySilence) kill(pid, SIGKILL);
    const std::string how = HowItEnded(Reap());
    setup.notify(
        setup.name +
        (end == End::kBySilence ? " did not respond and was ended" : " has ended (" + how + ")") +
        "; " + setup.without + ". It is being restarted.");
  }
}

void SupervisedProcess::Impl::StartAgain() {
  over = !Pause(pause);
  if (over) return;
  pause = std::min(2 * pause, setup.longest_pause);
  Start();
}

// Ends the process if it is still running. Returns the wait status of the process. Concurrent calls
// of Ask do not block meanwhile.
int SupervisedProcess::Impl::Reap() {
  pid_t child = 0;
  {
    const std::lock_guard lock(mutex);
    control.Reset();  // closing it ends the process
    ready = false;
    child = std::exchange(pid, 0);
  }
  int status = 0;
  const auto patience = std::chrono::steady_clock::now() + kEndTime;
  while (child > 0 && waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience) kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return status;
}

// The messages of the process are only shown to the user, and nothing else depends on them.
void SupervisedProcess::Impl::Hear(const Json& line) {
  if (line.contains("error")) {
    error = SaidFilter::Shortened(Text(line, "error"));
    if (supervised) setup.notify(setup.name + ": " + error);
    return;
  }
  if (line.contains("say")) {
    for (const std::string& text : said.Take(Text(line, "say"), std::chrono::steady_clock::now()))
      setup.notify(text);
    return;
  }
  if (line.contains("ready")) {
    const std::lock_guard lock(mutex);
    const auto reported = line.find("port");
    if (reported != line.end() && reported->is_number_unsigned() && *reported <= UINT16_MAX)
      setup.start["port"] = port = reported->get<std::uint16_t>();
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

bool SupervisedProcess::Ask(const Json& line) {
  const std::lock_guard lock(impl_->mutex);
  return SendLine(impl_->control.get(), line, false);
}

void SupervisedProcess::Kill() {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->pid > 0) kill(impl_->pid, SIGKILL);
}

void SupervisedProcess::Remember(const std::string& key, const Json& value) {
  const std::lock_guard lock(impl_->mutex);
  impl_->setup.start[key] = value;
}

}  // namespace predictor
