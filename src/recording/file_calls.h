// The calls of the system that a recording is written by, so that a test may let them fail.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace predictor {

// Each as the system's call of that name: −1 and errno if it fails.
class FileCalls {
 public:
  virtual ~FileCalls() = default;
  virtual int Create(const std::string& path);  // new, for writing; what is there stays
  virtual ssize_t Write(int fd, const void* bytes, std::size_t n, std::uint64_t at);  // pwrite
  virtual int DataSync(int fd);
  virtual int Truncate(int fd, std::uint64_t size);
  // Space for the bytes [from, from + n) without changing the size.
  virtual int Reserve(int fd, std::uint64_t from, std::uint64_t n);
  virtual int Close(int fd);
  virtual int SyncFolder(const std::string& path);  // of the file: that its name lasts
  // Where the file lies; ~0 if it cannot be told.
  virtual std::uint64_t FreeBytes(int fd);
};

}  // namespace predictor
