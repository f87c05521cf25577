#include "report.h"

#include <cstdio>
#include <string>

namespace predictor {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

void PrintWhyNotStarted(const Emulator& emulator) {
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
    char text[128];
    std::snprintf(text, sizeof text, "%sthe %s arm stayed %.1f mm and %.2f° from its handle",
                  arms.empty() ? "" : ", ", kHandNames[i], 1e3 * distance, kDegrees * angle);
    arms += text;
  }
  if (arms.empty())
    std::fprintf(stderr, "predictor: the run never started: nobody asked for it.\n");
  else
    std::fprintf(stderr,
                 "predictor: the run never started: %s (%.1f mm and %.2f° are allowed). Run "
                 "`predictor check`, and move the arms' bases.\n",
                 arms.c_str(), 1e3 * safety.align_tolerance,
                 kDegrees * safety.align_tolerance_rotation);
}

}  // namespace

void PrintSetup(const Emulator& emulator, bool quiet) {
  if (quiet) return;
  const EmulatorSetup& setup = emulator.setup();
  std::fprintf(stderr, "Device    %s\n", setup.device.c_str());
  if (emulator.scenario().mode == Mode::kDirect) return;
  const double margin = setup.lead.margin.gain;
  std::fprintf(stderr, "Lead      %.1f ms of the arms' lag of %.1f ms; ", 1e3 * setup.lead.lead,
               1e3 * setup.lead.lag);
  if (margin > 0)
    std::fprintf(stderr, "the hand may be %.1f times as stiff and heavy%s\n", margin,
                 margin < 2 ? " (below 2: too little margin, see `predictor check`)" : "");
  else
    std::fprintf(stderr, "NOT stable with any hand: see `predictor check`\n");
}

int Report(const Emulator& emulator, RunEnd end, double wall, const ScenarioOptions& options,
           Summary* summary) {
  if (end == RunEnd::kNotStarted && summary->stop_count == 0) {
    PrintWhyNotStarted(emulator);
    return kDeviceFailure;
  }
  summary->real_time_factor = wall > 0 ? summary->duration / wall : 0;
  options.Write(SummaryTable(*summary), SummaryJson(*summary));
  return end == RunEnd::kStopped ? kSafetyStop : kFinished;
}

}  // namespace predictor
