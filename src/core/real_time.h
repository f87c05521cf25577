// Services of the operating system that a loop with a period of one millisecond needs.
#pragma once

#include <string>

namespace predictor {

inline constexpr int kLoopPriority = 80;  // SCHED_FIFO priority; the watchdog's is higher
// The priority of a process that runs a controller outside the program, if this process requests
// real-time scheduling. This priority is lower than the priority of the loop, so the process cannot
// delay the loop.
inline constexpr int kControllerPriority = 70;
static_assert(kControllerPriority < kLoopPriority);

// Gives the calling thread real-time scheduling and locks the memory, for the lifetime of this
// object.
class RealTimeScheduling {
 public:
  RealTimeScheduling();
  ~RealTimeScheduling();
  RealTimeScheduling(const RealTimeScheduling&) = delete;
  RealTimeScheduling& operator=(const RealTimeScheduling&) = delete;

  bool prior() const { return prior_; }  // real-time scheduling was granted
  // Returns a text that states what the system granted. The text completes "Real-time scheduling:
  // ".
  const std::string& got() const { return got_; }

 private:
  bool prior_ = false;
  std::string got_;
};

}  // namespace predictor
