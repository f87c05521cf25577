// Encodes records, snapshots and events into chunks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/head_record.h"
#include "core/person_state.h"
#include "core/stream_sample.h"
#include "core/tick_fields.h"
#include "recording/chunk.h"
#include "recording/header.h"
#include "recording/preamble.h"
#include "recording/run_events.h"

namespace predictor::recording {

inline constexpr std::size_t kChunkBytes = 1U << 20U;        // size at which a chunk ends
inline constexpr std::uint64_t kChunkTime = 500'000'000;     // age at which a chunk ends [ns]
inline constexpr std::uint64_t kScenePeriod = 40'000'000;    // period of JSON messages [ns]
inline constexpr std::size_t kLargestSnapshot = 32U << 20U;  // [bytes]
inline constexpr std::size_t kLargestChunk = 2 * kLargestSnapshot;  // uncompressed [bytes]

// Starts the CRC of a tick with the tick's log time [ns].
std::uint32_t CrcOf(std::uint64_t time);

std::string EventText(const RecordingEvent& event);
bool ParseEvent(std::string_view json, RecordingEvent* event);

class Encoder {
 public:
  Encoder(const RecordingHeader& header, std::vector<JsonChannel> scene);

  // Adds the tick and its events.
  void Add(const TickRecord& record);
  // Throws std::invalid_argument if the data exceed kLargestSnapshot.
  void AddSnapshot(std::uint64_t tick, std::span<const std::byte> data);
  void AddEvent(const RecordingEvent& event);  // sets the event's time
  // Adds a state of the person if the recording has a topic for them.
  void AddPerson(const PersonState& state);
  // Adds a measured head, at the newest tick, if the recording has a topic for heads. A head from
  // before the first tick or after the newest one is left out.
  void AddHead(const HeadRecord& head, std::uint64_t tick);

  // Adds the description of a stream, a JSON object, at the newest tick, if the recording has a
  // topic for it.
  void AddStream(std::size_t stream, const std::string& description, std::uint64_t tick);
  // Adds successive samples of one stream likewise. Samples from before the first tick are left
  // out, and so are all samples if the first one is later than the newest tick.
  void AddSamples(std::span<const StreamSample> samples, std::uint64_t tick);

  // Returns whether a chunk should be taken.
  bool Due() const;
  bool empty() const { return chunk_.empty(); }
  Chunk Take() { return chunk_.Finish(); }

 private:
  std::uint64_t TimeOf(const TickRecord& record);
  template <class R>
  void AddGroup(TickGroup group, const R& record, std::uint64_t time);
  void AddScene(const TickRecord& record, std::uint64_t time);

  double dt_;
  std::uint64_t start_ns_;
  std::vector<JsonChannel> scene_;
  std::uint16_t person_channel_, head_channel_, streams_channel_, samples_channel_;  // 0: none
  RunEvents run_events_;
  ChunkBuilder chunk_;
  std::uint64_t first_wall_ns_ = 0;
  std::uint64_t now_ns_;        // time of the newest record
  std::uint64_t scene_ns_ = 0;  // time of the last scene
  std::uint32_t crc_ = 0;       // CRC of the tick's messages so far
  std::uint32_t events_ = 0, snapshots_ = 0;
};

}  // namespace predictor::recording
