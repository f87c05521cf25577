#include <atomic>
#include <csignal>
#include <nlohmann/json.hpp>
#include <string>

#include "analysis/verify.h"
#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "player.h"
#include "progress.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "screen.h"
#include "viewer/admission.h"
#include "viewer/viewer_process.h"

namespace predictor {
namespace {

std::atomic<bool> quit{false};

void OnSignal(int) { quit.store(true); }

std::string TextOf(const Verification& v) {
  std::string text;
  if (v.missing + v.skipped > 0)
    AppendLine(&text,
               "The recording lacks %llu ticks. The %llu ticks between each gap and the next saved "
               "state were not compared.",
               static_cast<unsigned long long>(v.missing),
               static_cast<unsigned long long>(v.skipped));
  if (v.departure)
    AppendLine(&text,
               "Replay differs from the recording at tick %llu (%.3f s): %s is %s in the recording "
               "and %s in the replay.",
               static_cast<unsigned long long>(v.departure->tick), v.departure->run_time,
               v.departure->field.c_str(), v.departure->recorded.c_str(),
               v.departure->computed.c_str());
  else
    AppendLine(&text, "Replay matches the recording bit for bit: %llu ticks.",
               static_cast<unsigned long long>(v.ticks));
  return text;
}

std::string JsonOf(const Verification& v) {
  nlohmann::json result = {{"matches", !v.departure},
                           {"ticks", v.ticks},
                           {"missing_ticks", v.missing},
                           {"skipped_ticks", v.skipped},
                           {"difference", nullptr}};
  if (v.departure)
    result["difference"] = {{"tick", v.departure->tick},
                            {"run_time_s", v.departure->run_time},
                            {"field", v.departure->field},
                            {"recorded", v.departure->recorded},
                            {"computed", v.departure->computed}};
  return result.dump(2) + "\n";
}

}  // namespace

int ReplayCommand(const std::string& recording, const viewer::ViewerOptions& options) {
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
  std::signal(SIGPIPE, SIG_IGN);
  RecordingReader reader(recording);
  TellProblem(reader.problem());
  const TemporaryFolder folder;
  const Scenario scenario = RestoreScenario(reader.header(), folder.path());
  Shared<RunBoard> board;
  Shared<RunMailbox> mailbox;
  Player player(&reader, &*board, &*mailbox);
  viewer::ViewerOptions page = options;
  page.secret = viewer::NewAdmissionSecret();
  page.replay = {player.duration(), player.first_tick()};
  page.object_start = FromRecord(player.first().object.pose).p;
  viewer::ViewerProcess viewer(scenario, page, board, mailbox,
                               [](const std::string& text) { TheScreen().Tell(text); });
  TheScreen().Tell(Formatted("%.1f s of %s. Press Ctrl-C to end.", player.duration(),
                             Quote(scenario.name).c_str()));
  player.Play(quit);
  viewer.EndRun("The replay was ended from the console.");
  return kFinished;
}

int VerifyCommand(const RecordingOptions& options) {
  options.CheckWritable();
  RecordingReader reader(options.recording);
  TellProblem(reader.problem());
  if (reader.header().program_version != PREDICTOR_VERSION)
    TheScreen().Tell(
        Formatted("The recording was made by version %s, but this program is version %s. The "
                  "replay may therefore differ.",
                  Printable(reader.header().program_version).c_str(), PREDICTOR_VERSION));
  const TemporaryFolder folder;
  const Scenario scenario = RestoreScenario(reader.header(), folder.path());
  Progress progress("Verifying", static_cast<double>(reader.count()), options.quiet);
  const Verification result = Verify(
      &reader, scenario, [&](std::uint64_t ticks) { progress.Update(static_cast<double>(ticks)); });
  progress.Finish();
  if (result.ticks == 0)
    throw InputError(options.recording,
                     "No tick could be compared: the recording has no saved state to start from.");
  options.Write(TextOf(result), JsonOf(result));
  return result.departure ? kDeparted : kFinished;
}

}  // namespace predictor
