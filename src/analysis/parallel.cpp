#include "analysis/parallel.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace predictor {

void DoInParallel(std::size_t count, unsigned threads,
                  const std::function<void(std::size_t)>& piece,
                  const std::function<void()>& wait) {
  std::atomic<std::size_t> next = 0;
  std::atomic<unsigned> working = threads;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&]() noexcept {
    try {
      for (std::size_t i; (i = next++) < count;) piece(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
    --working;
  };
  std::vector<std::jthread> all;
  for (unsigned k = 0; k < threads; ++k) all.emplace_back(work);
  while (working > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    wait();
  }
  all.clear();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace predictor
