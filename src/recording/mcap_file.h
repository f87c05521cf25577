// A recording on the disk: what is before the chunks, chunk by chunk, and the index behind them.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "recording/chunk.h"
#include "recording/file_calls.h"
#include "recording/mcap.h"

namespace predictor::recording {

// What stands before the first chunk, and what the index says of it.
struct Preamble {
  std::string bytes;                           // with the magic
  std::vector<std::string> schemas, channels;  // their records
  std::string attachment_indexes, metadata_indexes;
  std::uint32_t attachments = 0, metadata = 0;
  mcap::Attachment copy;  // goes behind the first chunk: what damage there must not take
};

// Space for the index is reserved before each chunk is written: on a full disk the file still gets
// its end, and is whole. Not for several threads, but for Sync.
class McapFile {
 public:
  // Throws InputError if there is such a file already or it cannot be made; `calls` is borrowed.
  McapFile(const std::string& path, const Preamble& preamble, FileCalls* calls);
  ~McapFile();  // ends the file
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;

  // False if it could not: then the file is as before, and error() says why.
  bool Put(Chunk chunk);
  // Writes index and footer; nothing can be put any more. False as above: the chunks are readable
  // all the same.
  bool End();
  // Ends the file before its time; what became of the recording, in sentences for a person.
  std::string EndBecause(const std::string& why);
  // That what was put lasts through a loss of power; from any thread, while it is open.
  bool Sync();
  std::uint64_t FreeBytes() const { return calls_->FreeBytes(fd_); }

  const std::string& error() const { return error_; }
  const std::string& path() const { return path_; }
  std::uint64_t bytes() const { return size_.load(); }
  std::uint64_t ticks() const { return ticks_.load(); }  // in the chunks that were put

 private:
  bool Append(std::string_view bytes);
  bool Reserve(std::uint64_t bytes);  // from the file's end on
  bool Fail(const char* what);
  void IndexCopy(std::uint64_t at, std::uint64_t bytes);
  std::string Ending() const;
  std::string Statistics() const;
  std::uint64_t EndingBytes() const;

  const std::string path_;
  FileCalls* calls_;
  int fd_ = -1;
  std::string error_;
  bool ended_ = false;
  bool can_reserve_ = true;
  std::uint64_t reserved_ = 0;  // end of what is reserved
  std::atomic<std::uint64_t> size_{0}, ticks_{0};
  std::atomic<std::uint64_t> durable_ticks_{0};  // that the disk has said to have
  std::atomic<bool> sync_failed_{false};
  std::uint32_t crc_ = 0;  // of all that was written
  Preamble preamble_;      // without its bytes
  std::vector<mcap::ChunkIndex> chunks_;
  std::uint64_t indexes_bytes_ = 0;  // of chunks_, as records
  std::map<std::uint16_t, std::uint64_t> messages_;
};

}  // namespace predictor::recording
