#include "recording/mcap_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace predictor::recording {
namespace {

constexpr std::uint64_t kReserveAhead = 4U
                                        // [bytes]; large, so that space need not be reserved for
                                        // each chunk
                                        << 20U;

}  // namespace

McapFile::McapFile(const std::string& path, const Preamble& preamble, FileCalls* calls)
    : path_(path), calls_(calls), preamble_(preamble) {
  preamble_.bytes.clear();
  fd_ = calls_->Create(path);
  if (fd_ < 0 && errno == EEXIST)
    throw InputError(path,
                     "This file already exists, and a recording never overwrites a file. Choose "
                     "another name, or move the file.");
  if (fd_ < 0)
    throw InputError(path, std::string("The recording could not be written: ") +
                               std::strerror(errno) + ". Choose an existing, writable folder.");
  if (!Reserve(preamble.bytes.size() + EndingBytes()) || !Append(preamble.bytes)) {
    calls_->Close(fd_);
    throw InputError(
        path, "The recording could not be started: " + error_ + ". Choose a disk with more space.");
  }
  calls_->SyncFolder(path);
}

McapFile::~McapFile() {
  End();
  calls_->Close(fd_);
}

bool McapFile::Fail(const char* what) {
  if (error_.empty()) error_ = std::string(what) + ": " + std::strerror(errno);
  return false;
}

// If the file system cannot reserve space, the file is written without a reservation. In that case,
// the space may not suffice for the end of the file.
bool McapFile::Reserve(std::uint64_t bytes) {
  const std::uint64_t size = size_.load();
  if (!can_reserve_ || size + bytes <= reserved_) return true;
  for (const std::uint64_t ahead : {kReserveAhead, std::uint64_t{0}}) {
    if (calls_->Reserve(fd_, size, bytes + ahead) == 0) {
      reserved_ = size + bytes + ahead;
      return true;
    }
    if (errno != ENOSPC && errno != EDQUOT && errno != EFBIG) {
      can_reserve_ = false;
      return true;
    }
  }
  return Fail("no space");
}

bool McapFile::Append(std::string_view bytes) {
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const ssize_t n =
        calls_->Write(fd_, rest.data(), rest.size(), size_.load() + bytes.size() - rest.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      if (n == 0) errno = EIO;
      Fail("writing failed");
      // An unfinished chunk is removed, because a file must end with a complete chunk and the
      // file's end needs the space.
      if (rest.size() < bytes.size() && calls_->Truncate(fd_, size_.load()) != 0) ended_ = true;
      return false;
    }
    rest.remove_prefix(static_cast<std::size_t>(n));
  }
  crc_ = mcap::Crc(bytes, crc_);
  size_ += bytes.size();
  return true;
}

bool McapFile::Put(Chunk chunk) {
  if (ended_ || !error_.empty()) return false;
  const std::uint64_t at = size_.load();
  chunk.index.offset = at;
  for (auto& [channel, offset] : chunk.index.indexes) offset += at;
  const std::string copy = chunks_.empty() ? ToRecord(preamble_.copy) : "";
  const std::uint64_t copy_at = at + chunk.bytes.size();
  chunk.bytes += copy;
  const std::uint64_t index_bytes = ToRecord(chunk.index).size();
  if (!Reserve(chunk.bytes.size() + EndingBytes() + index_bytes)) return false;
  if (!Append(chunk.bytes)) return false;
  if (!copy.empty()) IndexCopy(copy_at, copy.size());
  chunks_.push_back(std::move(chunk.index));
  indexes_bytes_ += index_bytes;
  for (const auto& [channel, n] : chunk.messages) messages_[channel] += n;
  ticks_ += chunk.ticks;
  return true;
}

void McapFile::IndexCopy(std::uint64_t at, std::uint64_t bytes) {
  mcap::Bytes index;
  index.U64(at).U64(bytes).text += mcap::IndexOf(preamble_.copy);
  preamble_.attachment_indexes += mcap::Record(mcap::Op::kAttachmentIndex, index.text);
  ++preamble_.attachments;
  preamble_.copy.data.clear();
}

std::string McapFile::Statistics() const {
  std::uint64_t total = 0, start = 0, end = 0;
  for (const auto& [channel, n] : messages_) total += n;
  for (const mcap::ChunkIndex& chunk : chunks_) {
    start = start == 0 ? chunk.start_time : std::min(start, chunk.start_time);
    end = std::max(end, chunk.end_time);
  }
  mcap::Bytes content;
  content.U64(total).U16(static_cast<std::uint16_t>(preamble_.schemas.size()));
  content.U32(static_cast<std::uint32_t>(preamble_.channels.size()));
  content.U32(preamble_.attachments).U32(preamble_.metadata);
  content.U32(static_cast<std::uint32_t>(chunks_.size())).U64(start).U64(end).Offsets(messages_);
  return mcap::Record(mcap::Op::kStatistics, content.text);
}

// The end of the file consists of data end, summary, summary offsets, footer and magic.
std::string McapFile::Ending() const {
  mcap::Bytes end;
  end.text = mcap::Record(mcap::Op::kDataEnd, mcap::Bytes().U32(crc_).text);
  const std::uint64_t start = size_.load() + end.text.size();
  std::string summary, offsets;
  const auto group = [&](mcap::Op op, const std::string& records) {
    if (records.empty()) return;
    mcap::Bytes offset;
    offset.Number(op).U64(start + summary.size()).U64(records.size());
    offsets += mcap::Record(mcap::Op::kSummaryOffset, offset.text);
    summary += records;
  };
  std::string schemas, channels, indexes;
  for (const std::string& record : preamble_.schemas) schemas += record;
  for (const std::string& record : preamble_.channels) channels += record;
  for (const mcap::ChunkIndex& chunk : chunks_) indexes += ToRecord(chunk);
  group(mcap::Op::kSchema, schemas);
  group(mcap::Op::kChannel, channels);
  group(mcap::Op::kStatistics, Statistics());
  group(mcap::Op::kChunkIndex, indexes);
  group(mcap::Op::kAttachmentIndex, preamble_.attachment_indexes);
  group(mcap::Op::kMetadataIndex, preamble_.metadata_indexes);
  mcap::Bytes footer;
  footer.Number(mcap::Op::kFooter).U64(20).U64(start).U64(start + summary.size());
  const std::string checked = summary + offsets + footer.text;
  end.text += checked;
  end.U32(mcap::Crc(checked));
  end.text += mcap::kMagic;
  return std::move(end.text);
}

std::uint64_t McapFile::EndingBytes() const {
  std::uint64_t bytes = 4096 + indexes_bytes_ + preamble_.attachment_indexes.size() +
                        preamble_.metadata_indexes.size();
  for (const std::string& record : preamble_.schemas) bytes += record.size();
  for (const std::string& record : preamble_.channels) bytes += record.size() + 16;
  return bytes;
}

bool McapFile::End() {
  if (ended_) return false;
  ended_ = true;
  const std::string before = error_;
  const bool written = Append(Ending());
  // Unused reserved space is released.
  if (reserved_ > size_.load()) std::ignore = calls_->Truncate(fd_, size_.load());
  const bool lasts = calls_->DataSync(fd_) == 0 || Fail("writing to the disk failed");
  if (!before.empty()) error_ = before;
  return written && lasts;
}

std::string McapFile::EndBecause(const std::string& why) {
  // If a synchronisation fails, the system may report success for the next one although data have
  // been lost.
  const bool lasts = End() && !sync_failed_;
  const std::string sentence = path_ + ": The recording ended: " + why + ". ";
  const std::string ticks = std::to_string(ticks_.load()) + " ticks";
  if (lasts) return sentence + ticks + " were stored and can be read.";
  return sentence + "The disk confirmed " + std::to_string(durable_ticks_.load()) + " of " + ticks +
         "; the others may be damaged or lost. Copy the file to another disk and repair it there "
         "with `predictor repair`.";
}

bool McapFile::Sync() {
  const std::uint64_t ticks = ticks_;
  if (calls_->DataSync(fd_) == 0)
    durable_ticks_ = ticks;
  else
    sync_failed_ = true;
  return !sync_failed_;
}

}  // namespace predictor::recording
