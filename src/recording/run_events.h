// Describes the events of a run as text for its log.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/record.h"
#include "recording/header.h"

namespace predictor::recording {

// Compares each record with the previous one. Returns at most kMaxPerSecond events per second.
// Events about parameters have a lower priority than other events of the run. Events that were
// omitted are only counted.
class RunEvents {
 public:
  static constexpr int kMaxPerSecond = 50;

  // Returns the changes in this record at time `unix_ns`, or nothing for the first record.
  std::vector<RecordingEvent> Follow(const TickRecord& record, std::uint64_t unix_ns);

 private:
  void NewSecond(const TickRecord& record, std::uint64_t unix_ns);
  void FollowRun(const TickRecord& record);
  void FollowParameters(const TickRecord& record);
  void FollowWarnings(const TickRecord& record);
  void FollowHazards(const TickRecord& record);
  void Log(const TickRecord& record, const char* kind, std::string text, int most);

  bool began_ = false;
  RunState state_ = RunState::kInit;
  StopCause cause_ = StopCause::kNone, harder_ = StopCause::kNone;
  bool controller_late_ = false;
  std::array<std::uint8_t, kHands> warnings_ = {};  // currently active
  std::uint16_t hazards_ = 0;                       // hazards that are currently active
  std::uint8_t attachment_ = 0;
  std::uint8_t cobot_stop_ = 0;
  std::uint64_t second_ns_ = 0;  // the second in which events are counted
  int logged_ = 0;
  std::uint64_t left_out_ = 0;
  std::vector<RecordingEvent> events_;
};

}  // namespace predictor::recording
