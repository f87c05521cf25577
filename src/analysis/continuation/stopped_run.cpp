#include "analysis/continuation/stopped_run.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/verify.h"
#include "core/error.h"
#include "core/format.h"
#include "core/norm.h"
#include "core/words.h"
#include "emulator/emulator.h"
#include "emulator/repeat.h"
#include "evaluation/stops.h"
#include "scenario/operating_rules.h"

namespace predictor {
namespace {

constexpr std::uint64_t kReport = 1000;  // ticks between two reports of progress

StopFinder FindInRecording(RecordingReader* reader, const Scenario& scenario) {
  StopFinder finder(scenario.rate);
  TickRecord record;
  while (reader->Next(&record))
    if (finder.Add(record)) return finder;
  if (finder.other() == StopCause::kNone)
    throw InputError(
        "The recording contains no stop, so there is nothing to continue. "
        "`predictor evaluate` and `predictor report` judge runs that were not stopped.");
  throw InputError("The run was stopped because " + StopCauseText(finder.other()) +
                   ". A run can be continued only after a stop by a limit of force, torque, "
                   "coupling or tracking (the speed cap).");
}

// Computes the ticks before `stop` again. Throws InputError.
void Recompute(RecordingReader* reader, std::uint64_t stop, Emulator* emulator,
               const std::function<void(std::uint64_t)>& progress) {
  RecordedSnapshot snapshot;
  std::uint64_t next = 1;
  if (stop > 1 && reader->SnapshotAt(stop - 1, &snapshot)) {
    emulator->LoadState(snapshot.bytes);
    next = snapshot.tick + 1;
  }
  reader->Seek(next);
  TickRecord record;
  for (std::uint64_t done = 0; next < stop; ++next) {
    if (!reader->Next(&record) || record.tick != next)
      throw InputError(Formatted(
          "The recording lacks ticks between the last saved state and the stop (tick %llu), so the "
          "state at the stop is not known.",
          static_cast<unsigned long long>(next)));
    Repeat(record, emulator);
    if (const auto difference = FirstDifference(record, emulator->record()))
      throw InputError(Formatted(
          "The recomputed run differs from the recording at tick %llu (%s), so the state at the "
          "stop is not known. Use the version of the program that made the recording. To compare "
          "the whole run, use `predictor verify`.",
          static_cast<unsigned long long>(next), difference->field.c_str()));
    if (++done % kReport == 0) progress(next);
  }
}

}  // namespace

StopFinder::StopFinder(double rate)
    : most_(static_cast<std::size_t>(std::max(2.0, std::round(kPastTime * rate)))) {}

bool StopFinder::Add(const TickRecord& record) {
  if (found_) return false;
  const bool decided = record.cause != StopCause::kNone && record.cause != cause_;
  cause_ = record.cause;
  if (!record.ran) {
    past_.clear();
    if (decided && other_ == StopCause::kNone) other_ = record.cause;
    return false;
  }
  if (first_.tick == 0) first_ = record;
  if (past_.size() >= 2 * most_) past_.erase(past_.begin(), past_.end() - static_cast<long>(most_));
  past_.push_back(record);
  if (!decided) {
    for (const HandRecord& hand : record.hands)
      if (hand.present != 0) peak_ = std::max(peak_, Norm(hand.wrench.data()));
    return false;
  }
  if (!IsLimit(record.cause)) {
    if (other_ == StopCause::kNone) other_ = record.cause;
    return false;
  }
  if (past_.size() > most_) past_.erase(past_.begin(), past_.end() - static_cast<long>(most_));
  found_ = true;
  return true;
}

void CheckContinuable(const Scenario& scenario) {
  if (RulesFor(scenario).external_device)
    throw InputError(
        "The run used real arms. A recording does not contain their state at the stop (delays, "
        "filters, the motion that their controllers still had to perform), so the run cannot be "
        "continued. Runs with the simulated rig can be continued.");
  if (scenario.mode == Mode::kDirect)
    throw InputError(
        "The run was made in mode direct, so its saved states contain the operator but no arms. "
        "Only runs in mode emulate can be continued.");
  if (scenario.controller_tape && !scenario.controller_tape->empty())
    throw InputError(
        "The cobot's controller was outside the program (a plugin or a process). A recording does "
        "not contain the state of such a controller, so the run cannot be continued.");
}

StoppedRun FindStop(RecordingReader* reader, const Scenario& scenario,
                    const std::function<void(std::uint64_t)>& progress) {
  CheckContinuable(scenario);
  const StopFinder finder = FindInRecording(reader, scenario);
  StoppedRun run;
  run.scenario = scenario;
  run.past = finder.past();
  run.peak_before = finder.peak_before();
  run.first = finder.first();
  if (run.past.size() < 2)
    throw InputError(
        "The stop occurs so soon after the start of the run that nothing is known about the "
        "operator.");
  Emulator emulator(scenario);
  Recompute(reader, run.stop().tick, &emulator, progress);
  run.state.resize(kStateBytes);
  run.state.resize(emulator.SaveState(run.state));
  return run;
}

}  // namespace predictor
