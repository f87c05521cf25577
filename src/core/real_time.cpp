#include "core/real_time.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace predictor {

RealTimeScheduling::RealTimeScheduling() {
  sched_param priority{};
  priority.sched_priority = kLoopPriority;
  prior_ = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
  if (prior_)
    got_ = "granted (SCHED_FIFO 80)";
  else
    got_ = std::string("refused (") + std::strerror(errno) +
           "), so ticks may be late. Real arms need it: `ulimit -r 85` or CAP_SYS_NICE";
  got_ += mlockall(MCL_CURRENT | MCL_FUTURE) == 0
              ? "; memory locked"
              : std::string("; memory not locked (") + std::strerror(errno) + ")";
}

RealTimeScheduling::~RealTimeScheduling() {
  sched_param priority{};
  sched_setscheduler(0, SCHED_OTHER, &priority);
  munlockall();
}

}  // namespace predictor
