// Follows the records of a run. Like any other reader, the follower may be slow. The follower
// counts the records that it missed.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "core/loaded_hands.h"
#include "core/shared_run.h"
#include "core/words.h"
#include "devices/real_device.h"
#include "evaluation/summary.h"
#include "progress.h"
#include "recorded_run.h"
#include "results.h"
#include "safety/console_words.h"

namespace predictor {

struct FollowerOptions {
  bool quiet = false;
  std::string held;                   // printed when the arms have come to rest; may be empty
  RunRecording* recording = nullptr;  // may be null
  // This may be null. With real arms, the follower prints a message for each step to the person at
  // the console, who holds a key or an enabling device.
  const RealDevice* device = nullptr;
  bool enabling_device = false;
};

class Follower {
 public:
  // If the follower can no longer follow the run, it sets `quit`, which ends the run. All arguments
  // are borrowed.
  Follower(const RecordRing& ring, const Scenario& scenario, const FollowerOptions& options,
           std::atomic<bool>* quit);

  // Returns whether the run ended because it could no longer be followed. In this case, the summary
  // is incomplete.
  bool failed() const { return failed_; }
  Summary Finish();
  const ResultCurves& curves() const { return curves_; }  // complete after Finish

 private:
  void Fail(const char* why);
  void Follow();
  void RecordPageMarkers(const TickRecord& record);
  void ReportHeld(const TickRecord& record);
  void ReportRefusal(const TickRecord& record);
  void ReportToOperator(const TickRecord& record);

  RingReader<TickRecord, kRecordRing> reader_;
  FollowerOptions options_;
  std::array<std::uint8_t, kHands> warnings_ = {};  // warnings as last reported
  ConsoleWords words_;
  RefusalWords refusals_;
  const Scenario& scenario_;
  std::atomic<bool>* quit_;
  LoadedHands loaded_;
  bool is_held_ = false;
  SummaryBuilder builder_;
  ResultCurves curves_;
  Progress progress_;
  std::atomic<bool> done_{false}, failed_{false};
  std::thread thread_;
};

}  // namespace predictor
