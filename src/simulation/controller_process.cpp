#include "simulation/controller_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kKey = "cobot.controller.command";
constexpr int kDescriptor = 3;       // of the shared memory, in the program
constexpr int kSafeDescriptor = 16;  // above those that are replaced
constexpr int kSpins = 20'000;       // before the first pause
constexpr auto kPause = std::chrono::microseconds(50);
constexpr double kEndTime = 1;  // for the program to end by itself [s]

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

[[noreturn]] void Refuse(const std::string& why) {
  throw InputError::At(kKey, std::string(kKey) + why);
}

// Creates anonymous memory that the program inherits. Returns its descriptor.
int NewMemory() {
  const int made = memfd_create("controller", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  const int descriptor = made < 0 ? -1 : fcntl(made, F_DUPFD_CLOEXEC, kSafeDescriptor);
  if (made >= 0) close(made);
  // The size is sealed. If the program could shorten the memory, the control loop would crash.
  if (descriptor < 0 || ftruncate(descriptor, sizeof(PredictorControllerMemory)) != 0 ||
      fcntl(descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
    Refuse(std::string(": no shared memory: ") + std::strerror(errno) + ".");
  return descriptor;
}

pid_t Spawn(const std::vector<std::string>& command, const std::filesystem::path& folder,
            int memory) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, memory, kDescriptor);
  posix_spawn_file_actions_addclosefrom_np(&actions, kDescriptor + 1);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // Ctrl-C at the terminal is meant for the run, which then ends the program by itself.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
  pid_t pid = 0;
  const int error =
      posix_spawnp(&pid, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return pid;
  Refuse(": " + Quote(command[0]) + " could not be started in " + folder.string() + ": " +
         std::strerror(error) +
         ". Give a program in PATH, or its path from the scenario's folder.");
}

}  // namespace

ControllerProcess::ControllerProcess(const std::vector<std::string>& command,
                                     const std::filesystem::path& folder) {
  if (command.empty())
    Refuse(" is empty. Give the program and its arguments, as in [python3, controller.py].");
  const int memory = NewMemory();
  void* address = mmap(nullptr, sizeof(PredictorControllerMemory), PROT_READ | PROT_WRITE,
                       MAP_SHARED | MAP_POPULATE, memory, 0);
  try {
    if (address == MAP_FAILED)
      Refuse(std::string(": no shared memory: ") + std::strerror(errno) + ".");
    shared_ = new (address) PredictorControllerMemory{};
    shared_->version = PREDICTOR_CONTROLLER_VERSION;
    shared_->size = sizeof(PredictorControllerMemory);
    pid_ = Spawn(command, folder, memory);
  } catch (...) {
    close(memory);
    if (address != MAP_FAILED) munmap(address, sizeof(PredictorControllerMemory));
    throw;
  }
  close(memory);
}

ControllerProcess::~ControllerProcess() {
  Send(PREDICTOR_END);
  const Clock::time_point start = Clock::now();
  while (!HasEnded() && Since(start) < kEndTime) std::this_thread::sleep_for(kPause);
  if (!ended_) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  munmap(shared_, sizeof(PredictorControllerMemory));
}

void ControllerProcess::Send(int kind) noexcept {
  shared_->request_kind = kind;
  __atomic_store_n(&shared_->request, ++request_, __ATOMIC_RELEASE);
}

bool ControllerProcess::IsBusy() const noexcept {
  return __atomic_load_n(&shared_->answer, __ATOMIC_ACQUIRE) != request_;
}

bool ControllerProcess::HasEnded() noexcept {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return ended_;
}

std::string ControllerProcess::HowItEnded() noexcept {
  if (!HasEnded()) return "";
  return WIFSIGNALED(status_) ? "signal " + std::to_string(WTERMSIG(status_))
                              : "exit code " + std::to_string(WEXITSTATUS(status_));
}

bool ControllerProcess::AskAndWait(int kind, double limit) noexcept {
  if (ended_) return false;
  if (!IsBusy()) Send(kind);
  for (int spin = 0; spin < kSpins; ++spin)
    if (!IsBusy()) return true;
  const Clock::time_point start = Clock::now();
  while (IsBusy()) {
    if ((HasEnded() && IsBusy()) || Since(start) > limit) return false;
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

bool ControllerProcess::AskAndWatch(int kind, double deadline) noexcept {
  if (IsBusy()) return false;
  Send(kind);
  const Clock::time_point start = Clock::now();
  while (IsBusy())
    if (Since(start) > deadline) return false;
  return true;
}

}  // namespace predictor
