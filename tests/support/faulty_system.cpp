// A system that is at fault, laid under a program by LD_PRELOAD:
//   FAULTY_CLOCK=SECONDS,JUMP  after so many seconds the wall clock jumps by JUMP [s]
//   FAULTY_PRIORITY=1          nobody gets real-time scheduling
#include <dlfcn.h>
#include <sched.h>
#include <sys/time.h>
#include <time.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace {

using ClockGettime = int (*)(clockid_t, timespec*);

ClockGettime Real() {
  static const auto real = reinterpret_cast<ClockGettime>(dlsym(RTLD_NEXT, "clock_gettime"));
  return real;
}

// By which the wall clock is wrong now [s].
long Jump() {
  static const char* const text = std::getenv("FAULTY_CLOCK");
  if (text == nullptr) return 0;
  timespec now{};
  Real()(CLOCK_MONOTONIC, &now);
  static const time_t begin = now.tv_sec;
  long after = 0, jump = 0;
  if (std::sscanf(text, "%ld,%ld", &after, &jump) != 2) return 0;
  return now.tv_sec - begin >= after ? jump : 0;
}

bool IsWall(clockid_t clock) { return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE; }

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const int result = Real()(clock, time);
  if (IsWall(clock)) time->tv_sec += Jump();
  return result;
}

int gettimeofday(timeval* __restrict__ time, void* __restrict__) noexcept {
  timespec now{};
  Real()(CLOCK_REALTIME, &now);
  time->tv_sec = now.tv_sec + Jump();
  time->tv_usec = now.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* to) noexcept {
  timespec now{};
  Real()(CLOCK_REALTIME, &now);
  now.tv_sec += Jump();
  if (to != nullptr) *to = now.tv_sec;
  return now.tv_sec;
}

int sched_setscheduler(pid_t pid, int policy, const sched_param* param) noexcept {
  using Set = int (*)(pid_t, int, const sched_param*);
  static const auto real = reinterpret_cast<Set>(dlsym(RTLD_NEXT, "sched_setscheduler"));
  if (std::getenv("FAULTY_PRIORITY") == nullptr || policy == SCHED_OTHER)
    return real(pid, policy, param);
  errno = EPERM;
  return -1;
}
}
