// Independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace predictor {

// Does piece 0 to count − 1, in that order, on so many threads; `wait` is called now and then
// meanwhile, by the calling thread. What a piece throws ends the others where they next begin one
// and is thrown here, the first of it.
void DoInParallel(std::size_t count, unsigned threads,
                  const std::function<void(std::size_t)>& piece, const std::function<void()>& wait);

}  // namespace predictor
