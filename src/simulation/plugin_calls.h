// Keeps track of the calls into controllers' libraries. A library runs as part of the program: a
// crash in it ends the program, and a call that does not return stops the control loop. Another
// thread or a signal handler must then report this problem. From this file, they learn which
// library was running.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace predictor {

// The calls of one controller, which come from one thread at a time.
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

// While this object exists, the library runs. The functions have the names of the functions in
// predictor/controller.h.
class PluginCall {
 public:
  enum class Kind { kInLoop, kPreparation };
  // `function` must be a literal. Does not use the heap, a lock or a system call.
  PluginCall(PluginCalls* calls, const char* function, Kind kind = Kind::kInLoop) noexcept;
  // Never ends after GiveUpPlugin has given up this call.
  ~PluginCall();
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;

  // Describes the library that this thread runs at present: its file and its function. Both are
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

// Looks at all controllers and returns the call that has been running for the most looks, or
// nothing if none was running at the last look too. One thread calls this at a fixed interval.
// The duration of a call is measured in looks and not by the clock, so that it does not grow while
// the whole program is stopped or delayed.
std::optional<LongPluginCall> LookAtPluginCalls();

// Gives up the call that LookAtPluginCalls returned last. If this call returns after all, its
// thread waits forever, so that the control loop does not continue while another thread ends the
// program. Returns false and changes nothing if the call has already returned.
bool GiveUpPluginCall();

// `start` is called when the next library is about to be loaded, and only then: it starts the
// thread that looks at the calls. A program that never loads a library does not need the thread.
void OnNextPlugin(std::function<void()> start);

}  // namespace predictor
