// The two loops that execute the tick. One loop runs as fast as the computer allows, and the clock
// paces the other.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/shared_run.h"
#include "emulator/emulator.h"

namespace predictor {

// How a run ended.
enum class RunEnd { kFinished, kStopped, kNotStarted };

// Requests the steps from IDLE to RUN if the operating rules allow the program to do so. With real
// arms, only a person may request these steps. Call this after each tick.
void AutoStart(Emulator* emulator) noexcept;

// Returns whether a request of AutoStart was refused in the last tick. The arms do not move, so the
// same request would be refused every time.
bool StartIsRefused(const Emulator& emulator) noexcept;

// Returns whether `duration` [s] of run time has passed in RUN. Returns false if `duration` is 0.
// RECOVERY may still free a hand afterwards.
bool IsOver(const Emulator& emulator, double duration) noexcept;

// Executes ticks in virtual time until `duration` [s] of run time has passed, the arms are at rest
// after a stop, or the start is refused. `on_record` receives every record. Throws InputError if
// `duration` is 0.
RunEnd Simulate(Emulator* emulator, double duration,
                const std::function<void(const TickRecord&)>& on_record);

struct RealTimeReport {
  std::string scheduling;      // the scheduling that was requested and granted
  std::uint64_t overruns = 0;  // ticks that had not ended when the next one was due
  std::uint64_t ticks = 0;
  std::array<float, 4> lateness_us{};   // lateness of wake-ups: p50, p99, p99.9, max [µs]
  std::optional<std::size_t> scenario;  // the scenario that a page selected to run next: its index
                                        // in a list
};

// An interface that receives snapshots of the emulator's complete state. The thread of the tick
// calls the functions between two ticks, so they must not throw and must not use the heap or locks.
class SnapshotSink {
 public:
  virtual ~SnapshotSink() = default;
  // Returns a buffer for the next snapshot, or an empty buffer if no snapshot is due.
  virtual std::span<std::byte> AcquireBuffer() noexcept = 0;
  // Reports that the buffer contains `bytes` of the state after `tick`, or 0 if the state did not
  // fit.
  virtual void Commit(std::uint64_t tick, std::size_t bytes) noexcept = 0;
};

struct RealTimeOptions {
  double duration = 0;                // run time after which the arms are brought to rest [s]
  bool keep_running = false;          // once at rest, continue ticking until the run is ended
  RunMailbox* mailbox = nullptr;      // inputs of pages; null without a viewer
  bool auto_start = true;             // call AutoStart until RUN is reached for the first time
  bool watch_headsets = false;        // a silent headset stops the run
  SnapshotSink* snapshots = nullptr;  // null without a recording
  // Counts the signals of a held enabling key. The pointer is null without real arms.
  const std::atomic<std::uint32_t>* enabling = nullptr;
  const StopMailbox* stops = nullptr;  // stop requests of ROS-TCP clients; null without the server
  // Counts the heartbeats of the watchdog. The pointer is null without real arms.
  const std::atomic<std::uint32_t>* watchdog = nullptr;
  bool allow_scenario_switch = false;  // a page may select the next scenario while the arms are at
                                       // rest
};

// Executes ticks in real time in the calling thread, one tick per period of the monotonic clock. If
// permitted, the thread has real-time scheduling and locked memory. Publishes each record to
// `ring`. The function returns in one of four cases: the arms are at rest after `duration` or a
// stop, `quit` is set, a page has selected the next scenario, or an automatic start is refused.
// (With keep_running, a stop does not end the loop, and `duration` ends it only with
// allow_scenario_switch.)
RunEnd RunRealTime(Emulator* emulator, const RealTimeOptions& options,
                   const std::atomic<bool>& quit, RecordRing* ring, RealTimeReport* report);

}  // namespace predictor
