// Simulates a faulty system for a program that is started with LD_PRELOAD:
//   FAULTY_CLOCK=SECONDS,JUMP  after SECONDS the wall clock jumps by JUMP [s]
//   FAULTY_PRIORITY=1          no thread gets real-time scheduling
//   FAULTY_SUSPEND=SECONDS,FOR after SECONDS the computer seems to have been suspended for
//                              FOR [s]: CLOCK_BOOTTIME is ahead by this time
//   FAULTY_MEMORY=THREAD,SECONDS,BYTES  after SECONDS the next allocation of at least BYTES in
//                              a thread of this name fails, once
#include <dlfcn.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using ClockGettime = int (*)(clockid_t, timespec*);

ClockGettime Real() {
  static const auto real = reinterpret_cast<ClockGettime>(dlsym(RTLD_NEXT, "clock_gettime"));
  return real;
}

// Returns the current error of a clock [s]. `text` is the value of FAULTY_CLOCK.
long Jump(const char* text) {
  if (text == nullptr) return 0;
  timespec now{};
  Real()(CLOCK_MONOTONIC, &now);
  static const time_t begin = now.tv_sec;
  long after = 0, jump = 0;
  if (std::sscanf(text, "%ld,%ld", &after, &jump) != 2) return 0;
  return now.tv_sec - begin >= after ? jump : 0;
}

long WallJump() {
  static const char* const text = std::getenv("FAULTY_CLOCK");
  return Jump(text);
}

long BootJump() {
  static const char* const text = std::getenv("FAULTY_SUSPEND");
  return Jump(text);
}

// The thread that runs out of memory, and the time at which it runs out of memory [s].
struct Starved {
  Starved() noexcept {
    const char* const text = std::getenv("FAULTY_MEMORY");
    long after = 0;
    if (text == nullptr || std::sscanf(text, "%15[^,],%ld,%zu", name, &after, &least) != 3) return;
    at = Seconds() + after;
    armed = true;
  }
  // This function does not use the functions that this library replaces.
  static long Seconds() noexcept {
    timespec now{};
    syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &now);
    return now.tv_sec;
  }
  bool Now(std::size_t size) noexcept {
    char its[16] = {};
    if (!armed || size < least || prctl(PR_GET_NAME, its) != 0 || std::strcmp(its, name) != 0)
      return false;
    return Seconds() >= at && armed.exchange(false);
  }
  char name[16] = {};
  long at = 0;
  std::size_t least = 0;  // [bytes]
  std::atomic<bool> armed{false};
};
Starved starved;

bool IsWall(clockid_t clock) { return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE; }

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const int result = Real()(clock, time);
  if (IsWall(clock)) time->tv_sec += WallJump();
  if (clock == CLOCK_BOOTTIME) time->tv_sec += BootJump();
  return result;
}

int gettimeofday(timeval* __restrict__ time, void* __restrict__) noexcept {
  timespec now{};
  Real()(CLOCK_REALTIME, &now);
  time->tv_sec = now.tv_sec + WallJump();
  time->tv_usec = now.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* to) noexcept {
  timespec now{};
  Real()(CLOCK_REALTIME, &now);
  now.tv_sec += WallJump();
  if (to != nullptr) *to = now.tv_sec;
  return now.tv_sec;
}

void* __libc_malloc(std::size_t size) noexcept;
void* malloc(std::size_t size) noexcept {
  if (!starved.Now(size)) return __libc_malloc(size);
  errno = ENOMEM;
  return nullptr;
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
