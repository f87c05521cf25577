// A random number in an interval.
#pragma once

#include "core/random.h"

namespace predictor {

inline double Between(RandomStream* random, double low, double high) {
  return low + (high - low) * random->Uniform();
}

}  // namespace predictor
