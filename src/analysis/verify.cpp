#include "analysis/verify.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/status.h"
#include "emulator/emulator.h"
#include "emulator/repeat.h"
#include "recording/columns.h"
#include "scenario/operating_rules.h"

namespace predictor {
namespace {

// Sets the emulator to the state before the tick of `record` if the recording contains that state.
bool Resume(RecordingReader* reader, const TickRecord& record, Emulator* emulator) {
  const std::vector<std::uint64_t>& saved = reader->snapshots();
  RecordedSnapshot state;
  if (!std::binary_search(saved.begin(), saved.end(), record.tick - 1) ||
      !reader->SnapshotAt(record.tick - 1, &state))
    return false;
  emulator->LoadState(state.bytes);
  return true;
}

// Data about lost and refused packets and about power reports of real arms are displayed but not
// recorded. Therefore, the replay uses the recorded warnings about these data.
TickRecord WithWarningsOf(const TickRecord& recorded, const TickRecord& computed) {
  TickRecord with = computed;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    const HandRecord& from = recorded.hands[hand];
    HandRecord& to = with.hands[hand];
    for (std::size_t w = 0; w < kWarnings; ++w) {
      // The bias-drift warning is derived from the readings, so the replay computes this warning.
      if (static_cast<Warning>(w) == Warning::kBiasDrift) continue;
      const auto bit = static_cast<std::uint8_t>(1U << w);
      to.warnings = static_cast<std::uint8_t>((to.warnings & ~bit) | (from.warnings & bit));
      if (w < kWarningValues) to.warning_values[w] = from.warning_values[w];
    }
  }
  return with;
}

}  // namespace

std::optional<Departure> FirstDifference(const TickRecord& recorded, const TickRecord& computed) {
  for (const Column& column : AllColumns()) {
    if (!column.of_clock && column.Bits(recorded) != column.Bits(computed))
      return Departure{recorded.tick, recorded.run_time, column.name, column.Text(recorded),
                       column.Text(computed)};
  }
  return std::nullopt;
}

Verification Verify(RecordingReader* reader, const Scenario& scenario,
                    const std::function<void(std::uint64_t)>& progress) {
  std::unique_ptr<RecordedDevice> arms;  // returns the recorded samples of real arms
  if (RulesFor(scenario).external_device) arms = std::make_unique<RecordedDevice>();
  RecordedDevice* device = arms.get();
  Emulator emulator(scenario, std::move(arms));
  Verification result;
  TickRecord record;
  std::uint64_t expected = 1;  // the next tick of the emulator
  bool follows = true;         // the emulator is at the tick immediately before `expected`
  while (reader->Next(&record)) {
    if (record.tick != expected) {
      result.missing += record.tick - expected;
      follows = false;
    }
    expected = record.tick + 1;
    if (!follows) follows = Resume(reader, record, &emulator);
    if (!follows) {
      ++result.skipped;
      continue;
    }
    Repeat(record, &emulator, device);
    ++result.ticks;
    const TickRecord computed =
        device ? WithWarningsOf(record, emulator.record()) : emulator.record();
    if (!SameTick(record, computed)) {
      result.departure = FirstDifference(record, computed);
      if (result.departure) return result;
    }
    if (result.ticks % 1000 == 0) progress(result.ticks);
  }
  return result;
}

}  // namespace predictor
