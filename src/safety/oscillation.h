// Detects a growing oscillation of one hand's force.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Each axis of the force is band-passed between spec.low and spec.high, which removes the slow
// motion of the task. The detector follows successive cycles on each axis. The detector reports an
// oscillation after `cycles` consecutive cycles that meet three conditions. Each cycle has a larger
// amplitude than the previous one, each period is inside the band, and the last amplitude is at
// least spec.amplitude.
//
// A cycle runs from peak to peak. The peak is in the middle between the rise above +h and the fall
// below +h, provided that the signal passes −h afterwards. The threshold h is an eighth of
// spec.amplitude. This value exceeds the tremor and noise that pass the filter. The amplitude of a
// cycle is √2 times the standard deviation of the force during this cycle. The standard deviation
// averages the noise, whereas the extreme values would include it. The remainder of a slow motion
// hardly contributes to the amplitude, since a ramp and a cosine are uncorrelated from peak to
// peak. The amplitude is corrected by the filter's gain at the cycle's frequency. An amplitude is
// treated as larger only if it grew by at least kGrowth, because a smaller growth cannot be
// distinguished from the beat of an oscillation with tremor. Successive periods must agree within
// kPeriodRatio. The periods of an oscillation agree in this way, whereas the intervals between
// single jolts do not. The detector finds an oscillation along a diagonal by its components, which
// in the worst case requires √3 times the amplitude. Near the tremor's frequency of 10 Hz, the
// detection of a growth of 5 % may require up to four times the amplitude.
class OscillationDetector {
 public:
  static constexpr double kGrowth = 0.03;      // smallest relative growth of a cycle that counts
  static constexpr double kPeriodRatio = 1.5;  // longest over shortest of two successive periods

  OscillationDetector() = default;
  // `dt` is the time between calls of Update [s].
  OscillationDetector(const OscillationSpec& spec, double dt);
  // `force` [N] is finite and in axes of W. In the tick that completes a growing cycle, returns the
  // cycle's amplitude [N]. If several axes complete a cycle, returns the largest amplitude.
  // Otherwise returns 0. Does not use the heap.
  double Update(const Vector3& force) noexcept;
  // The filter starts from the next force as if that force had always acted.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept { a(axes_, started_); }

 private:
  // A second-order Butterworth section in state-variable form. This form of the filter is exact at
  // low frequencies and easy to start in a steady state.
  struct Section {
    double g = 0;           // tan(π f dt)
    double s1 = 0, s2 = 0;  // states
    void Step(double x, double* high, double* low) noexcept;
    void Archive(StateArchive& a) noexcept { a(s1, s2); }
  };
  // The sums over the samples since the last peak.
  struct Sums {
    double samples = 0;
    double sum = 0, squares = 0;  // [N], [N²]
    void Archive(StateArchive& a) noexcept { a(samples, sum, squares); }
  };
  struct Axis {
    Section high_pass, low_pass;
    bool above = false;  // has passed +h, but not yet −h since then
    // The sums up to this sample, up to the rise above +h, up to the fall below +h, and up to the
    // peak between the rise and the fall.
    Sums now, at_rise, at_fall, at_peak;
    bool after_peak = false;  // the sums begin at a peak
    double period = 0;        // period of the last cycle [s]; 0: no cycle yet
    double amplitude = 0;     // amplitude of the last cycle [N]
    int growing = 0;          // number of consecutive growing cycles
    void Archive(StateArchive& a) noexcept {
      a(high_pass, low_pass, above, now, at_rise, at_fall, at_peak, after_peak, period, amplitude,
        growing);
    }
  };

  double UpdateAxis(double force, Axis* axis) const noexcept;
  bool FindPeak(double y, Axis* axis) const noexcept;
  double CloseCycle(Axis* axis) const noexcept;

  OscillationSpec spec_;
  double dt_ = 0.001;
  double hysteresis_ = 0;  // h [N]
  std::array<Axis, 3> axes_;
  bool started_ = false;
};

}  // namespace predictor
