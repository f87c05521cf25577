// RapidCheck: cases at random that shrink when they fail. The same cases in every ./dev test,
// others and more of them in each ./dev soak. A failure prints how to repeat it (RC_PARAMS).
#pragma once

#include <rapidcheck.h>

#include <cstdlib>

#include "support/soak.h"

namespace predictor::test {

// Before main: RapidCheck reads its parameters at the first check.
inline const int kRapidCheck =
    setenv("RC_PARAMS", Count(0, 1) ? "max_success=20000" : "seed=20261122 max_success=200", 0);

// A number in [low, high]; shrinks to low.
inline rc::Gen<double> Between(double low, double high) {
  constexpr int kSteps = 1'000'000;
  return rc::gen::map(rc::gen::inRange(0, kSteps + 1),
                      [=](int k) { return low + (high - low) * k / kSteps; });
}

}  // namespace predictor::test
