// RapidCheck draws random cases and shrinks those that fail. Every ./dev test runs the same cases.
// Each ./dev soak runs more cases, which differ every time. A failure prints how to repeat it
// (RC_PARAMS).
#pragma once

#include <rapidcheck.h>

#include <cstdlib>

#include "support/soak.h"

namespace predictor::test {

// This value is initialised before main, because RapidCheck reads its parameters at the first
// check.
inline const int kRapidCheck =
    setenv("RC_PARAMS", InFull() ? "max_success=20000" : "seed=20261122 max_success=200", 0);

// Generates a random number in [low, high] that shrinks to low.
inline rc::Gen<double> Between(double low, double high) {
  constexpr int kSteps = 1'000'000;
  return rc::gen::map(rc::gen::inRange(0, kSteps + 1),
                      [=](int k) { return low + (high - low) * k / kSteps; });
}

}  // namespace predictor::test
