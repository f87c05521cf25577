// The system calls that write a recording. Tests replace these calls by calls that fail.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace predictor {

// Each function behaves like the system call of the same name: it returns −1 and sets errno on
// failure.
class FileCalls {
 public:
  virtual ~FileCalls() = default;
  virtual int Create(const std::string& path);  // a new file for writing; existing files are kept
  virtual ssize_t Write(int fd, const void* bytes, std::size_t n, std::uint64_t at);  // pwrite
  virtual int DataSync(int fd);
  virtual int Truncate(int fd, std::uint64_t size);
  // Reserves space for the bytes [from, from + n) without changing the file's size.
  virtual int Reserve(int fd, std::uint64_t from, std::uint64_t n);
  virtual int Close(int fd);
  // Syncs the folder of the file, so that the file's name is durable.
  virtual int SyncFolder(const std::string& path);
  // Returns the free bytes on the file's device, or ~0 if they are unknown.
  virtual std::uint64_t FreeBytes(int fd);
};

}  // namespace predictor
