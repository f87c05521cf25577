#include "recording/writer.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "recording/encoder.h"
#include "recording/mcap_file.h"

namespace predictor {

using Clock = std::chrono::steady_clock;

struct RecordingWriter::Impl {
  Impl(const std::string& path, const RecordingHeader& header, std::vector<JsonChannel> scene,
       FileCalls* given, const DiskRules& rules)
      : file(path, recording::MakePreamble(header, scene), given ? given : &calls),
        encoder(header, std::move(scene)),
        disk(rules),
        sync_period(rules.sync_period) {}

  template <class Add>
  void Encode(Add add) {
    if (closed) return;
    add(encoder);
    if (!encoder.Due()) return;
    Put();
    const std::string why = disk.Look(file);
    if (!why.empty()) Fail(why);
    if (Clock::now() - synced < sync_period) return;
    if (!file.Sync()) Fail(std::string("writing to the disk failed: ") + std::strerror(errno));
    synced = Clock::now();
  }
  void Put() {
    if (!file.Put(encoder.Take())) Fail(file.error());
  }
  void Close() {
    if (closed) return;
    if (!encoder.empty()) Put();
    closed = true;
    if (!file.End()) Fail(file.error());
  }
  [[noreturn]] void Fail(const std::string& why) {
    closed = true;
    throw RecordingError(file.EndBecause(why));
  }

  FileCalls calls;
  recording::McapFile file;
  recording::Encoder encoder;
  recording::DiskWatch disk;
  const std::chrono::milliseconds sync_period;
  Clock::time_point synced = Clock::now();
  bool closed = false;
};

RecordingWriter::RecordingWriter(const std::string& path, const RecordingHeader& header,
                                 std::vector<JsonChannel> scene, FileCalls* calls,
                                 const DiskRules& rules)
    : impl_(std::make_unique<Impl>(path, header, std::move(scene), calls, rules)) {}

RecordingWriter::~RecordingWriter() {
  try {
    Close();
  } catch (const std::exception&) {  // a caller that needs to know about errors calls Close()
  }
}

void RecordingWriter::Add(const TickRecord& record) {
  impl_->Encode([&](auto& encoder) { encoder.Add(record); });
}

void RecordingWriter::AddSnapshot(std::uint64_t tick, std::span<const std::byte> bytes) {
  impl_->Encode([&](auto& encoder) { encoder.AddSnapshot(tick, bytes); });
}

void RecordingWriter::AddEvent(const std::string& text, std::uint64_t tick) {
  impl_->Encode([&](auto& encoder) { encoder.AddEvent({tick, 0, "event", text, 0}); });
}

void RecordingWriter::NoteLoss(std::uint64_t count, std::uint64_t tick) {
  const std::string text = std::to_string(count) + " ticks are missing before this one";
  impl_->Encode([&](auto& encoder) { encoder.AddEvent({tick, 0, "loss", text, count}); });
}

void RecordingWriter::Close() { impl_->Close(); }
std::uint64_t RecordingWriter::bytes() const { return impl_->file.bytes(); }
std::uint64_t RecordingWriter::ticks() const { return impl_->file.ticks(); }

}  // namespace predictor
