// The only two loops: as fast as the machine allows, and paced by the clock.
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

// With the simulated rig nobody is there to press buttons: takes the steps from IDLE to RUN. With
// real arms it does nothing: there only a person does. Call after each tick.
void StartByItself(Emulator* emulator) noexcept;

// Whether it runs on though `duration` [s] of run time is over. Afterwards RECOVERY may still free
// a hand.
bool IsOver(const Emulator& emulator, double duration) noexcept;

// Virtual time: ticks until `duration` [s] of run time, or until a stop is at rest. `on_record`
// sees every record.
RunEnd Simulate(Emulator* emulator, double duration,
                const std::function<void(const TickRecord&)>& on_record);

struct RealTimeReport {
  std::string scheduling;      // what was asked of the system and what it gave, in words
  std::uint64_t overruns = 0;  // ticks that were not done when the next was due
  std::uint64_t ticks = 0;
  std::array<float, 4> lateness_us{};   // of wake-up: p50, p99, p99.9, max [µs]
  std::optional<std::size_t> scenario;  // somebody chose another, by its place in a list
};

// Who wants the emulator's complete state now and then. Called by the thread that ticks, between
// two ticks: no heap, lock or exception.
class StateSink {
 public:
  virtual ~StateSink() = default;
  // Where to put it if it is wanted now; else nothing.
  virtual std::span<std::byte> Wanted() noexcept = 0;
  // It was taken after `tick` and has `bytes`; 0: it did not fit.
  virtual void Taken(std::uint64_t tick, std::size_t bytes) noexcept = 0;
};

struct RealTimeOptions {
  double duration = 0;            // of run time, after which the arms are brought to rest [s]
  bool stay = false;              // once at rest, tick on until asked to end
  RunMailbox* mailbox = nullptr;  // what pages put in; none without a viewer
  bool by_itself = true;          // the simulated rig goes from IDLE to RUN without a person
  bool watch_headsets = false;    // whoever wears one must see what moves: with real arms
  StateSink* states = nullptr;    // none without a recording
  // Counts the signs that the enabling key is held; none without real arms.
  const std::atomic<std::uint32_t>* enabling = nullptr;
  const StopMailbox* stops = nullptr;  // of ROS-TCP's clients; none without its server
  bool choose = false;  // in IDLE a page may choose another scenario: never with real arms
};

// Real time: one tick each period on the monotonic clock, in the calling thread, with real-time
// scheduling and locked memory where allowed. Publishes each record into `ring`. Returns when the
// arms rest after `duration` or after a stop (unless it is to stay), once `quit` is set, or when in
// IDLE another scenario was chosen.
RunEnd RunRealTime(Emulator* emulator, const RealTimeOptions& options,
                   const std::atomic<bool>& quit, RecordRing* ring, RealTimeReport* report);

}  // namespace predictor
