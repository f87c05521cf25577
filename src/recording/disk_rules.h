// How a recording treats its disk: when it warns, when it ends, how often it makes it last.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace predictor {

struct DiskRules {
  std::uint64_t warn_below = 10'000'000'000;  // free space [bytes]
  std::uint64_t end_below = 1'000'000'000;    // " : then the recording is closed
  // So often the disk is asked to make it last; half a second and its own time come on top.
  std::chrono::milliseconds sync_period{2000};
  // A sentence for a person: little space, the recording's end. From a thread of the recorder.
  std::function<void(const std::string&)> tell;
};

namespace recording {

class McapFile;

// Looks at the free space, twice a second at most.
class DiskWatch {
 public:
  explicit DiskWatch(const DiskRules& rules) : rules_(rules) {}

  // Why the recording must end; empty if it need not. Warns once.
  std::string Look(const McapFile& file);
  std::uint64_t free_bytes() const { return free_; }  // at the last look

 private:
  const DiskRules rules_;
  std::chrono::steady_clock::time_point looked_{};
  std::uint64_t free_ = 0;
  bool warned_ = false;
};

}  // namespace recording
}  // namespace predictor
