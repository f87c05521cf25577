#include "analysis/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace predictor {

void DoInParallel(std::size_t count, int workers, const std::function<void(std::size_t)>& piece,
                  const std::function<void()>& wait) {
  const std::size_t wanted =
      workers > 0 ? static_cast<std::size_t>(workers) : std::thread::hardware_concurrency();
  const std::size_t threads = std::min(count, std::max<std::size_t>(1, wanted));
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> working = threads;
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
  for (std::size_t k = 0; k < threads; ++k) all.emplace_back(work);
  while (working > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    wait();
  }
  all.clear();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace predictor
