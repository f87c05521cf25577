#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "analysis/verify.h"
#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "core/shared_run.h"
#include "core/text.h"
#include "live_evaluation.h"
#include "patient_output.h"
#include "progress.h"
#include "quit.h"
#include "recorded_run.h"
#include "recording/reader.h"
#include "restored_scenario.h"
#include "screen.h"
#include "viewer/admission.h"
#include "viewer/viewer_process.h"

namespace predictor {
namespace {

constexpr double kTurn = 0.01;  // time between two displayed states [s]
// Up to this distance, reading on is faster than seeking in the file [s].
constexpr double kNear = 2;

std::uint64_t Nanoseconds(std::chrono::steady_clock::time_point t) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count());
}

// Returns the number of the last tick of a recording, which may have gaps.
std::uint64_t LastTick(RecordingReader* reader, const TickRecord& first) {
  TickRecord last = first;
  reader->Seek(first.tick + std::max<std::uint64_t>(reader->count(), 1) - 1);
  while (reader->Next(&last)) {
  }
  return last.tick;
}

// Plays a recording in the viewer: each state that a page shows is a recorded tick. The ticks
// between two such states are also published, because the evaluator needs them.
class Player {
 public:
  // All arguments are borrowed. Throws InputError if the recording contains no ticks.
  Player(RecordingReader* reader, RunBoard* board, RunMailbox* mailbox);

  std::uint64_t first_tick() const { return first_.tick; }
  const TickRecord& first() const { return first_; }
  double duration() const { return duration_; }  // time from the first to the last tick [s]

  // Shows the first tick and then follows the pages' commands until a signal arrives. Throws
  // InputError if the recording is damaged.
  void Play();

  // Advances by `dt` [s]. The time `now` of the monotonic clock [ns] replaces the recorded time,
  // because pages compute the age of a state from this time.
  void Step(double dt, std::uint64_t now);

 private:
  void TakeInputs();
  void MoveTo(double position);
  void Show(const TickRecord& record);

  RecordingReader* reader_;
  RunBoard* board_;
  RunMailbox* mailbox_;
  double dt_;  // duration of a tick [s]
  TickRecord first_, shown_;
  double duration_ = 0, position_ = 0, speed_ = 1;  // speed 0: paused
  std::uint64_t now_ = 0;                           // monotonic clock at this step [ns]
  std::uint32_t stops_ = 0;
};

Player::Player(RecordingReader* reader, RunBoard* board, RunMailbox* mailbox)
    : reader_(reader), board_(board), mailbox_(mailbox), dt_(reader->header().dt) {
  if (!(dt_ > 0) || !reader_->Next(&first_))
    throw InputError("The recording has no ticks, so there is nothing to show.");
  duration_ = static_cast<double>(LastTick(reader_, first_) - first_.tick) * dt_;
  reader_->Seek(first_.tick);
  reader_->Next(&shown_);
}

void Player::Play() {
  auto last = std::chrono::steady_clock::now();
  while (!quit) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kTurn));
    const auto now = std::chrono::steady_clock::now();
    Step(std::chrono::duration<double>(now - last).count(), Nanoseconds(now));
    last = now;
  }
}

void Player::Step(double dt, std::uint64_t now) {
  now_ = now;
  TakeInputs();
  MoveTo(std::clamp(position_ + speed_ * dt, 0.0, duration_));
  if (position_ >= duration_) speed_ = 0;
  Show(shown_);
}

void Player::Show(const TickRecord& record) {
  TickRecord shown = record;
  shown.wall_ns = now_;
  board_->records.Publish(shown);
}

void Player::TakeInputs() {
  const std::uint32_t stops = mailbox_->stops.load(std::memory_order_acquire);
  if (stops != stops_) speed_ = 0;
  stops_ = stops;
  RunInput input;
  while (mailbox_->inputs.Pop(&input)) {
    if (!std::isfinite(input.value)) continue;
    if (input.kind == InputKind::kPlay) {
      if (position_ >= duration_ && input.value > 0) MoveTo(0);
      speed_ = std::clamp(input.value, 0.0, 64.0);
    } else if (input.kind == InputKind::kSeek) {
      MoveTo(std::clamp(input.value, 0.0, duration_));
    } else if (input.kind == InputKind::kStep) {
      speed_ = 0;
      MoveTo(std::clamp(position_ + std::round(input.value) * dt_, 0.0, duration_));
    }
  }
}

// Shows the last tick at or before `position`, or the next tick if `position` is in a gap.
void Player::MoveTo(double position) {
  position_ = position;
  const std::uint64_t tick =
      first_.tick + static_cast<std::uint64_t>(std::floor(position / dt_ + 1e-6));
  if (tick == shown_.tick) return;
  const bool near = tick > shown_.tick && static_cast<double>(tick - shown_.tick) * dt_ < kNear;
  if (!near) reader_->Seek(tick);
  TickRecord record;
  while ((!near || shown_.tick < tick) && reader_->Next(&record)) {
    shown_ = record;
    if (!near) return;
    if (shown_.tick < tick) Show(record);
  }
}

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

int ReplayCommand(const RecordingOptions& recording, const ServeOptions& options) {
  recording.CheckWritable();
  QuitOn({SIGINT, SIGTERM});
  BoundOutput();
  RecordingReader reader(recording.recording);
  ShowProblem(reader.problem());
  const RestoredScenario restored(reader.header());
  const Scenario& scenario = restored.Get();
  Shared<RunBoard> board;
  Shared<RunMailbox> mailbox;
  Player player(&reader, &*board, &*mailbox);
  const auto show = [](const std::string& text) { TheScreen().Print(text); };
  // A head in the mailbox is that of a person who watches the replay.
  const LiveEvaluation evaluation(options.evaluation, scenario, board, nullptr, nullptr, show);
  viewer::ViewerOptions page = options.page;
  page.why_not_judged = evaluation.why_not();
  page.secret = viewer::NewAdmissionSecret();
  page.replay = {player.duration(), player.first_tick()};
  page.object_start = FromRecord(player.first().object.pose).p;
  viewer::ViewerProcess viewer(scenario, page, board, mailbox, show, evaluation.states());
  TheScreen().Print(Formatted("%.1f s of %s. Press Ctrl-C to end.", player.duration(),
                              Quote(scenario.name).c_str()));
  player.Play();
  viewer.EndRun("The replay was ended from the console.");
  recording.WriteJson(nlohmann::ordered_json{{"scenario", scenario.name},
                                             {"duration_s", player.duration()},
                                             {"first_tick", player.first_tick()}}
                          .dump(2) +
                      "\n");
  return kFinished;
}

int VerifyCommand(const RecordingOptions& options) {
  options.CheckWritable();
  RecordingReader reader(options.recording);
  ShowProblem(reader.problem());
  if (reader.header().program_version != PREDICTOR_VERSION)
    TheScreen().Print(
        Formatted("The recording was made by version %s, but this program is version %s. The "
                  "replay may therefore differ.",
                  Printable(reader.header().program_version).c_str(), PREDICTOR_VERSION));
  const RestoredScenario restored(reader.header());
  const Scenario& scenario = restored.Get();
  Progress progress("Verifying", static_cast<double>(reader.count()), options.quiet);
  const Verification result = Verify(
      &reader, scenario, [&](std::uint64_t ticks) { progress.Update(static_cast<double>(ticks)); });
  progress.Finish();
  if (result.ticks == 0)
    throw InputError(
        options.recording,
        "No tick could be compared, because the recording has no saved state to start from.");
  options.Write(TextOf(result), JsonOf(result));
  return result.departure ? kDeparted : kFinished;
}

}  // namespace predictor
