// System services that a loop with a period of one millisecond needs.
#pragma once

#include <string>

namespace predictor {

inline constexpr int kLoopPriority = 80;  // SCHED_FIFO priority; the watchdog's is higher
// The priority of a controller's process that requests real-time scheduling. This priority is lower
// than the priority of the loop, so the process cannot delay the loop.
inline constexpr int kControllerPriority = 70;

// Real-time scheduling of the calling thread and locked memory, for the lifetime of this object.
class RealTimeScheduling {
 public:
  RealTimeScheduling();
  ~RealTimeScheduling();
  RealTimeScheduling(const RealTimeScheduling&) = delete;
  RealTimeScheduling& operator=(const RealTimeScheduling&) = delete;

  bool prior() const { return prior_; }  // real-time scheduling was granted
  // Returns what the system granted, as text that completes "Real-time scheduling: ".
  const std::string& got() const { return got_; }

 private:
  bool prior_ = false;
  std::string got_;
};

}  // namespace predictor
