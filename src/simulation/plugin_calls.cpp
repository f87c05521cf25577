#include "simulation/plugin_calls.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/text.h"

namespace predictor {
namespace {

// This variable is initialised with a constant, so that a signal handler can read it at any time.
constinit thread_local PluginCalls* running = nullptr;

std::atomic<PluginCalls*> given_up{nullptr};

}  // namespace

// The list of all controllers from libraries that exist at present.
struct PluginWatchList {
  std::mutex mutex;
  std::vector<PluginCalls*> all;
  PluginCalls* longest = nullptr;  // returned by the last look
  std::function<void()> start;     // of OnNextPlugin

  void Add(PluginCalls* calls) {
    std::function<void()> now;
    {
      const std::scoped_lock lock(mutex);
      all.push_back(calls);
      now = std::exchange(start, {});
    }
    if (now) now();
  }

  void Remove(PluginCalls* calls) {
    const std::scoped_lock lock(mutex);
    std::erase(all, calls);
    if (longest == calls) longest = nullptr;
  }

  std::optional<LongPluginCall> Look() {
    const std::scoped_lock lock(mutex);
    longest = nullptr;
    for (PluginCalls* calls : all) {
      const std::uint64_t count = calls->count_.load();
      calls->looks_ = count == calls->seen_ && count % 2 == 1 ? calls->looks_ + 1 : 0;
      calls->seen_ = count;
      if (calls->looks_ > (longest ? longest->looks_ : 0)) longest = calls;
    }
    if (!longest) return {};
    return LongPluginCall{longest->library_, longest->function_.load(), longest->prepares_.load(),
                          longest->looks_};
  }

  bool GiveUp() {
    const std::scoped_lock lock(mutex);
    if (!longest) return false;
    given_up = longest;
    if (longest->count_.load() == longest->seen_) return true;
    given_up = nullptr;
    return false;
  }
};

namespace {

// The list is never destroyed, because the thread that looks at the calls may outlive the static
// objects.
PluginWatchList& TheList() {
  static PluginWatchList* const list = new PluginWatchList;
  return *list;
}

}  // namespace

PluginCalls::PluginCalls(const std::string& library) : library_(Printable(library)) {
  TheList().Add(this);
}

PluginCalls::~PluginCalls() { TheList().Remove(this); }

PluginCall::PluginCall(PluginCalls* calls, const char* function, Kind kind) noexcept
    : calls_(calls) {
  calls_->function_.store(function, std::memory_order_relaxed);
  calls_->prepares_.store(kind == Kind::kPreparation, std::memory_order_relaxed);
  calls_->count_.store(calls_->count_.load(std::memory_order_relaxed) + 1,
                       std::memory_order_release);
  running = calls_;
}

// Both accesses are sequentially consistent. Their order ensures that either this thread sees that
// its call was given up, or GiveUp sees that the call has returned.
PluginCall::~PluginCall() {
  running = nullptr;
  calls_->count_.store(calls_->count_.load(std::memory_order_relaxed) + 1);
  while (given_up.load() == calls_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

PluginCall::Place PluginCall::Current() noexcept {
  if (!running) return {};
  return {running->library_.c_str(), running->function_.load(std::memory_order_relaxed)};
}

std::optional<LongPluginCall> LookAtPluginCalls() { return TheList().Look(); }

bool GiveUpPluginCall() { return TheList().GiveUp(); }

void OnNextPlugin(std::function<void()> start) {
  PluginWatchList& list = TheList();
  const std::scoped_lock lock(list.mutex);
  list.start = std::move(start);
}

}  // namespace predictor
