// Slows time for programs that are started with LD_PRELOAD. The clocks of such a program run at
// 1/kSlower of the real speed, and the waits of the program take kSlower times as long. A control
// loop at 1 kHz then runs at 100 Hz. If a shared computer stalls for some milliseconds, the delay
// of the loop is therefore less than a period. If a test runs programs that exchange data in real
// time, its result therefore depends much less on the computer.
//
// The mapping from the real to the slow clocks has no state. All processes therefore agree on the
// time, as they do without this library. PREDICTOR_REAL_TIME=required leaves time as it is.
#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>

namespace {

using Nanoseconds = long long;
constexpr Nanoseconds kSecond = 1'000'000'000;
constexpr Nanoseconds kSlower = 10;

Nanoseconds Factor() {
  static const Nanoseconds factor = [] {
    const char* const real_time = std::getenv("PREDICTOR_REAL_TIME");
    return real_time != nullptr && std::strcmp(real_time, "required") == 0 ? 1 : kSlower;
  }();
  return factor;
}

// Returns the function that this library replaces.
template <class Function>
Function Real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

int RealTime(clockid_t clock, timespec* time) {
  static const auto real = Real<int (*)(clockid_t, timespec*)>("clock_gettime");
  return real(clock, time);
}

Nanoseconds Of(const timespec& t) { return t.tv_sec * kSecond + t.tv_nsec; }
timespec From(Nanoseconds t) { return {t / kSecond, t % kSecond}; }
timespec Slower(const timespec& t) { return From(Of(t) * Factor()); }
int Slower(int milliseconds) {
  if (milliseconds <= 0) return milliseconds;
  const long long slow = milliseconds * Factor();
  return slow > INT_MAX ? INT_MAX : static_cast<int>(slow);
}

// Returns whether a clock shows the passing time and not the processor time that a process has
// used.
bool Passes(clockid_t clock) {
  return clock == CLOCK_MONOTONIC || clock == CLOCK_MONOTONIC_RAW ||
         clock == CLOCK_MONOTONIC_COARSE || clock == CLOCK_BOOTTIME || clock == CLOCK_REALTIME ||
         clock == CLOCK_REALTIME_COARSE;
}

// Returns the difference between the real and the slow time, which is the same for all clocks [ns].
Nanoseconds Behind() {
  timespec now{};
  RealTime(CLOCK_MONOTONIC, &now);
  return Of(now) - Of(now) / Factor();
}

// Returns the duration, in real time, until a slow clock shows `time`.
timespec Until(clockid_t clock, const timespec& time) {
  timespec now{};
  clock_gettime(clock, &now);
  const Nanoseconds left = Of(time) - Of(now);
  return From(left > 0 ? left * Factor() : 0);
}

// Returns the real time on the monotonic clock at which a slow clock shows `time`.
timespec At(clockid_t clock, const timespec& time) {
  timespec now{};
  RealTime(CLOCK_MONOTONIC, &now);
  return From(Of(now) + Of(Until(clock, time)));
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const int result = RealTime(clock, time);
  if (result == 0 && Passes(clock)) {
    // The monotonic clock is read only once, so that it cannot step back.
    *time = clock == CLOCK_MONOTONIC ? From(Of(*time) / Factor()) : From(Of(*time) - Behind());
  }
  return result;
}

time_t time(time_t* to) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (to != nullptr) *to = now.tv_sec;
  return now.tv_sec;
}

int gettimeofday(timeval* __restrict__ time, void* __restrict__) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  time->tv_sec = now.tv_sec;
  time->tv_usec = now.tv_nsec / 1000;
  return 0;
}

// An interrupted wait reports the remaining time, in slow time.
int nanosleep(const timespec* time, timespec* left) {
  static const auto real = Real<int (*)(const timespec*, timespec*)>("nanosleep");
  const timespec slow = Slower(*time);
  const int result = real(&slow, left);
  if (result != 0 && left != nullptr) *left = From(Of(*left) / Factor());
  return result;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  static const auto real =
      Real<int (*)(clockid_t, int, const timespec*, timespec*)>("clock_nanosleep");
  if (!Passes(clock)) return real(clock, flags, time, left);
  if ((flags & TIMER_ABSTIME) != 0) {
    const timespec at = clock == CLOCK_MONOTONIC ? Slower(*time) : At(clock, *time);
    return real(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, left);
  }
  const timespec slow = Slower(*time);
  const int result = real(CLOCK_MONOTONIC, 0, &slow, left);
  if (result != 0 && left != nullptr) *left = From(Of(*left) / Factor());
  return result;
}

int usleep(useconds_t time) {
  const timespec wait = From(static_cast<Nanoseconds>(time) * 1000);
  return nanosleep(&wait, nullptr);
}

int poll(pollfd* ready, nfds_t count, int timeout) {
  static const auto real = Real<int (*)(pollfd*, nfds_t, int)>("poll");
  return real(ready, count, Slower(timeout));
}

// A C library with run-time checks calls this function instead of poll.
int __poll_chk(pollfd* ready, nfds_t count, int timeout, std::size_t size) {
  if (size / sizeof *ready < count) std::abort();
  return poll(ready, count, timeout);
}

int ppoll(pollfd* ready, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  static const auto real =
      Real<int (*)(pollfd*, nfds_t, const timespec*, const sigset_t*)>("ppoll");
  if (timeout == nullptr) return real(ready, count, nullptr, mask);
  const timespec slow = Slower(*timeout);
  return real(ready, count, &slow, mask);
}

int epoll_wait(int epoll, epoll_event* events, int count, int timeout) {
  static const auto real = Real<int (*)(int, epoll_event*, int, int)>("epoll_wait");
  return real(epoll, events, count, Slower(timeout));
}

int timerfd_settime(int timer, int flags, const itimerspec* time, itimerspec* old) noexcept {
  static const auto real =
      Real<int (*)(int, int, const itimerspec*, itimerspec*)>("timerfd_settime");
  itimerspec slow = *time;
  // The programs use only monotonic timers with absolute times.
  slow.it_value = Slower(time->it_value);
  slow.it_interval = Slower(time->it_interval);
  return real(timer, flags, &slow, old);
}

int setsockopt(int socket, int level, int name, const void* value, socklen_t size) noexcept {
  static const auto real = Real<int (*)(int, int, int, const void*, socklen_t)>("setsockopt");
  if (level != SOL_SOCKET || (name != SO_RCVTIMEO && name != SO_SNDTIMEO) ||
      size != sizeof(timeval))
    return real(socket, level, name, value, size);
  timeval time{};
  std::memcpy(&time, value, sizeof time);
  const Nanoseconds slow = (time.tv_sec * kSecond + time.tv_usec * 1000) * Factor();
  time = {slow / kSecond, slow % kSecond / 1000};
  return real(socket, level, name, &time, sizeof time);
}

int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                           const timespec* time) {
  static const auto real =
      Real<int (*)(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*)>(
          "pthread_cond_clockwait");
  const timespec at = At(clock, *time);
  return real(condition, mutex, CLOCK_MONOTONIC, &at);
}

// This function waits until a time of the wall clock.
int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* time) {
  return pthread_cond_clockwait(condition, mutex, CLOCK_REALTIME, time);
}
}
