#include "process/sandboxed_call.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include "core/text.h"

namespace predictor {
namespace {

enum : unsigned char { kResult = 0, kError = 1 };  // first byte of the child's output

constexpr std::size_t kMaxErrorBytes = 1000;
constexpr rlim_t kMaxMemory = 4UL << 30;  // address space, including the part shared with the
                                          // parent [bytes]
constexpr int kPipe = 3;                  // the child's only descriptor above standard error

void WriteAll(int descriptor, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = write(descriptor, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) std::_Exit(1);
    at += n;
    size -= static_cast<std::size_t>(n);
  }
}

void LimitIfPossible(int resource, rlim_t limit) {
  const rlimit limits{limit, limit};
  setrlimit(static_cast<__rlimit_resource>(resource), &limits);
}

void Confine(int pipe_end, pid_t parent, const std::vector<std::filesystem::path>& readable) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) std::_Exit(1);
  prctl(PR_SET_DUMPABLE, 0);
  if (pipe_end != kPipe && dup2(pipe_end, kPipe) != kPipe) std::_Exit(1);
  if (close_range(kPipe + 1, ~0U, 0) != 0) std::_Exit(1);
  LimitIfPossible(RLIMIT_CORE, 0);
  LimitIfPossible(RLIMIT_FSIZE, 0);
  if (kSanitized) return;
  LimitIfPossible(RLIMIT_AS, kMaxMemory);
  // Servers report if the kernel lacks a part of the sandbox. A sandboxed call does not report a
  // missing part, because even without this part a crash or a hang is confined to the child.
  EnterPreparation({.read = readable});
}

[[noreturn]] void RunChild(int pipe_end, pid_t parent,
                           const std::vector<std::filesystem::path>& readable,
                           const std::function<std::vector<std::byte>()>& produce) {
  Confine(pipe_end, parent, readable);
  std::vector<std::byte> bytes;
  std::string error;
  unsigned char kind = kResult;
  try {
    bytes = produce();
  } catch (const std::exception& e) {
    kind = kError;
    error = std::string(e.what()).substr(0, kMaxErrorBytes);
  }
  WriteAll(kPipe, &kind, 1);
  if (kind == kResult)
    WriteAll(kPipe, bytes.data(), bytes.size());
  else
    WriteAll(kPipe, error.data(), error.size());
  std::_Exit(0);  // no destructors: the objects belong to the parent
}

// The child process. The function kills the child if the child has not ended by itself.
class Child {
 public:
  Child(pid_t id, int descriptor) : id_(id), descriptor_(descriptor) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    close(descriptor_);
    if (id_ > 0) {
      kill(id_, SIGKILL);
      Wait();
    }
  }

  // Reads all bytes that the child writes until the child closes its end of the pipe.
  std::vector<std::byte> Read(const SandboxedLimits& limits) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(limits.max_time);
    std::vector<std::byte> all;
    std::array<std::byte, 1 << 16> some;
    for (;;) {
      const double left = std::chrono::duration<double>(end - Clock::now()).count();
      pollfd ready{descriptor_, POLLIN, 0};
      const int n = left > 0 ? poll(&ready, 1, static_cast<int>(1e3 * left) + 1) : 0;
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0)
        throw SandboxedFailure("its reader took longer than " + FormatNumber(limits.max_time) +
                               " s");
      const ssize_t got = read(descriptor_, some.data(), some.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return all;
      all.insert(all.end(), some.begin(), some.begin() + got);
      if (all.size() > 1 + std::max(limits.max_bytes, kMaxErrorBytes))
        throw SandboxedFailure("it contains too much data");
    }
  }

  // Returns the child's status as waitpid returns it.
  int Wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_;
  int descriptor_;
};

}  // namespace

std::vector<std::byte> CallSandboxed(const std::vector<std::filesystem::path>& readable,
                                     const SandboxedLimits& limits,
                                     const std::function<std::vector<std::byte>()>& produce) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw SandboxedFailure(std::string("a pipe to its reader could not be created: ") +
                           std::strerror(errno));
  const pid_t parent = getpid();
  const pid_t id = fork();
  if (id == 0) RunChild(ends[1], parent, readable, produce);
  close(ends[1]);
  Child child(id, ends[0]);
  if (id < 0)
    throw SandboxedFailure(std::string("its reader could not be started: ") + std::strerror(errno));
  std::vector<std::byte> bytes = child.Read(limits);
  const int status = child.Wait();
  if (WIFSIGNALED(status))
    throw SandboxedFailure("its reader crashed (signal " + std::to_string(WTERMSIG(status)) + ")");
  if (bytes.empty() || WEXITSTATUS(status) != 0) throw SandboxedFailure("its reader failed");
  const auto kind = static_cast<unsigned char>(bytes.front());
  bytes.erase(bytes.begin());
  if (kind == kResult && bytes.size() <= limits.max_bytes) return bytes;
  if (kind != kError) throw SandboxedFailure("it contains too much data");
  throw SandboxedFailure(Printable({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
}

}  // namespace predictor
