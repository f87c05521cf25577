// A recording in the viewer: what a page sees is a tick of it, and it says which.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/shared_run.h"
#include "recording/reader.h"

namespace predictor {

class Player {
 public:
  // All borrowed. Throws InputError if the recording holds no tick.
  Player(RecordingReader* reader, RunBoard* board, RunMailbox* mailbox);

  std::uint64_t first_tick() const { return first_.tick; }
  const TickRecord& first() const { return first_; }
  double duration() const { return duration_; }  // first to last tick [s]

  // Shows the first tick and plays on, as pages say, until `quit`. Throws InputError where the
  // recording is damaged.
  void Play(const std::atomic<bool>& quit);

  // One turn, `dt` [s] after the last; `now`: on the monotonic clock [ns], which takes the place of
  // the recorded one, since pages judge a state's age by it.
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
