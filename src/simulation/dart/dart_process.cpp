#include "simulation/dart/dart_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <new>
#include <system_error>

#include "core/error.h"
#include "simulation/dart/turn.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using dart_engine::Request;

constexpr const char* kEngineKey = "simulation.engine";
constexpr double kLongestAnswer = 10;    // [s]
constexpr double kProgramEndTime = 0.5;  // for the program to end by itself [s]

// Returns the path of predictor-dart, in the folder of the running program.
fs::path Program() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / "predictor-dart";
}

}  // namespace

bool HasDart() {
  std::error_code error;
  return fs::exists(Program(), error);
}

std::string DartVersion() {
  if (!HasDart()) return "";
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) return "";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  std::string program = Program().string(), option = dart_engine::kVersionOption;
  char* arguments[] = {program.data(), option.data(), nullptr};
  pid_t child = 0;
  const bool started =
      posix_spawn(&child, program.c_str(), &actions, nullptr, arguments, environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  close(pipe[1]);
  std::array<char, 64> text{};
  const ssize_t size = started ? read(pipe[0], text.data(), text.size()) : 0;
  close(pipe[0]);
  if (started) waitpid(child, nullptr, 0);
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
}

DartProcess::DartProcess(const dart_engine::SceneData& scene) : scene_(scene) {
  if (!HasDart())
    throw InputError::At(
        kEngineKey, "simulation.engine is dart, but PREDICTOR was built without it: there is no " +
                        Program().string() +
                        ". Install DART (Debian 12: apt-get install libdart-dev "
                        "libdart-collision-ode-dev) and run `./dev build`, or set "
                        "simulation.engine: mujoco.");
  Start();
}

DartProcess::~DartProcess() {
  memory_->kind = Request::kEnd;
  dart_engine::Publish(&memory_->request, ++request_);
  process_->End(kProgramEndTime);
}

void DartProcess::Start() {
  auto process = std::make_unique<SharedProcess>(kEngineKey, sizeof(dart_engine::Memory));
  auto* memory = new (process->memory()) dart_engine::Memory{};
  memory->version = dart_engine::kVersion;
  memory->size = sizeof(dart_engine::Memory);
  memory->scene = scene_;
  process->Start({Program().string()}, "/", "Build PREDICTOR again.");
  process_ = std::move(process);
  memory_ = memory;
  request_ = 0;
  is_silent_ = false;
  if (Ask(Request::kBuild)) return;
  const std::string why = memory_->text[0] != '\0' ? std::string(memory_->text) : Failure();
  throw InputError::At(kEngineKey, "simulation.engine is dart, which cannot load the scene: " +
                                       why + " Set simulation.engine: mujoco.");
}

bool DartProcess::Ask(Request kind) noexcept {
  using Clock = std::chrono::steady_clock;
  if (is_silent_ || process_->was_seen_to_end()) return false;
  memory_->kind = kind;
  memory_->text[0] = '\0';
  const std::uint32_t before = request_++;
  const Clock::time_point start = Clock::now();
  dart_engine::Publish(&memory_->request, request_);
  while (!dart_engine::WaitForChange(&memory_->answer, before)) {
    if (process_->HasEnded() && dart_engine::Load(&memory_->answer) == before) return false;
    is_silent_ = std::chrono::duration<double>(Clock::now() - start).count() > kLongestAnswer;
    if (is_silent_) return false;
  }
  return memory_->result == dart_engine::Result::kDone;
}

std::string DartProcess::Failure() noexcept {
  if (is_silent_) return "The engine's process does not answer any more.";
  const std::string how = process_->HowItEnded();
  return how.empty() ? failure_
                     : "The engine's process ended: " + how +
                           (how == "signal 6" ? ", as DART does when the state diverges." : ".");
}

void DartProcess::Revive() noexcept {
  const std::string failure = Failure();
  if (failure.empty() || (!is_silent_ && !process_->was_seen_to_end())) return;
  try {
    Start();
    failure_ = failure;
  } catch (const std::exception&) {
    is_silent_ = true;
  }
}

}  // namespace predictor
