#include "report.h"

#include <string>

#include "core/format.h"
#include "core/units.h"
#include "scenario/event_words.h"
#include "screen.h"

namespace predictor {
namespace {

void PrintWhyNotStarted(const Emulator& emulator) {
  if (const std::string why = emulator.WhyNotAligned(); !why.empty())
    return TheScreen().Print("predictor: error: the run did not start.\n" + why);
  const SafetySpec& safety = emulator.scenario().safety;
  std::string arms;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = emulator.record().hands[i];
    const Pose real = FromRecord(hand.real.pose);
    const Pose wanted = FromRecord(hand.virtual_.pose);
    const double distance = (wanted.p - real.p).norm();
    const double angle = RotationError(wanted.q, real.q).norm();
    if (!hand.present ||
        (distance <= safety.align_tolerance && angle <= safety.align_tolerance_rotation))
      continue;
    Append(&arms, "%sthe %s arm remained %.1f mm and %.2f° away from its virtual handle",
           arms.empty() ? "" : ", ", kHandNames[i], 1e3 * distance, kDegrees * angle);
  }
  TheScreen().Print(
      arms.empty()
          ? "predictor: error: the run did not start, because no start was requested."
          : Formatted("predictor: error: the run did not start: %s (limits %.1f mm and %.2f°).\n"
                      "hint: Run `predictor check` and move the arms' bases.",
                      arms.c_str(), 1e3 * safety.align_tolerance,
                      kDegrees * safety.align_tolerance_rotation));
}

}  // namespace

void PrintSetup(const Emulator& emulator, bool quiet) {
  if (quiet) return;
  const EmulatorSetup& setup = emulator.setup();
  TheScreen().Print("Device    " + setup.device);
  for (const std::string& sentence : EventsAfterTheEnd(emulator.scenario()))
    TheScreen().Print("Warning: " + sentence);
  if (emulator.scenario().mode == Mode::kDirect) return;
  const double margin = setup.lead.margin.gain;
  std::string text =
      Formatted("Lag compensation: %.1f of %.1f ms. ", 1e3 * setup.lead.lead, 1e3 * setup.lead.lag);
  if (margin <= 0)
    text += "NOT STABLE with any hand. Run `predictor check`.";
  else if (margin < 2)
    text += Formatted(
        "Stability margin TOO LOW: %.1f (at least 2 required). Run `predictor check`.", margin);
  else
    text += Formatted("Stability margin: %.1f (at least 2 required).", margin);
  TheScreen().Print(text);
}

std::optional<PredictedLoop> PredictedLoopOf(const Emulator& emulator) {
  if (emulator.scenario().mode == Mode::kDirect) return {};
  const LeadChoice& choice = emulator.setup().lead;
  return PredictedLoop{choice.lead, choice.margin.gain};
}

int Report(const Emulator& emulator, RunEnd end, double wall, const ScenarioOptions& options,
           Summary* summary) {
  if (end == RunEnd::kNotStarted && summary->stop_count == 0) {
    PrintWhyNotStarted(emulator);
    return kDeviceFailure;
  }
  if (const std::string why = emulator.EngineFailure(); !why.empty())
    TheScreen().Print("predictor: error: " + why);
  summary->loop = PredictedLoopOf(emulator);
  summary->real_time_factor = wall > 0 ? summary->duration() / wall : 0;
  options.Write(SummaryTable(*summary), SummaryJson(*summary));
  return end == RunEnd::kStopped ? kSafetyStop : kFinished;
}

}  // namespace predictor
