// Detects a growing oscillation of one hand's force.
#pragma once

#include <array>

#include "core/archive.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// Band-passes each axis of the force between spec.low and spec.high, so that the task's own slow
// motion is not counted, and follows successive cycles on each: `cycles` in a row, each of larger
// amplitude than the one before and of a period inside the band, the last of at least
// spec.amplitude, is an oscillation.
//
// A cycle runs from peak to peak: a peak lies in the middle between rising above +h and falling
// below it, if −h is passed after that (h: an eighth of spec.amplitude, above what tremor and noise
// leave after the filter). Its amplitude is √2 times the standard deviation over it: that averages
// noise out where the highest values would add it, and what is left of a slow motion hardly counts,
// since a ramp and a cosine are uncorrelated from peak to peak. It is corrected by the filter's
// gain at the cycle's frequency. "Larger" means by kGrowth at least: less cannot be told from the
// beat of an oscillation with tremor. Successive periods agree within kPeriodRatio, as those of an
// oscillation do and those of single jolts do not. An oscillation along a diagonal is seen by its
// components, so at √3 times the amplitude at worst; near tremor's 10 Hz a growth of 5 % may take
// up to four times the amplitude to be told.
class OscillationDetector {
 public:
  static constexpr double kGrowth = 0.03;      // smallest relative growth a cycle that counts
  static constexpr double kPeriodRatio = 1.5;  // longest over shortest of two successive periods

  OscillationDetector() = default;
  // dt: of Update [s].
  OscillationDetector(const OscillationSpec& spec, double dt);
  // force [N], finite, axes of W. Returns the amplitude [N] of the last growing cycle in the tick
  // in which it is complete, else 0; if on several axes, the largest. No heap.
  double Update(const Vector3& force) noexcept;
  // The next force is where the filter starts from, as if it had always been.
  void Reset() noexcept;
  void Archive(StateArchive& a) noexcept { a(axes_, started_); }

 private:
  // Second-order Butterworth section in state-variable form: exact at low frequencies and simple to
  // start in a steady state.
  struct Section {
    double g = 0;           // tan(π f dt)
    double s1 = 0, s2 = 0;  // states
    void Step(double x, double* high, double* low) noexcept;
    void Archive(StateArchive& a) noexcept { a(s1, s2); }
  };
  // Of the samples since the last peak.
  struct Sums {
    double samples = 0;
    double sum = 0, squares = 0;  // [N], [N²]
    void Archive(StateArchive& a) noexcept { a(samples, sum, squares); }
  };
  struct Axis {
    Section high_pass, low_pass;
    bool above = false;                   // +h was passed, −h not yet since
    Sums now, at_rise, at_fall, at_peak;  // up to this sample; to passing +h; to the peak between
    bool after_peak = false;              // the sums begin at a peak
    double period = 0;                    // of the last cycle [s]; 0: none before
    double amplitude = 0;                 // of the last cycle [N]
    int growing = 0;                      // cycles in a row
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
