#include <atomic>
#include <csignal>
#include <cstdio>
#include <string>

#include "analysis/verify.h"
#include "commands.h"
#include "core/error.h"
#include "player.h"
#include "progress.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "viewer/admission.h"
#include "viewer/viewer_process.h"

namespace predictor {
namespace {

std::atomic<bool> quit{false};

void OnSignal(int) { quit.store(true); }

std::string Told(const Verification& v) {
  char text[640];
  std::string told;
  if (v.missing + v.skipped > 0) {
    std::snprintf(text, sizeof text,
                  "%llu ticks were lost while recording; %llu that follow them, up to the next "
                  "saved state, are not compared.\n",
                  static_cast<unsigned long long>(v.missing),
                  static_cast<unsigned long long>(v.skipped));
    told = text;
  }
  if (v.departure) {
    const Departure& d = *v.departure;
    std::snprintf(text, sizeof text,
                  "The run computed again departs at tick %llu (%.3f s): %s is %s in the recording "
                  "and %s computed.\n",
                  static_cast<unsigned long long>(d.tick), d.run_time, d.field.c_str(),
                  d.recorded.c_str(), d.computed.c_str());
  } else {
    std::snprintf(text, sizeof text,
                  "The run computed again is the recorded one: %llu ticks, bit for bit.\n",
                  static_cast<unsigned long long>(v.ticks));
  }
  return told + text;
}

}  // namespace

int ReplayCommand(const std::string& recording, const ViewerOptions& options) {
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
  ViewerOptions page = options;
  page.secret = NewAdmissionSecret();
  page.replay = {player.duration(), player.first_tick()};
  page.object_start = FromRecord(player.first().object.pose).p;
  ViewerProcess viewer(scenario, page, board, mailbox,
                       [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); });
  std::fprintf(stderr, "%.1f s of \"%s\". Press Ctrl-C to end.\n", player.duration(),
               scenario.name.c_str());
  player.Play(quit);
  viewer.EndRun("The replay was ended at its console.");
  return kFinished;
}

int VerifyCommand(const std::string& recording, bool quiet) {
  RecordingReader reader(recording);
  TellProblem(reader.problem());
  if (reader.header().program_version != PREDICTOR_VERSION)
    std::fprintf(stderr,
                 "The recording is of version %s, this program is %s: they may well differ.\n",
                 reader.header().program_version.c_str(), PREDICTOR_VERSION);
  const TemporaryFolder folder;
  const Scenario scenario = RestoreScenario(reader.header(), folder.path());
  Progress progress("Computing the run again", static_cast<double>(reader.count()), quiet);
  const Verification result = Verify(
      &reader, scenario, [&](std::uint64_t ticks) { progress.Update(static_cast<double>(ticks)); });
  progress.Finish();
  WriteOut(Told(result));
  if (result.ticks == 0)
    throw InputError(recording,
                     "No tick could be compared: there is no saved state to begin from.");
  return result.departure ? kDeparted : kFinished;
}

}  // namespace predictor
