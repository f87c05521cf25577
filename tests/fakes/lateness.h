// Measures, in the process of the fakes, how late this computer runs its threads. On each
// processor, a thread with the highest priority wakes every half millisecond. One more thread has
// ordinary priority. The process also measures the delays of the fakes' own loop. If none of these
// threads is late, the program itself is the cause of its silence.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

namespace predictor {

// Reads the monotonic clock [ns].
std::uint64_t MonotonicNow();
void WaitUntil(std::uint64_t due);

// The longest delay in a set of delays, and the sum of these delays [ms].
struct Delay {
  double longest = 0, sum = 0;
};

// Records delays with the time at which each one ended. The log forgets the oldest delays.
class DelayLog {
 public:
  // `end` is a time [ns], and `length` is a duration [ms].
  void Add(std::uint64_t end, double length);
  // Combines the delays that overlap the interval from `from` to `to` [ns]. A stop can be reported
  // before its cause has ended.
  Delay Within(std::uint64_t from, std::uint64_t to) const;

 private:
  struct Entry {
    std::uint64_t end;
    double length;
  };
  mutable std::mutex mutex_;
  std::deque<Entry> entries_;
};

// Runs the threads that measure the delays.
class ProcessorWatch {
 public:
  ProcessorWatch();
  ~ProcessorWatch();
  ProcessorWatch(const ProcessorWatch&) = delete;
  ProcessorWatch& operator=(const ProcessorWatch&) = delete;

  // Returns the delays of the worst processor.
  Delay Within(std::uint64_t from, std::uint64_t to) const;
  // Returns the delays of the thread with ordinary priority.
  Delay OrdinaryWithin(std::uint64_t from, std::uint64_t to) const {
    return ordinary_.Within(from, to);
  }

 private:
  void Watch(std::uint64_t period, DelayLog* log) const;

  std::atomic<bool> done_{false};
  std::deque<DelayLog> logs_;  // one per processor
  DelayLog ordinary_;
  std::vector<std::thread> threads_;
};

}  // namespace predictor
