#include "simulation/controller_process.h"

#include <chrono>
#include <new>
#include <thread>

#include "core/error.h"

namespace predictor {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kKey = "cobot.controller.command";
constexpr int kSpins = 20'000;  // before the first pause
constexpr auto kPause = std::chrono::microseconds(50);
constexpr double kEndTime = 1;  // for the program to end by itself [s]

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

ControllerProcess::ControllerProcess(const std::vector<std::string>& command,
                                     const std::filesystem::path& folder)
    : process_(kKey, sizeof(PredictorControllerMemory)),
      shared_(new (process_.memory()) PredictorControllerMemory{}) {
  if (command.empty())
    throw InputError::At(
        kKey, std::string(kKey) +
                  " is empty. Give the program and its arguments, as in [python3, controller.py].");
  shared_->version = PREDICTOR_CONTROLLER_VERSION;
  shared_->size = sizeof(PredictorControllerMemory);
  process_.Start(command, folder,
                 "Give a program in PATH, or its path from the scenario's folder.");
}

ControllerProcess::~ControllerProcess() {
  Send(PREDICTOR_END);
  process_.End(kEndTime);
}

void ControllerProcess::Send(int kind) noexcept {
  shared_->request_kind = kind;
  __atomic_store_n(&shared_->request, ++request_, __ATOMIC_RELEASE);
}

bool ControllerProcess::IsBusy() const noexcept {
  return __atomic_load_n(&shared_->answer, __ATOMIC_ACQUIRE) != request_;
}

bool ControllerProcess::AskAndWait(int kind, double limit) noexcept {
  if (process_.was_seen_to_end()) return false;
  if (!IsBusy()) Send(kind);
  for (int spin = 0; spin < kSpins; ++spin)
    if (!IsBusy()) return true;
  const Clock::time_point start = Clock::now();
  while (IsBusy()) {
    if ((process_.HasEnded() && IsBusy()) || Since(start) > limit) return false;
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
