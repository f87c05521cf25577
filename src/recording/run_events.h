// What happens in a run, told in words beside its numbers: for those who look at a log.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/record.h"
#include "recording/header.h"

namespace predictor::recording {

// Compares each record with the one before. At most kMostPerSecond events a second; those of a
// person's parameters give way to those of the run, and what is left out is counted.
class RunEvents {
 public:
  static constexpr int kMostPerSecond = 50;

  // What is new in this record, of time `unix_ns`; the first has nothing new.
  std::vector<RecordingEvent> Follow(const TickRecord& record, std::uint64_t unix_ns);

 private:
  void NewSecond(const TickRecord& record, std::uint64_t unix_ns);
  void FollowRun(const TickRecord& record);
  void FollowParameters(const TickRecord& record);
  void FollowWarnings(const TickRecord& record);
  void Tell(const TickRecord& record, const char* kind, std::string text, int most);

  bool began_ = false;
  RunState state_ = RunState::kInit;
  StopCause cause_ = StopCause::kNone, harder_ = StopCause::kNone;
  std::array<std::uint8_t, kHands> warnings_ = {};  // in force
  std::uint64_t second_ns_ = 0;                     // in which they are counted
  int told_ = 0;
  std::uint64_t left_out_ = 0;
  std::vector<RecordingEvent> events_;
};

}  // namespace predictor::recording
