// The long counts: ./dev soak sets PREDICTOR_SOAK; tests named *Soak* then run in full.
#pragma once

#include <cstdlib>

namespace predictor {

inline bool InFull() { return std::getenv("PREDICTOR_SOAK") != nullptr; }

// `full` in ./dev soak, `sample` otherwise.
inline long Count(long sample, long full) { return InFull() ? full : sample; }

}  // namespace predictor
