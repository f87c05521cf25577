// Determines when a recording warns about a full disk, when it ends, and how often it synchronises
// the disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace predictor {

struct DiskRules {
  std::uint64_t warn_below = 10'000'000'000;  // free space below which a warning is given [bytes]
  std::uint64_t end_below = 1'000'000'000;    // space below which the recording is closed [bytes]
  // The base of the interval between two synchronisations. Half a second and the duration of the
  // last synchronisation are added.
  std::chrono::milliseconds sync_period{2000};
  // Receives sentences for the user. The sentences say that little space is left or that the
  // recording has ended. A thread of the recorder calls this function.
  std::function<void(const std::string&)> notify;
};

namespace recording {

class McapFile;

// Checks the free space, at most twice per second.
class DiskWatch {
 public:
  explicit DiskWatch(const DiskRules& rules) : rules_(rules) {}

  // Returns the reason why the recording must end, or "". Warns once.
  std::string Look(const McapFile& file);
  std::uint64_t free_bytes() const { return free_; }  // free space at the last check

 private:
  const DiskRules rules_;
  std::chrono::steady_clock::time_point looked_{};
  std::uint64_t free_ = 0;
  bool warned_ = false;
};

}  // namespace recording
}  // namespace predictor
