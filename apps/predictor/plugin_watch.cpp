#include "plugin_watch.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "commands.h"
#include "core/contained_thread.h"
#include "core/format.h"
#include "open_recording.h"
#include "quit.h"
#include "raw_keys.h"
#include "screen.h"
#include "simulation/plugin_calls.h"

namespace predictor {
namespace {

constexpr std::chrono::milliseconds kLookPause{50};  // between two looks
constexpr double kRealTime = 1;                      // for a function of the loop in real time [s]
constexpr double kVirtualTime = 10;   // the same in virtual time, as for a process [s]
constexpr double kPreparation = 30;   // to load, make and destroy, as for a process [s]
constexpr unsigned kLongestEnd = 10;  // for the steps at the end [s]

std::atomic<bool> is_real_time{false};

double PatienceFor(const LongPluginCall& call) {
  if (quit) return kRealTime;
  if (call.prepares) return kPreparation;
  return is_real_time ? kRealTime : kVirtualTime;
}

// Ends the program without the usual order of destruction, because the control loop is stuck in the
// library.
[[noreturn]] void EndHungProgram(const LongPluginCall& call, double patience) {
  // The library may be stuck anywhere, for example in the allocation of memory. The program must
  // end even if one of the following steps blocks.
  std::signal(SIGALRM, [](int) { _exit(kDeviceFailure); });
  alarm(kLongestEnd);
  TheScreen().Bar("");
  TheScreen().Print(Formatted(
      "predictor: error: The function %s of the controller's library %s has not returned for %g s, "
      "so the control loop hangs and the program ends. Correct the library: the functions of the "
      "loop must return within a few microseconds. To run a controller that may hang, use "
      "cobot.controller.type: process.",
      call.function.c_str(), call.library.c_str(), patience));
  if (!OpenRecording::Close())
    if (const char* remedy = OpenRecording::Remedy(); *remedy != '\0') TheScreen().Print(remedy);
  RawKeys::RestoreAtOnce();
  std::_Exit(kDeviceFailure);
}

void WatchCalls() {
  for (;; std::this_thread::sleep_for(kLookPause)) {
    const std::optional<LongPluginCall> call = LookAtPluginCalls();
    if (!call) continue;
    const double patience = PatienceFor(*call);
    const std::chrono::duration<double> lasted = call->looks * kLookPause;
    if (lasted.count() >= patience && GiveUpPluginCall()) EndHungProgram(*call, patience);
  }
}

}  // namespace

void WatchPlugins() {
  OnNextPlugin([] {
    ContainedThread("plug-in watch", WatchCalls, [](const char* why) {
      TheScreen().Print(std::string("The controller's library is no longer watched (") + why +
                        ").");
    }).detach();
  });
}

void ExpectPromptPlugins() noexcept { is_real_time = true; }

}  // namespace predictor
