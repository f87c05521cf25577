// What a loop with a period of a millisecond needs of the system.
#pragma once

#include <string>

namespace predictor {

inline constexpr int kLoopPriority = 80;  // of SCHED_FIFO; the watchdog's is above it

// Real-time scheduling of the calling thread, and locked memory, while this lives.
class RealTimeScheduling {
 public:
  RealTimeScheduling();
  ~RealTimeScheduling();
  RealTimeScheduling(const RealTimeScheduling&) = delete;
  RealTimeScheduling& operator=(const RealTimeScheduling&) = delete;

  bool prior() const { return prior_; }  // real-time scheduling was given
  // What was asked for and what was given, in words.
  const std::string& got() const { return got_; }

 private:
  bool prior_ = false;
  std::string got_;
};

}  // namespace predictor
