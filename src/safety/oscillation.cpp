#include "safety/oscillation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor {

void OscillationDetector::Section::Step(double x, double* high, double* low) noexcept {
  // The filter uses trapezoidal integrators without a delay (Zavalishin, The Art of VA Filter
  // Design (2018), section 4).
  const double k = std::numbers::sqrt2;  // 1/Q of Butterworth
  *high = (x - (k + g) * s1 - s2) / (1 + g * (k + g));
  const double band = g * *high + s1;
  *low = g * band + s2;
  s1 = g * *high + band;
  s2 = g * band + *low;
}

OscillationDetector::OscillationDetector(const OscillationSpec& spec, double dt)
    : spec_(spec), dt_(dt), hysteresis_(spec.amplitude / 8) {
  // Above a quarter of the sampling rate, the low-pass filter could not be realised and a cycle
  // could not be detected.
  const double high = std::min(spec.high, 0.25 / dt);
  for (Axis& axis : axes_) {
    axis.high_pass.g = std::tan(std::numbers::pi * spec.low * dt);
    axis.low_pass.g = std::tan(std::numbers::pi * high * dt);
  }
}

void OscillationDetector::Reset() noexcept { started_ = false; }

double OscillationDetector::Update(const Vector3& force) noexcept {
  if (!spec_.enabled) return 0;
  double found = 0;
  for (int i = 0; i < 3; ++i) {
    Axis& axis = axes_[static_cast<std::size_t>(i)];
    if (!started_) {
      Axis fresh;
      fresh.high_pass = {axis.high_pass.g, 0, force[i]};
      fresh.low_pass = {axis.low_pass.g, 0, 0};
      axis = fresh;
    }
    found = std::max(found, UpdateAxis(force[i], &axis));
  }
  started_ = true;
  return found;
}

double OscillationDetector::UpdateAxis(double force, Axis* axis) const noexcept {
  double high, y, unused;
  axis->high_pass.Step(force, &high, &unused);
  axis->low_pass.Step(high, &unused, &y);
  ++axis->now.samples;
  axis->now.sum += y;
  axis->now.squares += y * y;
  if (!FindPeak(y, axis)) return 0;
  const double found = CloseCycle(axis);
  axis->now.samples -= axis->at_peak.samples;
  axis->now.sum -= axis->at_peak.sum;
  axis->now.squares -= axis->at_peak.squares;
  return found;
}

// Returns whether y has passed −h. The crossing of −h completes the peak that began when y passed
// +h. The peak is in the middle of the time for which y is above +h. By symmetry, half of the sums
// over the time above +h belong to the cycle that ends at the peak.
bool OscillationDetector::FindPeak(double y, Axis* axis) const noexcept {
  if (y > hysteresis_) {
    if (!axis->above) axis->at_rise = axis->now;
    axis->at_fall = axis->now;
    axis->above = true;
    return false;
  }
  if (!axis->above || y >= -hysteresis_) return false;
  axis->above = false;
  // A half cycle that is longer than that of the slowest oscillation ends the previous oscillation.
  // Earlier cycles then do not belong to an oscillation that begins later.
  if ((axis->now.samples - axis->at_fall.samples) * dt_ > 0.5 / spec_.low) {
    axis->now = {};
    axis->after_peak = false;
    axis->period = 0;
    axis->growing = 0;
    return false;
  }
  axis->at_peak.samples = (axis->at_rise.samples + axis->at_fall.samples) / 2;
  axis->at_peak.sum = (axis->at_rise.sum + axis->at_fall.sum) / 2;
  axis->at_peak.squares = (axis->at_rise.squares + axis->at_fall.squares) / 2;
  return true;
}

// Evaluates the cycle that ends at the peak.
double OscillationDetector::CloseCycle(Axis* axis) const noexcept {
  const Sums& cycle = axis->at_peak;
  const double period = cycle.samples * dt_;
  const bool in_band = period * spec_.low <= 1 && period * spec_.high >= 1;
  if (!axis->after_peak || !in_band) {
    axis->after_peak = true;
    axis->period = 0;
    axis->growing = 0;
    return 0;
  }
  const double mean = cycle.sum / cycle.samples;
  const double variance = std::max(0.0, cycle.squares / cycle.samples - mean * mean);
  const double low = std::pow(spec_.low * period, 4), high = std::pow(1 / (period * spec_.high), 4);
  const double amplitude = std::sqrt(2 * variance * (1 + low) * (1 + high));
  const bool regular = axis->period > 0 && period < kPeriodRatio * axis->period &&
                       axis->period < kPeriodRatio * period;
  const bool grows = regular && amplitude > (1 + kGrowth) * axis->amplitude;
  axis->growing = grows ? axis->growing + 1 : 0;
  axis->period = period;
  axis->amplitude = amplitude;
  return axis->growing >= spec_.cycles && amplitude >= spec_.amplitude ? amplitude : 0;
}

}  // namespace predictor
