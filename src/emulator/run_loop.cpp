#include "emulator/run_loop.h"

#include <time.h>

#include <cerrno>
#include <memory>

#include "core/choice.h"
#include "core/error.h"
#include "core/heartbeat.h"
#include "core/histogram.h"
#include "core/real_time.h"
#include "core/suspend_watch.h"

namespace predictor {
namespace {

constexpr double kStartTimeout = 30;  // longest time from the first tick to RUN [s]
// The loop wakes up this long before a tick is due [ns]. Wake-ups are late by tens of microseconds,
// and a core is slow for about the same time after it has slept.
constexpr std::uint64_t kAwakeBefore = 150'000;

std::uint64_t TimeOf(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

std::uint64_t Now() { return TimeOf(CLOCK_MONOTONIC); }

void WaitUntil(std::uint64_t due) {
  const std::uint64_t wake = due - kAwakeBefore;
  const timespec t{static_cast<time_t>(wake / 1'000'000'000ULL),
                   static_cast<long>(wake % 1'000'000'000ULL)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
  while (Now() < due) {
  }
}

bool AtRest(const Emulator& e) {
  return e.state() == RunState::kHeld || e.state() == RunState::kUnpowered;
}

// `began` states whether the run has reached RUN, even if the run was reset later.
RunEnd EndOf(const Emulator& e, bool began) {
  if (e.record().cause != StopCause::kNone) return RunEnd::kStopped;
  return began ? RunEnd::kFinished : RunEnd::kNotStarted;
}

constexpr double kMaxScenarios = 1e6;  // maximum length of a list of scenarios

// Submits a stop if the count `asked` differs from the count `seen`. `client` is the page that sent
// the last stop request.
void TakeStop(const std::atomic<std::uint32_t>& asked, const std::atomic<std::uint32_t>* client,
              std::uint32_t* seen, Emulator* emulator) noexcept {
  const std::uint32_t now = asked.load(std::memory_order_acquire);
  if (now == *seen) return;
  RunInput input;
  input.kind = InputKind::kStop;
  if (client) input.client = client->load(std::memory_order_relaxed);
  if (emulator->Submit(input)) *seen = now;
}

// Inputs that do not fit into this tick remain in the mailbox, but a stop request never waits.
// `scenario` is null if no scenario may be selected.
void TakeInputs(RunMailbox* mailbox, std::uint32_t* stops, Emulator* emulator,
                std::optional<std::size_t>* scenario) noexcept {
  TakeStop(mailbox->stops, &mailbox->stop_client, stops, emulator);
  RunInput input;
  for (int i = 0; i < kInputsPerTick && emulator->HasRoomForInput(); ++i) {
    if (!mailbox->inputs.Pop(&input)) break;
    if (input.kind == InputKind::kEnable) continue;  // only a person at the rig may enable
    if (input.kind != InputKind::kScenario)
      emulator->Submit(input);
    else if (scenario != nullptr && MayChooseScenario(emulator->state()) && input.value >= 0 &&
             input.value < kMaxScenarios)
      *scenario = static_cast<std::size_t>(input.value);
  }
}

// Stops the arms if a headset's wearer no longer sees them move. `now` is in [ns].
void WatchHeadsets(const RunMailbox& mailbox, std::uint64_t now, Emulator* emulator) noexcept {
  if (mailbox.immersive.load(std::memory_order_acquire) == 0) return;
  const std::uint64_t frame = mailbox.immersive_frame_ns.load(std::memory_order_relaxed);
  const double silence = now > frame ? 1e-9 * static_cast<double>(now - frame) : 0;
  if (silence <= kHeadsetSilence || !MayMove(emulator->state())) return;
  RunInput input;
  input.kind = InputKind::kHeadset;
  input.value = silence;
  emulator->Submit(input);
}

// Stops the arms if the watchdog is silent. `now` is in [ns].
void WatchTheWatchdog(const std::atomic<std::uint32_t>& beats, std::uint64_t now,
                      Heartbeat* heartbeat, Emulator* emulator) noexcept {
  RunInput input;
  input.kind = InputKind::kWatchdog;
  input.value = heartbeat->Silence(beats.load(std::memory_order_acquire), now);
  if (input.value > kWatchdogSilence && MayMove(emulator->state())) emulator->Submit(input);
}

// Stops the arms after the computer was suspended, because all data about arms and people is then
// stale. `now` is in [ns].
void WatchForSuspend(std::uint64_t now, SuspendWatch* watch, Emulator* emulator) noexcept {
  const std::uint64_t boot = TimeOf(CLOCK_BOOTTIME);
  RunInput input;
  input.kind = InputKind::kSuspended;
  input.value = 1e-9 * static_cast<double>(watch->Look(static_cast<std::int64_t>(now),
                                                       static_cast<std::int64_t>(boot),
                                                       static_cast<std::int64_t>(Now())));
  if (input.value > 0) emulator->Submit(input);
}

// `seen` is the number of signals that were already processed.
void TakeEnabling(const std::atomic<std::uint32_t>& enabling, std::uint32_t* seen,
                  Emulator* emulator) noexcept {
  const std::uint32_t now = enabling.load(std::memory_order_acquire);
  if (now == *seen) return;
  RunInput input;
  input.kind = InputKind::kEnable;
  input.value = 1;
  if (emulator->Submit(input)) *seen = now;
}

// The inputs of the loop: requests from other threads, and what the loop itself observes.
class LoopInputs {
 public:
  explicit LoopInputs(const RealTimeOptions& options) : options_(options) {}

  // Submits all inputs of a tick. `now` is in [ns]. If a page selected a scenario, sets `scenario`.
  void Take(std::uint64_t now, Emulator* emulator, std::optional<std::size_t>* scenario) noexcept {
    WatchForSuspend(now, &suspends_, emulator);
    if (options_.watchdog) WatchTheWatchdog(*options_.watchdog, now, &watchdog_, emulator);
    if (options_.enabling) TakeEnabling(*options_.enabling, &enabled_, emulator);
    if (options_.stops) TakeStop(options_.stops->stops, nullptr, &ros_stops_, emulator);
    if (!options_.mailbox) return;
    if (options_.watch_headsets) WatchHeadsets(*options_.mailbox, now, emulator);
    TakeInputs(options_.mailbox, &page_stops_, emulator,
               options_.allow_scenario_switch ? scenario : nullptr);
  }

 private:
  const RealTimeOptions& options_;
  // Numbers of requests that were already processed.
  std::uint32_t page_stops_ = 0, ros_stops_ = 0, enabled_ = 0;
  Heartbeat watchdog_;
  SuspendWatch suspends_;
};

void SaveSnapshot(Emulator* emulator, SnapshotSink* sink) noexcept {
  const std::span<std::byte> to = sink->AcquireBuffer();
  if (!to.empty()) sink->Commit(emulator->record().tick, emulator->SaveState(to));
}

}  // namespace

void AutoStart(Emulator* emulator) noexcept {
  if (!emulator->setup().rules.auto_start) return;
  if (emulator->state() == RunState::kIdle) emulator->Request(RunEvent::kAlignRequested);
  if (emulator->state() == RunState::kArmed) emulator->Request(RunEvent::kStartRequested);
}

bool StartIsRefused(const Emulator& emulator) noexcept {
  return emulator.setup().rules.auto_start && emulator.state() == RunState::kIdle &&
         emulator.record().refused == 1 + static_cast<int>(RunEvent::kAlignRequested);
}

bool IsOver(const Emulator& emulator, double duration) noexcept {
  return duration > 0 && emulator.state() == RunState::kRun &&
         emulator.run_time() >= duration - emulator.dt() / 2;
}

RunEnd Simulate(Emulator* emulator, double duration,
                const std::function<void(const TickRecord&)>& on_record) {
  if (!(duration > 0))
    throw InputError(
        "A run in virtual time needs a length, because no one can end the run. Give the length "
        "with --duration.");
  const double dt = emulator->dt();
  for (double t = 0; !AtRest(*emulator); t += dt) {
    emulator->Tick();
    on_record(emulator->record());
    AutoStart(emulator);
    if (IsOver(*emulator, duration) || StartIsRefused(*emulator)) break;
    if (emulator->run_time() == 0 && t > kStartTimeout) break;
  }
  return EndOf(*emulator, emulator->run_time() > 0);
}

RunEnd RunRealTime(Emulator* emulator, const RealTimeOptions& options,
                   const std::atomic<bool>& quit, RecordRing* ring, RealTimeReport* report) {
  auto lateness = std::make_unique<Histogram>();
  const RealTimeScheduling scheduling;
  report->scheduling = scheduling.got();
  if (const std::string got = emulator->PrioritiseController(scheduling.prior()); !got.empty())
    report->scheduling += "; " + got;
  const double dt = emulator->dt();
  const auto period = static_cast<std::uint64_t>(dt * 1e9);
  std::uint64_t due = Now() + period;
  int missed = 0;
  LoopInputs inputs(options);
  bool began = false;  // RUN was reached; from then on there is no automatic start
  for (double t = 0;; t += dt) {
    WaitUntil(due);
    const std::uint64_t woke = Now();
    inputs.Take(woke, emulator, &report->scenario);
    lateness->Add(static_cast<double>(woke - due) * 1e-3);
    emulator->Tick(woke, missed);
    ring->Publish(emulator->record());
    if (options.snapshots) SaveSnapshot(emulator, options.snapshots);
    ++report->ticks;
    began |= emulator->state() == RunState::kRun;
    if (report->scenario) break;
    if (options.auto_start && !began) {
      if (StartIsRefused(*emulator)) break;
      AutoStart(emulator);
    }
    // The last record of a run must show the arms at rest. Otherwise, it would appear to a viewer
    // that the run hangs.
    const bool may_move = MayMove(emulator->state()) || MayMove(emulator->record().state);
    const bool asked_to_end = quit.load(std::memory_order_relaxed);
    if (asked_to_end && !may_move) break;
    // A page may select the next scenario only if the last record shows that nothing moves.
    const bool shown = !options.allow_scenario_switch || !MayMove(emulator->record().state);
    const bool as_planned =
        options.allow_scenario_switch && emulator->record().cause == StopCause::kNone;
    if (AtRest(*emulator) && shown && (!options.keep_running || as_planned)) break;
    if (asked_to_end || IsOver(*emulator, options.duration)) emulator->RequestEnd();
    if (options.auto_start && !began && emulator->setup().rules.auto_start && t > kStartTimeout)
      break;
    // Missed periods are not repeated, because the arms continued with their last command
    // meanwhile.
    due += period;
    missed = 0;
    const std::uint64_t now = Now();
    if (now > due) ++report->overruns;
    for (; now > due; due += period) ++missed;
  }
  emulator->PrioritiseController(false);
  report->lateness_us = {
      static_cast<float>(lateness->Quantile(0.5)), static_cast<float>(lateness->Quantile(0.99)),
      static_cast<float>(lateness->Quantile(0.999)), static_cast<float>(lateness->max())};
  return EndOf(*emulator, began);
}

}  // namespace predictor
