#include "follower.h"

#include <chrono>

#include "core/contained_thread.h"
#include "core/message_catalogue.h"
#include "screen.h"
#include "viewer/scene_description.h"

namespace predictor {

Follower::Follower(const RecordRing& ring, const Scenario& scenario, const FollowerOptions& options,
                   std::atomic<bool>* quit)
    : reader_(ring),
      options_(options),
      words_(options.enabling_device, scenario.rate),
      refusals_(scenario.rate),
      scenario_(scenario),
      quit_(quit),
      loaded_(kFreeForce, scenario.rate, options.enabling_device),
      builder_(scenario),
      curves_(scenario),
      progress_("Running", scenario.duration, options.quiet || scenario.duration <= 0),
      thread_(ContainedThread(
          "follower", [this] { Follow(); }, [this](const char* why) { Fail(why); })) {}

Summary Follower::Finish() {
  done_.store(true);
  thread_.join();
  progress_.Finish();
  Summary summary = builder_.summary();
  summary.records_dropped = reader_.lost();
  return summary;
}

// Ends the run, because a person who cannot see the arms' state must not be asked to hold the
// handles.
void Follower::Fail(const char* why) {
  failed_ = true;
  *quit_ = true;
  TheScreen().Print(
      std::string("The run was ended, because this program can no longer monitor it (") + why +
      ").");
}

void Follower::Follow() {
  for (bool last = false; !last;) {
    last = done_.load();
    if (options_.recording) options_.recording->Look();
    TickRecord record;
    while (reader_.Next(&record)) {
      builder_.Add(record);
      curves_.Add(record);
      RecordPageMarkers(record);
      if (record.tick % 64 == 0 && !is_held_) progress_.Update(record.run_time, Name(record.state));
      ReportHeld(record);
      if (options_.device)
        ReportToOperator(record);
      else
        ReportRefusal(record);
    }
    if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void Follower::RecordPageMarkers(const TickRecord& record) {
  for (std::size_t i = 0; options_.recording && i < record.input_count; ++i)
    if (record.inputs[i].kind == InputKind::kMarker)
      options_.recording->Mark("marker of page " + std::to_string(record.inputs[i].client));
}

void Follower::ReportHeld(const TickRecord& record) {
  const bool held = record.state == RunState::kHeld || record.state == RunState::kUnpowered;
  if (is_held_ && !held)
    if (const std::string kept = viewer::KeptThresholds(scenario_, record); !kept.empty())
      TheScreen().Print(kept);
  if (held && !is_held_) progress_.Finish();
  if (held && !is_held_ && !options_.held.empty())
    TheScreen().Print(record.cause == StopCause::kNone
                          ? "Done. " + options_.held
                          : Message("stop.after", {{"state", Name(record.state)},
                                                   {"name", Name(record.cause)},
                                                   {"cause", StopCauseWords(record)}}) +
                                " " + options_.held);
  is_held_ = held;
}

// Reports why a page's request was refused. The pages show the same text.
void Follower::ReportRefusal(const TickRecord& record) {
  if (const std::string why = refusals_.See(record); !why.empty()) TheScreen().Print(why);
}

void Follower::ReportToOperator(const TickRecord& record) {
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    for (const std::string& words : NewWarnings(warnings_[hand], record.hands[hand], hand))
      TheScreen().Print(words);
    warnings_[hand] = record.hands[hand].warnings;
  }
  for (const std::string& words : words_.See(record, [this] { return options_.device->Trouble(); }))
    TheScreen().Print(words);
  for (const std::string& words : loaded_.See(record)) TheScreen().Print(words);
}

}  // namespace predictor
