#include "emulator/run_loop.h"

#include <time.h>

#include <cerrno>
#include <memory>

#include "core/histogram.h"
#include "core/real_time.h"

namespace predictor {
namespace {

constexpr double kStartTimeout = 30;  // from the first tick to RUN [s]
// Awake before a tick is due by this [ns]: a wake-up is late by tens of microseconds, and a core
// that has just slept is slow for as long again.
constexpr std::uint64_t kAwakeBefore = 150'000;

std::uint64_t Now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

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

// began: it came to RUN, though a reset may have taken it back to the start.
RunEnd EndOf(const Emulator& e, bool began) {
  if (e.record().cause != StopCause::kNone) return RunEnd::kStopped;
  return began ? RunEnd::kFinished : RunEnd::kNotStarted;
}

constexpr double kMostScenarios = 1e6;  // of any list

// Asks for a stop if `asked` has counted on since `seen`. client: who asked last, if a page.
void TakeStop(const std::atomic<std::uint32_t>& asked, const std::atomic<std::uint32_t>* client,
              std::uint32_t* seen, Emulator* emulator) noexcept {
  const std::uint32_t now = asked.load(std::memory_order_acquire);
  if (now == *seen) return;
  RunInput input;
  input.kind = InputKind::kStop;
  if (client) input.client = client->load(std::memory_order_relaxed);
  if (emulator->Submit(input)) *seen = now;
}

// What is not taken in this tick waits in the mailbox; a stop never waits.
// `scenario`: null if none may be chosen.
void TakeInputs(RunMailbox* mailbox, std::uint32_t* stops, Emulator* emulator,
                std::optional<std::size_t>* scenario) noexcept {
  TakeStop(mailbox->stops, &mailbox->stop_client, stops, emulator);
  RunInput input;
  for (int i = 0; i < kInputsPerTick && emulator->HasRoomForInput(); ++i) {
    if (!mailbox->inputs.Pop(&input)) break;
    if (input.kind == InputKind::kEnable) continue;  // nobody enables from afar
    if (input.kind != InputKind::kScenario)
      emulator->Submit(input);
    else if (scenario != nullptr && emulator->state() == RunState::kIdle && input.value >= 0 &&
             input.value < kMostScenarios)
      *scenario = static_cast<std::size_t>(input.value);
  }
}

// What a headset's wearer does not see may not move on. `now`: [ns].
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

// `seen`: signs so far.
void TakeEnabling(const std::atomic<std::uint32_t>& enabling, std::uint32_t* seen,
                  Emulator* emulator) noexcept {
  const std::uint32_t now = enabling.load(std::memory_order_acquire);
  if (now == *seen) return;
  RunInput input;
  input.kind = InputKind::kEnable;
  input.value = 1;
  if (emulator->Submit(input)) *seen = now;
}

void GiveState(Emulator* emulator, StateSink* sink) noexcept {
  const std::span<std::byte> to = sink->Wanted();
  if (!to.empty()) sink->Taken(emulator->record().tick, emulator->SaveState(to));
}

}  // namespace

void StartByItself(Emulator* emulator) noexcept {
  if (!emulator->setup().simulated) return;
  if (emulator->state() == RunState::kIdle) emulator->Request(RunEvent::kAlignRequested);
  if (emulator->state() == RunState::kArmed) emulator->Request(RunEvent::kStartRequested);
}

bool IsOver(const Emulator& emulator, double duration) noexcept {
  return emulator.state() == RunState::kRun && emulator.run_time() >= duration - emulator.dt() / 2;
}

RunEnd Simulate(Emulator* emulator, double duration,
                const std::function<void(const TickRecord&)>& on_record) {
  const double dt = emulator->dt();
  for (double t = 0; !AtRest(*emulator); t += dt) {
    emulator->Tick();
    on_record(emulator->record());
    StartByItself(emulator);
    if (IsOver(*emulator, duration)) break;
    if (emulator->run_time() == 0 && t > kStartTimeout) break;
  }
  return EndOf(*emulator, emulator->run_time() > 0);
}

RunEnd RunRealTime(Emulator* emulator, const RealTimeOptions& options,
                   const std::atomic<bool>& quit, RecordRing* ring, RealTimeReport* report) {
  auto lateness = std::make_unique<Histogram>();
  const RealTimeScheduling scheduling;
  report->scheduling = scheduling.got();
  const double dt = emulator->dt();
  const auto period = static_cast<std::uint64_t>(dt * 1e9);
  std::uint64_t due = Now() + period;
  int missed = 0;
  std::uint32_t page_stops = 0, ros_stops = 0;  // of the mailboxes, seen so far
  std::uint32_t enabled = 0;
  bool began = false;  // RUN was reached; from then on nothing starts by itself
  for (double t = 0;; t += dt) {
    WaitUntil(due);
    const std::uint64_t woke = Now();
    if (options.enabling) TakeEnabling(*options.enabling, &enabled, emulator);
    if (options.stops) TakeStop(options.stops->stops, nullptr, &ros_stops, emulator);
    if (options.mailbox) {
      if (options.watch_headsets) WatchHeadsets(*options.mailbox, woke, emulator);
      TakeInputs(options.mailbox, &page_stops, emulator,
                 options.choose ? &report->scenario : nullptr);
    }
    lateness->Add(static_cast<double>(woke - due) * 1e-3);
    emulator->Tick(woke, missed);
    ring->Publish(emulator->record());
    if (options.states) GiveState(emulator, options.states);
    ++report->ticks;
    began |= emulator->state() == RunState::kRun;
    if (report->scenario) break;
    if (options.by_itself && !began) StartByItself(emulator);
    // The last record says that the arms rest, or whoever watches would take the end for a hang.
    const bool may_move = MayMove(emulator->state()) || MayMove(emulator->record().state);
    const bool asked_to_end = quit.load(std::memory_order_relaxed);
    if (asked_to_end && !may_move) break;
    if (!options.stay && AtRest(*emulator)) break;
    if (asked_to_end || IsOver(*emulator, options.duration)) emulator->RequestEnd();
    if (options.by_itself && !began && emulator->setup().simulated && t > kStartTimeout) break;
    // A period that is already over is not made up for: the arms' command was held meanwhile.
    due += period;
    missed = 0;
    const std::uint64_t now = Now();
    if (now > due) ++report->overruns;
    for (; now > due; due += period) ++missed;
  }
  report->lateness_us = {
      static_cast<float>(lateness->Quantile(0.5)), static_cast<float>(lateness->Quantile(0.99)),
      static_cast<float>(lateness->Quantile(0.999)), static_cast<float>(lateness->max())};
  return EndOf(*emulator, began);
}

}  // namespace predictor
