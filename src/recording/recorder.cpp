#include "recording/recorder.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/contained_thread.h"
#include "recording/encoder.h"
#include "recording/mcap_file.h"
#include "recording/sample_stream.h"

namespace predictor {
namespace {

using Clock = std::chrono::steady_clock;
using recording::Chunk;
using std::chrono::milliseconds;

constexpr milliseconds kPause{10};         // pause between polls of the ring
constexpr milliseconds kChunkPeriod{500};  // longest time that a chunk waits for more data
// interval between two events about lost ticks [ns]
constexpr std::uint64_t kLossPeriod = 1'000'000'000;
constexpr std::uint64_t kBatchTime =
    100'000'000;  // for which samples of a stream are collected [ns]

constexpr int kThrown = -1;  // means an exception where an errno value is expected

// Stores the text, or a shorter text if memory is insufficient.
void Note(const char* why, std::string* text) noexcept {
  try {
    *text = why;
  } catch (const std::exception&) {
    *text = "out of memory";
  }
}

// The chunks that wait to be written to the disk.
class ChunkQueue {
 public:
  explicit ChunkQueue(std::size_t most) : most_(most) {}
  // Waits for space. Returns false once the queue has ended.
  bool Push(Chunk chunk) {
    std::unique_lock lock(mutex_);
    change_.wait(lock, [this] { return bytes_ < most_ || abandoned_; });
    if (abandoned_) return false;
    bytes_ += chunk.bytes.size();
    chunks_.push_back(std::move(chunk));
    change_.notify_all();
    return true;
  }
  void NoMore() {
    const std::scoped_lock lock(mutex_);
    no_more_ = true;
    change_.notify_all();
  }
  void Abandon() {
    const std::scoped_lock lock(mutex_);
    abandoned_ = true;
    change_.notify_all();
  }
  // Returns the next chunk, if one arrives within `patience`.
  std::optional<Chunk> Take(milliseconds patience) {
    std::unique_lock lock(mutex_);
    change_.wait_for(lock, patience, [this] { return !chunks_.empty() || no_more_; });
    if (chunks_.empty()) return {};
    Chunk chunk = std::move(chunks_.front());
    chunks_.pop_front();
    bytes_ -= chunk.bytes.size();
    change_.notify_all();
    return chunk;
  }
  bool Done() const {
    const std::scoped_lock lock(mutex_);
    return no_more_ && chunks_.empty();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable change_;
  const std::size_t most_;  // [bytes]
  std::deque<Chunk> chunks_;
  std::size_t bytes_ = 0;
  bool no_more_ = false, abandoned_ = false;
};

// A buffer that the tick and the recorder pass to each other.
class SnapshotBox {
 public:
  explicit SnapshotBox(std::size_t bytes) : buffer_(bytes) {}

  std::span<std::byte> Buffer() noexcept {
    if (state_.load(std::memory_order_acquire) != kWanted) return {};
    return buffer_;
  }
  void Taken(std::uint64_t tick, std::size_t bytes) noexcept {
    if (state_.load(std::memory_order_relaxed) != kWanted) return;
    tick_ = tick;
    bytes_ = bytes <= buffer_.size() ? bytes : 0;
    state_.store(kTaken, std::memory_order_release);
  }
  // Returns false while the previous snapshot is still being passed on.
  bool Want() {
    int idle = kIdle;
    return state_.compare_exchange_strong(idle, kWanted, std::memory_order_acq_rel);
  }
  void MoveTo(recording::Encoder* encoder) {
    if (state_.load(std::memory_order_acquire) != kTaken) return;
    if (bytes_ > 0) encoder->AddSnapshot(tick_, std::span(buffer_).first(bytes_));
    state_.store(kIdle, std::memory_order_release);
  }

 private:
  enum State : int { kIdle, kWanted, kTaken };
  std::atomic<int> state_{kIdle};
  std::vector<std::byte> buffer_;
  std::uint64_t tick_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace

struct Recorder::Impl {
  Impl(const std::string& path, const RecordingHeader& header, const RecordRing& ring,
       RecorderOptions given, std::vector<JsonChannel> scene, FileCalls* given_calls)
      : options(std::move(given)),
        reader(ring),
        snapshot(options.snapshot_bytes),
        file(path, recording::MakePreamble(header, scene), given_calls ? given_calls : &calls),
        encoder(header, std::move(scene)),
        queue(options.max_queued),
        disk(options) {
    if (options.person) persons.emplace(options.person->states);
    if (options.heads) heads.emplace(*options.heads);
    if (options.samples) samples.emplace(*options.samples);
    free_bytes = file.FreeBytes();
    encodes = ContainedThread(
        "record encode", [this] { Encode(); }, [this](const char* why) { EncodingFailed(why); });
    writes = ContainedThread(
        "record write", [this] { Write(); }, [this](const char* why) { WritingFailed(why); });
    syncs = ContainedThread(
        "record sync", [this] { Sync(); }, [this](const char* why) { SyncFailed(why); });
  }

  // ---- reading the ring -------------------------------------------------------------------------

  void Encode();
  void EncodingFailed(const char* why);
  void Drain();
  void FollowLoss(const TickRecord& record);
  void NoteLoss(std::uint64_t tick);
  void TakeMarks();
  void TakePersons(bool all);
  void TakeHeads(bool all);
  void TakeSamples(bool all);
  void Collect(const StreamSample& sample);
  bool Pass(bool all);

  // ---- writing ----------------------------------------------------------------------------------

  void Write();
  void WritingFailed(const char* why);
  void End(const std::string& why);
  void LookAtDisk();
  void Sync();
  void SyncFailed(const char* why);
  std::string SyncProblem() const;
  void Close();

  void Notify(const std::string& sentence) const {
    if (options.notify) options.notify(sentence);
  }

  FileCalls calls;
  const RecorderOptions options;
  RingReader<TickRecord, kRecordRing> reader;
  std::optional<RingReader<PersonState, kPersonRing>> persons;
  std::optional<RingReader<HeadRecord, kHeadRing>> heads;
  std::optional<RingReader<StreamSample, kStreamRing>> samples;
  SnapshotBox snapshot;
  recording::McapFile file;
  recording::Encoder encoder;
  ChunkQueue queue;

  // Only the thread that encodes uses the following members.
  std::uint64_t newest = 0;            // tick
  std::uint64_t newest_ns = 0;         // its monotonic clock
  std::optional<PersonState> waiting;  // the person's next state
  std::optional<HeadRecord> next_head;
  std::optional<StreamSample> next_sample;
  std::array<std::vector<StreamSample>, kMaxStreams> batches;  // samples for the next messages
  std::map<std::uint32_t, std::uint32_t> counts;  // channels of each stream, which stay the same
  bool described = false;                 // whether the streams' descriptions are in the recording
  std::uint64_t seen = 0;                 // number of lost ticks noticed so far
  std::uint64_t noted = 0;                // number of them that an event in the file reports
  std::uint64_t holes = 0;                // gaps covered by one event
  std::optional<std::uint64_t> noted_ns;  // time of the last such event, by the clock of the
                                          // records
  Clock::time_point passed = Clock::now();
  std::optional<Clock::time_point> asked;  // time of the last request for a snapshot
  bool wants_snapshot = false;

  // Only the thread that writes uses the following members.
  recording::DiskWatch disk;
  bool ended = false;

  std::atomic<bool> closing{false};
  std::atomic<std::uint64_t> lost{0}, free_bytes{0};
  std::atomic<int> sync_error{0};  // errno, or kThrown: `sync_thrown` contains the text

  mutable std::mutex mutex;
  std::condition_variable change;
  std::deque<RecordingEvent> marks;
  std::string ended_why, encode_error, sync_thrown;
  bool recording = true, stop_syncing = false;

  std::thread encodes, writes, syncs;
};

void Recorder::Impl::Encode() {
  for (bool last = false; !last;) {
    last = closing.load();
    const std::uint64_t before = newest;
    Drain();
    if (last && holes > 0) NoteLoss(newest);
    TakeMarks();
    TakePersons(last);
    TakeHeads(last);
    TakeSamples(last);
    snapshot.MoveTo(&encoder);
    if (wants_snapshot && snapshot.Want()) wants_snapshot = false;
    if (!Pass(last)) break;
    if (!last && newest == before) std::this_thread::sleep_for(kPause);
  }
  queue.NoMore();
}

// All chunks that are already in the queue are still written. Then the recording ends.
void Recorder::Impl::EncodingFailed(const char* why) {
  {
    const std::scoped_lock lock(mutex);
    Note(why, &encode_error);
  }
  queue.NoMore();
}

void Recorder::Impl::Drain() {
  TickRecord record;
  for (std::size_t k = 0; k < kRecordRing && reader.Next(&record); ++k) {
    FollowLoss(record);
    encoder.Add(record);
    newest = record.tick;
    newest_ns = record.wall_ns;
    const auto now = Clock::now();
    if (!asked || now - *asked >= options.snapshot_period) {
      asked = now;
      wants_snapshot = true;
    }
    if (encoder.Due() && !Pass(false)) return;
  }
}

// A recorder with too little processor time finds many gaps. A recorder therefore reports all gaps
// within a second as one event.
void Recorder::Impl::FollowLoss(const TickRecord& record) {
  if (reader.lost() > seen) {
    seen = reader.lost();
    lost = seen;
    ++holes;
    asked.reset();
  }
  if (holes > 0 && (!noted_ns || record.wall_ns - *noted_ns >= kLossPeriod)) {
    noted_ns = record.wall_ns;
    NoteLoss(record.tick);
  }
}

void Recorder::Impl::NoteLoss(std::uint64_t tick) {
  const std::uint64_t missing = seen - noted;
  std::string text = std::to_string(missing) + " ticks are missing before this one";
  if (holes > 1) text += ", in " + std::to_string(holes) + " places";
  encoder.AddEvent({tick, 0, "loss", std::move(text), missing});
  noted = seen;
  holes = 0;
}

void Recorder::Impl::TakeMarks() {
  std::deque<RecordingEvent> taken;
  {
    const std::scoped_lock lock(mutex);
    taken.swap(marks);
  }
  for (RecordingEvent& mark : taken) {
    mark.tick = newest;
    encoder.AddEvent(mark);
  }
}

// A person's state that was read before its tick waits for this tick, because the state is stored
// with the tick's time. States that were overwritten are missing from the recording, and no event
// reports them, because nothing depends on them.
void Recorder::Impl::TakePersons(bool all) {
  for (std::size_t k = 0; persons && k < kPersonRing; ++k) {
    PersonState state;
    if (!waiting && persons->Next(&state)) waiting = state;
    if (!waiting || (!all && waiting->tick > newest)) return;
    encoder.AddPerson(*waiting);
    waiting.reset();
  }
}

// A head that was measured after the newest tick waits, because the encoder relates its clock to
// the ticks. A head that is not credible is left out, because another process measured the head.
void Recorder::Impl::TakeHeads(bool all) {
  for (std::size_t k = 0; heads && k < kHeadRing; ++k) {
    HeadRecord head;
    if (!next_head && heads->Next(&head)) next_head = head;
    if (!next_head) return;
    const bool is_credible = IsCredible(*next_head, newest_ns);
    if (is_credible && next_head->wall_ns > newest_ns && !all) return;
    if (is_credible) encoder.AddHead(*next_head, newest);
    next_head.reset();
  }
}

// Samples wait as heads do. They are collected, because a message for each takes more space.
void Recorder::Impl::TakeSamples(bool all) {
  if (!samples || newest_ns == 0) return;
  if (!std::exchange(described, true))
    for (std::size_t i = 0; i < options.streams.size(); ++i)
      encoder.AddStream(i, options.streams[i], newest);
  for (std::size_t k = 0; k < kStreamRing; ++k) {
    StreamSample sample;
    if (!next_sample && samples->Next(&sample)) next_sample = sample;
    if (!next_sample) break;
    const bool is_credible = IsCredible(*next_sample, newest_ns);
    if (is_credible && next_sample->wall_ns > newest_ns && !all) break;
    if (is_credible) Collect(*next_sample);
    next_sample.reset();
  }
  for (std::vector<StreamSample>& batch : batches)
    if (!batch.empty() && (all || newest_ns - batch.front().wall_ns > kBatchTime))
      encoder.AddSamples(std::exchange(batch, {}), newest);
}

void Recorder::Impl::Collect(const StreamSample& sample) {
  if (sample.stream >= options.streams.size()) return;
  if (counts.try_emplace(sample.stream, sample.count).first->second != sample.count) return;
  std::vector<StreamSample>& batch = batches[sample.stream];
  // A message has one offset, and ascending times.
  const bool begins = !batch.empty() && (sample.clock_offset != batch.back().clock_offset ||
                                         sample.wall_ns <= batch.back().wall_ns ||
                                         sample.wall_ns - batch.front().wall_ns > 10 * kBatchTime);
  if (begins || batch.size() == recording::kMaxSamplesInMessage)
    encoder.AddSamples(std::exchange(batch, {}), newest);
  batch.push_back(sample);
}

// Passes on the data that are due or, if `all` is true, all data. Returns false if the queue has
// ended.
bool Recorder::Impl::Pass(bool all) {
  const auto now = Clock::now();
  if (encoder.empty()) passed = now;
  if (!encoder.Due() && !(all && !encoder.empty()) && now - passed < kChunkPeriod) return true;
  if (encoder.empty()) return true;
  passed = now;
  return queue.Push(encoder.Take());
}

void Recorder::Impl::Write() {
  while (!ended && !queue.Done()) {
    std::optional<Chunk> chunk = queue.Take(milliseconds(100));
    if (chunk && !file.Put(std::move(*chunk))) {
      End(file.error());
    } else if (sync_error != 0) {
      End("writing to the disk failed: " + SyncProblem());
    } else {
      LookAtDisk();
    }
  }
  std::string error;
  {
    const std::scoped_lock lock(mutex);
    error = encode_error;
  }
  if (!ended && !error.empty()) End(error);
  if (!ended && !file.End()) End(file.error());
  const std::scoped_lock lock(mutex);
  recording = false;
}

// If the recording had already ended, only its final event could not be recorded.
void Recorder::Impl::WritingFailed(const char* why) {
  queue.Abandon();
  {
    const std::scoped_lock lock(mutex);
    if (!std::exchange(recording, false)) return;
    Note(why, &ended_why);
  }
  End(why);
}

void Recorder::Impl::End(const std::string& why) {
  ended = true;
  queue.Abandon();
  const std::string sentence = file.EndBecause(why);
  {
    const std::scoped_lock lock(mutex);
    ended_why = sentence;
    recording = false;
  }
  Notify(sentence);
}

void Recorder::Impl::LookAtDisk() {
  const std::string why = disk.Look(file);
  free_bytes = disk.free_bytes();
  if (!why.empty()) End(why);
}

void Recorder::Impl::Sync() {
  std::uint64_t synced = 0;
  std::unique_lock lock(mutex);
  while (!stop_syncing) {
    change.wait_for(lock, options.sync_period, [this] { return stop_syncing; });
    const std::uint64_t bytes = file.bytes();
    if (stop_syncing || bytes == synced) continue;
    lock.unlock();
    if (!file.Sync()) sync_error = errno;
    synced = bytes;
    lock.lock();
  }
}

void Recorder::Impl::SyncFailed(const char* why) {
  const std::scoped_lock lock(mutex);
  Note(why, &sync_thrown);
  sync_error = kThrown;
}

std::string Recorder::Impl::SyncProblem() const {
  const int error = sync_error;
  if (error != kThrown) return std::strerror(error);
  const std::scoped_lock lock(mutex);
  return sync_thrown;
}

void Recorder::Impl::Close() {
  if (!encodes.joinable()) return;
  closing = true;
  encodes.join();
  writes.join();
  {
    const std::scoped_lock lock(mutex);
    stop_syncing = true;
    change.notify_all();
  }
  syncs.join();
}

Recorder::Recorder(const std::string& path, const RecordingHeader& header, const RecordRing& ring,
                   RecorderOptions options, std::vector<JsonChannel> scene, FileCalls* calls)
    : impl_(std::make_unique<Impl>(path, header, ring, std::move(options), std::move(scene),
                                   calls)) {}

Recorder::~Recorder() { Close(); }

std::span<std::byte> Recorder::SnapshotBuffer() noexcept { return impl_->snapshot.Buffer(); }
void Recorder::SnapshotTaken(std::uint64_t tick, std::size_t bytes) noexcept {
  impl_->snapshot.Taken(tick, bytes);
}

void Recorder::Mark(const std::string& text) {
  const std::scoped_lock lock(impl_->mutex);
  impl_->marks.push_back({0, 0, "marker", text, 0});
}

RecorderStatus Recorder::status() const {
  RecorderStatus status;
  status.bytes = impl_->file.bytes();
  status.ticks = impl_->file.ticks();
  status.lost = impl_->lost;
  status.free_bytes = impl_->free_bytes;
  const std::scoped_lock lock(impl_->mutex);
  status.recording = impl_->recording;
  status.ended_why = impl_->ended_why;
  return status;
}

void Recorder::Close() { impl_->Close(); }

}  // namespace predictor
