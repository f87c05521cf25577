#include "player.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/error.h"

namespace predictor {
namespace {

constexpr double kTurn = 0.01;  // between two displayed states [s]
// For distances up to this, reading on is cheaper than seeking [s].
constexpr double kNear = 2;

std::uint64_t Nanoseconds(std::chrono::steady_clock::time_point t) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count());
}

// Number of the last tick of a recording, which may have gaps.
std::uint64_t LastTick(RecordingReader* reader, const TickRecord& first) {
  TickRecord last = first;
  reader->Seek(first.tick + std::max<std::uint64_t>(reader->count(), 1) - 1);
  while (reader->Next(&last)) {
  }
  return last.tick;
}

}  // namespace

Player::Player(RecordingReader* reader, RunBoard* board, RunMailbox* mailbox)
    : reader_(reader), board_(board), mailbox_(mailbox), dt_(reader->header().dt) {
  if (!(dt_ > 0) || !reader_->Next(&first_))
    throw InputError("The recording has no ticks, so there is nothing to show.");
  duration_ = static_cast<double>(LastTick(reader_, first_) - first_.tick) * dt_;
  reader_->Seek(first_.tick);
  reader_->Next(&shown_);
}

void Player::Play(const std::atomic<bool>& quit) {
  auto last = std::chrono::steady_clock::now();
  while (!quit) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kTurn));
    const auto now = std::chrono::steady_clock::now();
    Step(std::chrono::duration<double>(now - last).count(), Nanoseconds(now));
    last = now;
  }
}

void Player::Step(double dt, std::uint64_t now) {
  TakeInputs();
  MoveTo(std::clamp(position_ + speed_ * dt, 0.0, duration_));
  if (position_ >= duration_) speed_ = 0;
  TickRecord record = shown_;
  record.wall_ns = now;
  board_->records.Publish(record);
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

// Shows the last tick at or before `position`, or the next one after a gap.
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
  }
}

}  // namespace predictor
