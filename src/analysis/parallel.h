// Runs independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace predictor {

// Executes the pieces 0 to count − 1 on `workers` threads (0: one for each core), but on no more
// threads than pieces. The pieces start in ascending order. Meanwhile, the calling thread calls
// `wait` from time to time. If a piece throws an exception, the other threads stop before their
// next piece, and the first exception is rethrown to the caller.
void DoInParallel(std::size_t count, int workers, const std::function<void(std::size_t)>& piece,
                  const std::function<void()>& wait);

}  // namespace predictor
