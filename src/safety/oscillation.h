// Detects a growing oscillation of one hand's force.
#pragma once

#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Band-passes each axis of the force between spec.low and spec.high, so that the task's own slow
// motion is not counted, and follows successive cycles (zero crossings) on each: `cycles` in a row,
// each of larger amplitude than the one before and of a period inside the band, the last of at least
// spec.amplitude, is an oscillation.
class OscillationDetector {
 public:
  OscillationDetector() = default;
  OscillationDetector(const OscillationSpec& spec, double dt);
  // force [N], axes of W. Returns the amplitude [N] of the third growing cycle when it is found,
  // else 0. No heap.
  double Update(const Vector3& force) noexcept;
  void Reset() noexcept;
};

}  // namespace predictor
