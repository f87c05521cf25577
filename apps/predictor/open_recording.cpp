#include "open_recording.h"

#include <array>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <utility>

#include "core/text.h"

namespace predictor {
namespace {

std::array<char, 1500> open_remedy{};
std::atomic<bool> is_open{false};  // `open_remedy` is complete
std::mutex closer_mutex;
std::function<void()> closer;

}  // namespace

OpenRecording::OpenRecording(const std::string& file, std::function<void()> close) {
  const std::string name = Printable(file);
  std::snprintf(open_remedy.data(), open_remedy.size(),
                "The recording %s is incomplete. To restore the recording up to its last second, "
                "run: predictor repair %s",
                name.c_str(), name.c_str());
  const std::scoped_lock lock(closer_mutex);
  closer = std::move(close);
  is_open = true;
}

OpenRecording::~OpenRecording() {
  is_open = false;
  const std::scoped_lock lock(closer_mutex);
  closer = {};
}

const char* OpenRecording::Remedy() noexcept { return is_open ? open_remedy.data() : ""; }

bool OpenRecording::Close() {
  std::function<void()> close;
  {
    const std::scoped_lock lock(closer_mutex);
    close = std::exchange(closer, {});
  }
  if (close) close();
  return static_cast<bool>(close);
}

}  // namespace predictor
