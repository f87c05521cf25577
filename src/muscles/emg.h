// Computes the activation of a muscle from its electromyogram (Buchanan et al. 2004, R).
#pragma once

#include <span>
#include <vector>

namespace predictor::muscles {

struct EmgProcessing {
  double rate = 2000;                     // samples per second, above twice band_high
  double band_low = 20, band_high = 450;  // [Hz]
  double envelope = 6;                    // cutoff of the low-pass, 4 to 6 [Hz]
  double mvc = 1;       // envelope of a maximum voluntary contraction, unit of the input
  double shape = -2;    // A of ActivationOfEmg
  double delay = 0.04;  // delay from the electrical to the mechanical onset, 0.01 to 0.08 [s]
};

// Applies a band-pass filter to the signal, takes the absolute value, and applies a low-pass
// filter. Each filter is of second order and runs forward and backward, so it has no delay. The
// result is at least 0, in the unit of the input. Throws InputError for an impossible rate or band.
std::vector<double> EmgEnvelope(std::span<const double> raw, const EmgProcessing& processing);

// Returns a = (e^(A u) - 1) / (e^A - 1) for an envelope u relative to MVC, limited to 0 ... 1.
// `shape` is A, from -3 (curved) to 0 (straight).
double ActivationOfEmg(double u, double shape);

// Returns the activation at each sample of a raw signal. The envelope is divided by mvc, converted
// by ActivationOfEmg, and delayed.
std::vector<double> EmgActivation(std::span<const double> raw, const EmgProcessing& processing);

}  // namespace predictor::muscles
