// Writes a recording to the disk: the preamble, the chunks, and the index after them.
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

// The bytes before the first chunk, and their entries in the index.
struct Preamble {
  std::string bytes;                           // including the magic
  std::vector<std::string> schemas, channels;  // their records
  std::string attachment_indexes, metadata_indexes;
  std::uint32_t attachments = 0, metadata = 0;
  mcap::Attachment copy;  // written after the first chunk, in case the start of the file is damaged
};

// Reserves space for the index before it writes each chunk, so that the file is completed even on a
// full disk. Only Sync is thread-safe.
class McapFile {
 public:
  // Throws InputError if the file exists or cannot be created. `calls` is borrowed.
  McapFile(const std::string& path, const Preamble& preamble, FileCalls* calls);
  ~McapFile();  // ends the file
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;

  // Returns false if the chunk cannot be written. If the chunk cannot be written, the file is
  // unchanged, and error() gives the reason.
  bool Put(Chunk chunk);
  // Writes index and footer. No data can be added after this call. Returns false if the end of the
  // file cannot be written. The chunks can still be read in this case.
  bool End();
  // Ends the file early. Returns the outcome of the recording as sentences for the user.
  std::string EndBecause(const std::string& why);
  // Makes the written data durable in case of a loss of power. Any thread may call this function
  // while the file is open.
  bool Sync();
  std::uint64_t FreeBytes() const { return calls_->FreeBytes(fd_); }

  const std::string& error() const { return error_; }
  const std::string& path() const { return path_; }
  std::uint64_t bytes() const { return size_.load(); }
  std::uint64_t ticks() const { return ticks_.load(); }  // number of ticks in the written chunks

 private:
  bool Append(std::string_view bytes);
  bool Reserve(std::uint64_t bytes);  // starting at the end of the file
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
  std::uint64_t reserved_ = 0;  // end of the reserved space
  std::atomic<std::uint64_t> size_{0}, ticks_{0};
  std::atomic<std::uint64_t> durable_ticks_{0};  // ticks that the disk has confirmed
  std::atomic<bool> sync_failed_{false};
  std::uint32_t crc_ = 0;  // CRC of everything written
  Preamble preamble_;      // the preamble without its `bytes`
  std::vector<mcap::ChunkIndex> chunks_;
  std::uint64_t indexes_bytes_ = 0;  // size of chunks_ as records
  std::map<std::uint16_t, std::uint64_t> messages_;
};

}  // namespace predictor::recording
