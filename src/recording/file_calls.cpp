#include "recording/file_calls.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <filesystem>

namespace predictor {

int FileCalls::Create(const std::string& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
}
ssize_t FileCalls::Write(int fd, const void* bytes, std::size_t n, std::uint64_t at) {
  return ::pwrite(fd, bytes, n, static_cast<off_t>(at));
}
int FileCalls::DataSync(int fd) { return ::fdatasync(fd); }
int FileCalls::Truncate(int fd, std::uint64_t size) {
  return ::ftruncate(fd, static_cast<off_t>(size));
}
int FileCalls::Reserve(int fd, std::uint64_t from, std::uint64_t n) {
  return ::fallocate(fd, FALLOC_FL_KEEP_SIZE, static_cast<off_t>(from), static_cast<off_t>(n));
}
int FileCalls::Close(int fd) { return ::close(fd); }

int FileCalls::SyncFolder(const std::string& path) {
  const auto folder = std::filesystem::absolute(path).parent_path();
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return -1;
  const int result = ::fsync(fd);
  ::close(fd);
  return result;
}

std::uint64_t FileCalls::FreeBytes(int fd) {
  struct statvfs info {};
  if (::fstatvfs(fd, &info) != 0) return ~std::uint64_t{0};
  return static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize;
}

}  // namespace predictor
