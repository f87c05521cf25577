#include "simulation/shared_process.h"

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

constexpr int kMemoryDescriptor = 3;  // in the program
constexpr int kSafeDescriptor = 16;   // above those that are replaced
constexpr auto kEndPause = std::chrono::milliseconds(1);

[[noreturn]] void Refuse(const std::string& key, const std::string& why) {
  throw InputError::At(key, key + why);
}

// The memory is anonymous, and the program inherits it. Returns its descriptor.
int NewMemory(const std::string& key, std::size_t size) {
  const int made = memfd_create("predictor", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  const int descriptor = made < 0 ? -1 : fcntl(made, F_DUPFD_CLOEXEC, kSafeDescriptor);
  if (made >= 0) close(made);
  // The size of the memory is sealed, because the control loop would crash if the program shortened
  // the memory.
  if (descriptor >= 0 && ftruncate(descriptor, static_cast<off_t>(size)) == 0 &&
      fcntl(descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0)
    return descriptor;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  Refuse(key, std::string(": no shared memory: ") + std::strerror(error) + ".");
}

// Returns the number of the error, or 0 if there is no error.
int Spawn(const std::vector<std::string>& command, const std::filesystem::path& folder, int memory,
          pid_t* pid) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, memory, kMemoryDescriptor);
  posix_spawn_file_actions_addclosefrom_np(&actions, kMemoryDescriptor + 1);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // Ctrl-C at the terminal must reach only the emulator, which then ends the program itself.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
  const int error =
      posix_spawnp(pid, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

SharedProcess::SharedProcess(std::string key, std::size_t size)
    : key_(std::move(key)), size_(size), descriptor_(NewMemory(key_, size)) {
  memory_ = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, descriptor_, 0);
  if (memory_ != MAP_FAILED) return;
  const int error = errno;
  close(descriptor_);
  Refuse(key_, std::string(": no shared memory: ") + std::strerror(error) + ".");
}

SharedProcess::~SharedProcess() {
  End(0);
  if (descriptor_ >= 0) close(descriptor_);
  munmap(memory_, size_);
}

void SharedProcess::Start(const std::vector<std::string>& command,
                          const std::filesystem::path& folder, const std::string& remedy) {
  const int error = Spawn(command, folder, descriptor_, &pid_);
  close(descriptor_);
  descriptor_ = -1;
  if (error == 0) {
    ended_ = false;
    return;
  }
  Refuse(key_, ": " + Quote(command[0]) + " could not be started in " +
                   std::filesystem::absolute(folder).lexically_normal().string() + ": " +
                   std::strerror(error) + ". " + remedy);
}

int SharedProcess::SetPriority(int priority) noexcept {
  if (HasEnded()) return ESRCH;
  sched_param parameter{};
  parameter.sched_priority = priority;
  const int policy = priority > 0 ? SCHED_FIFO : SCHED_OTHER;
  return sched_setscheduler(pid_, policy | SCHED_RESET_ON_FORK, &parameter) == 0 ? 0 : errno;
}

bool SharedProcess::HasEnded() noexcept {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return ended_;
}

void SharedProcess::End(double patience) noexcept {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  while (!HasEnded() && std::chrono::duration<double>(Clock::now() - start).count() < patience)
    std::this_thread::sleep_for(kEndPause);
  if (ended_) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, &status_, 0);
  ended_ = true;
}

std::string SharedProcess::HowItEnded() noexcept {
  if (!HasEnded()) return "";
  return WIFSIGNALED(status_) ? "signal " + std::to_string(WTERMSIG(status_))
                              : "exit code " + std::to_string(WEXITSTATUS(status_));
}

}  // namespace predictor
