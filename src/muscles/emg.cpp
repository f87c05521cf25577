#include "muscles/emg.h"

#include <algorithm>
#include <cmath>

#include "core/butterworth.h"
#include "core/error.h"
#include "core/text.h"

namespace predictor::muscles {
namespace {

using Filter = Butterworth<double>;

// Filters forward and backward, and therefore without delay.
void Filtered(Filter::Pass pass, double cutoff, double dt, std::vector<double>* values) {
  for (int direction = 0; direction < 2; ++direction) {
    Filter filter(pass, cutoff, dt, values->front());
    for (double& value : *values) value = filter.Update(value);
    std::ranges::reverse(*values);
  }
}

void Check(const EmgProcessing& p) {
  if (!(p.band_low > 0 && p.band_low < p.band_high && p.rate > 2 * p.band_high))
    throw InputError("The electromyogram has " + FormatNumber(p.rate) +
                     " samples per second and a band from " + FormatNumber(p.band_low) + " to " +
                     FormatNumber(p.band_high) +
                     " Hz. Give a band whose upper end is above its lower end, and a sampling rate "
                     "above twice the upper end.");
  if (!(p.envelope > 0 && p.envelope < p.band_low))
    throw InputError("The envelope's cutoff is " + FormatNumber(p.envelope) +
                     " Hz. Give a cutoff between 0 and the lower end of the band.");
  if (!(p.mvc > 0))
    throw InputError("The envelope of the maximum voluntary contraction is " + FormatNumber(p.mvc) +
                     ". Give a positive value.");
}

}  // namespace

std::vector<double> EmgEnvelope(std::span<const double> raw, const EmgProcessing& p) {
  Check(p);
  std::vector<double> values(raw.begin(), raw.end());
  if (values.empty()) return values;
  Filtered(Filter::Pass::kHigh, p.band_low, 1 / p.rate, &values);
  Filtered(Filter::Pass::kLow, p.band_high, 1 / p.rate, &values);
  for (double& value : values) value = std::abs(value);
  Filtered(Filter::Pass::kLow, p.envelope, 1 / p.rate, &values);
  for (double& value : values) value = std::max(value, 0.0);
  return values;
}

double ActivationOfEmg(double u, double shape) {
  const double limited = std::clamp(u, 0.0, 1.0);
  return shape == 0 ? limited : std::expm1(shape * limited) / std::expm1(shape);
}

std::vector<double> EmgActivation(std::span<const double> raw, const EmgProcessing& p) {
  std::vector<double> values = EmgEnvelope(raw, p);
  for (double& value : values) value = ActivationOfEmg(value / p.mvc, p.shape);
  const auto late = std::min(
      values.size(), static_cast<std::size_t>(std::lround(std::max(p.delay, 0.0) * p.rate)));
  std::shift_right(values.begin(), values.end(), static_cast<std::ptrdiff_t>(late));
  std::fill_n(values.begin(), late, 0.0);
  return values;
}

}  // namespace predictor::muscles
