#include "fakes/lateness.h"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>

namespace predictor {
namespace {

constexpr std::uint64_t kPeriod = 500'000, kOrdinaryPeriod = 5'000'000;  // [ns]
constexpr double kNoticed = 0.3;  // shorter delays are not recorded [ms]
constexpr int kPriority = 90;     // above the loop (80) and the watchdog (85)
constexpr std::size_t kMaxEntries = 100'000;

// Binds the thread to this processor and gives it priority over all other threads there.
void TakeProcessor(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(processor, &set);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  sched_param priority{};
  priority.sched_priority = kPriority;
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
}

std::vector<int> Processors() {
  cpu_set_t set;
  std::vector<int> processors;
  if (sched_getaffinity(0, sizeof set, &set) == 0)
    for (int i = 0; i < CPU_SETSIZE; ++i)
      if (CPU_ISSET(i, &set)) processors.push_back(i);
  return processors;
}

}  // namespace

std::uint64_t MonotonicNow() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
         static_cast<std::uint64_t>(t.tv_nsec);
}

void WaitUntil(std::uint64_t due) {
  const timespec t{static_cast<time_t>(due / 1'000'000'000ULL),
                   static_cast<long>(due % 1'000'000'000ULL)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

void DelayLog::Add(std::uint64_t end, double length) {
  if (length < kNoticed) return;
  const std::lock_guard lock(mutex_);
  entries_.push_back({end, length});
  if (entries_.size() > kMaxEntries) entries_.pop_front();
}

Delay DelayLog::Within(std::uint64_t from, std::uint64_t to) const {
  const std::lock_guard lock(mutex_);
  Delay delay;
  for (const Entry& entry : entries_) {
    const auto length = static_cast<std::uint64_t>(1e6 * entry.length);
    if (entry.end < from || entry.end - length > to) continue;
    delay.longest = std::max(delay.longest, entry.length);
    delay.sum += entry.length;
  }
  return delay;
}

ProcessorWatch::ProcessorWatch() {
  for (const int processor : Processors()) {
    DelayLog* log = &logs_.emplace_back();
    threads_.emplace_back([this, processor, log] {
      TakeProcessor(processor);
      Watch(kPeriod, log);
    });
  }
  threads_.emplace_back([this] {
    const sched_param none{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
    Watch(kOrdinaryPeriod, &ordinary_);
  });
}

void ProcessorWatch::Watch(std::uint64_t period, DelayLog* log) const {
  for (std::uint64_t due = MonotonicNow() + period; !done_; due += period) {
    WaitUntil(due);
    const std::uint64_t now = MonotonicNow();
    if (now <= due) continue;  // interrupted by a signal
    log->Add(now, 1e-6 * static_cast<double>(now - due));
    while (due + period < now) due += period;
  }
}

ProcessorWatch::~ProcessorWatch() {
  done_ = true;
  for (std::thread& thread : threads_) thread.join();
}

Delay ProcessorWatch::Within(std::uint64_t from, std::uint64_t to) const {
  Delay worst;
  for (const DelayLog& log : logs_) {
    const Delay delay = log.Within(from, to);
    worst.longest = std::max(worst.longest, delay.longest);
    worst.sum = std::max(worst.sum, delay.sum);
  }
  return worst;
}

}  // namespace predictor
