// The long counts: ./dev soak sets PREDICTOR_SOAK; tests named *Soak* then run in full.
#pragma once

#include <cstdlib>

namespace predictor {

// `full` in ./dev soak, `sample` otherwise.
inline long Count(long sample, long full) { return std::getenv("PREDICTOR_SOAK") ? full : sample; }

}  // namespace predictor
