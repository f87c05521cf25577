#include "patient_output.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <string_view>
#include <thread>

namespace predictor {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(1);
constexpr std::size_t kPiece = 512;  // a writable pipe accepts at least this many [bytes]
constexpr std::string_view kDropped =
    "\n[Lines are missing here: the terminal did not accept them in time.]\n";

class PatientFile {
 public:
  explicit PatientFile(int descriptor) : descriptor_(descriptor) {}

  // Returns false if some of the text was dropped.
  bool Write(std::string_view text) {
    const auto end = Clock::now() + (patient_ ? kPatience : Clock::duration::zero());
    patient_ = (!dropped_ || Put(kDropped, end)) && Put(text, end);
    dropped_ = !patient_;
    return patient_;
  }

 private:
  // Returns false if the reader did not accept the whole text in time.
  bool Put(std::string_view text, Clock::time_point end) {
    while (!text.empty()) {
      if (!TakesMore(end)) return false;
      const ssize_t n = write(descriptor_, text.data(), std::min(text.size(), kPiece));
      if (n > 0) text.remove_prefix(static_cast<std::size_t>(n));
      if (n >= 0 || errno == EINTR) continue;
      if (errno != EAGAIN || Clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }
  bool TakesMore(Clock::time_point end) const {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd ready{descriptor_, POLLOUT, 0};
    return poll(&ready, 1, static_cast<int>(std::max<long>(0, left))) > 0 &&
           (ready.revents & POLLOUT) != 0;
  }

  int descriptor_;
  bool patient_ = true;   // whether the last output was accepted
  bool dropped_ = false;  // whether output has been dropped since then
};

ssize_t WriteTo(void* file, const char* text, std::size_t size) {
  return static_cast<PatientFile*>(file)->Write({text, size}) ? static_cast<ssize_t>(size) : 0;
}

// Returns null if the stream never waits for a reader, like a file.
FILE* Bounded(int stream) {
  struct stat status {};
  if (fstat(stream, &status) != 0 || S_ISREG(status.st_mode)) return nullptr;
  // Opens a separate file description if possible, so that other users of the shared description
  // still wait.
  const char* const name = stream == STDERR_FILENO ? "/proc/self/fd/2" : "/proc/self/fd/1";
  const int own = S_ISSOCK(status.st_mode)
                      ? -1
                      : open(name, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_APPEND | O_CLOEXEC);
  auto* const file = new PatientFile(own >= 0 ? own : stream);  // has the lifetime of the stream
  return fopencookie(file, "w", {nullptr, WriteTo, nullptr, nullptr});
}

}  // namespace

void BoundOutput() {
  if (FILE* const error = Bounded(STDERR_FILENO)) {
    std::setvbuf(error, nullptr, _IONBF, 0);
    stderr = error;
  }
  if (FILE* const output = Bounded(STDOUT_FILENO)) {
    std::fflush(stdout);
    std::setvbuf(output, nullptr, _IOLBF, 0);
    stdout = output;
  }
}

}  // namespace predictor
