// Plays a recording in the viewer: each state that a page shows is a recorded tick.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/shared_run.h"
#include "recording/reader.h"

namespace predictor {

class Player {
 public:
  // All arguments are borrowed. Throws InputError if the recording contains no ticks.
  Player(RecordingReader* reader, RunBoard* board, RunMailbox* mailbox);

  std::uint64_t first_tick() const { return first_.tick; }
  const TickRecord& first() const { return first_; }
  double duration() const { return duration_; }  // from the first to the last tick [s]

  // Shows the first tick and then follows the pages' commands until `quit` is set. Throws
  // InputError if the recording is damaged.
  void Play(const std::atomic<bool>& quit);

  // Advances by `dt` [s]. `now`, the monotonic clock [ns], replaces the recorded time, because
  // pages determine a state's age from it.
  void Step(double dt, std::uint64_t now);
  double position() const { return position_; }  // since the first tick [s]
  double speed() const { return speed_; }        // 0: paused

 private:
  void TakeInputs();
  void MoveTo(double position);

  RecordingReader* reader_;
  RunBoard* board_;
  RunMailbox* mailbox_;
  double dt_;  // of a tick [s]
  TickRecord first_, shown_;
  double duration_ = 0, position_ = 0, speed_ = 1;
  std::uint32_t stops_ = 0;
};

}  // namespace predictor
