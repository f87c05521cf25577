// Detects a growing oscillation of one hand's force.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Each axis of the force is band-passed between spec.low and spec.high, which removes the slow
// motion of the task. The detector follows successive cycles on each axis. The detector reports an
// oscillation after `cycles` consecutive cycles if each has a larger amplitude than the previous
// one, each period is inside the band, and the last amplitude is at least spec.amplitude.
//
// A cycle runs from peak to peak. A peak lies in the middle between rising above +h and falling
// below +h, provided that the signal passes −h afterwards. The threshold h is an eighth of
// spec.amplitude, which is more than the filter passes of tremor and noise. The amplitude of a
// cycle is √2 times the standard deviation of the force during this cycle. The standard deviation
// averages the noise, whereas the extreme values would include it. The remainder of a slow motion
// hardly contributes to the amplitude, since a ramp and a cosine are uncorrelated from peak to
// peak. The amplitude is corrected by the filter's gain at the cycle's frequency. An amplitude is
// treated as larger only if it grew by at least kGrowth, because a smaller growth cannot be
// distinguished from the beat of an oscillation with tremor. Successive periods must agree within
// kPeriodRatio. The periods of an oscillation do, whereas the intervals between single jolts do
// not. An oscillation along a diagonal is detected by its components, in the worst case at √3 times
// the amplitude. Near tremor's 10 Hz, detecting a growth of 5 % may take up to four times the
// amplitude.
class OscillationDetector {
 public:
  static constexpr double kGrowth = 0.03;      // smallest relative growth of a cycle that counts
  static constexpr double kPeriodRatio = 1.5;  // longest over shortest of two successive periods

  OscillationDetector() = default;
  // `dt` is the time between calls of Update [s].
  OscillationDetector(const OscillationSpec& spec, double dt);
  // `force` [N] is finite and in axes of W. In the tick that completes a growing cycle, returns its
  // amplitude [N], or the largest one if several axes complete a cycle. Otherwise returns 0. Does
  // not use the heap.
  double Update(const Vector3& force) noexcept;
  // The filter starts from the next force as if that force had always acted.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept { a(axes_, started_); }

 private:
  // Second-order Butterworth section in state-variable form. This form is exact at low frequencies
  // and easy to start in a steady state.
  struct Section {
    double g = 0;           // tan(π f dt)
    double s1 = 0, s2 = 0;  // states
    void Step(double x, double* high, double* low) noexcept;
    void Archive(StateArchive& a) noexcept { a(s1, s2); }
  };
  // Sums over the samples since the last peak.
  struct Sums {
    double samples = 0;
    double sum = 0, squares = 0;  // [N], [N²]
    void Archive(StateArchive& a) noexcept { a(samples, sum, squares); }
  };
  struct Axis {
    Section high_pass, low_pass;
    bool above = false;  // has passed +h, but not yet −h since then
    // The sums up to this sample, up to passing +h, up to falling below +h, and up to the peak
    // between these two.
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
