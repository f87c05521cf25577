// Keeps track of the calls into controllers' libraries. A library runs as part of the program. If
// the library crashes, the program ends; if a call into the library does not return, the control
// loop stops. Another thread or a signal handler must then report this problem. The functions in
// this file state which library was running.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace predictor {

// The calls into the library of one controller. Only one thread at a time makes these calls.
class PluginCalls {
 public:
  // `library` is its file.
  explicit PluginCalls(const std::string& library);
  ~PluginCalls();
  PluginCalls(const PluginCalls&) = delete;
  PluginCalls& operator=(const PluginCalls&) = delete;

  const std::string& library() const noexcept { return library_; }  // made printable

 private:
  friend class PluginCall;
  friend struct PluginWatchList;

  const std::string library_;
  // Only the calling thread writes these members.
  std::atomic<std::uint64_t> count_{0};         // odd: the library runs
  std::atomic<const char*> function_{nullptr};  // the one that runs or ran last
  std::atomic<bool> prepares_{false};           // it may take long: it is not in the loop
  std::uint64_t seen_ = 0;                      // of the thread that looks: count_ at the last
                                                // look
  int looks_ = 0;                               // how often it then saw the same call
};

// The library runs as long as this object exists. The functions have the names of the functions in
// predictor/controller.h.
class PluginCall {
 public:
  enum class Kind { kInLoop, kPreparation };
  // `function` must be a literal. This class does not use the heap, locks or system calls.
  PluginCall(PluginCalls* calls, const char* function, Kind kind = Kind::kInLoop) noexcept;
  // If GiveUpPlugin has given up this call, the destructor never returns.
  ~PluginCall();
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;

  // Describes the library that this thread runs at present, by its file and its function. Both are
  // null if the thread runs no library. A signal handler may call this.
  struct Place {
    const char* library = nullptr;
    const char* function = nullptr;
  };
  static Place Current() noexcept;

 private:
  PluginCalls* calls_;
};

// A call that has not returned.
struct LongPluginCall {
  std::string library, function;
  bool prepares = false;  // the library is being loaded, or its controller made or destroyed
  int looks = 0;          // number of consecutive looks that saw it
};

// Looks at all controllers, and considers the calls that were already running at the last look.
// Returns the call that has been running for the largest number of looks, or nothing if there is no
// such call. One thread calls this function at a fixed interval. The duration of a call is counted
// in looks instead of seconds, so that it does not grow while the whole program is stopped or
// delayed.
std::optional<LongPluginCall> LookAtPluginCalls();

// Gives up the call that LookAtPluginCalls returned last. If this call returns after all, its
// thread waits forever, so that the control loop does not continue while another thread ends the
// program. Returns false and changes nothing if the call has already returned.
bool GiveUpPluginCall();

// `start` is called only when the next library is about to be loaded. It starts the thread that
// looks at the calls. A program that never loads a library does not need the thread.
void OnNextPlugin(std::function<void()> start);

}  // namespace predictor
