#include "commissioning/chirp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor::commissioning {
namespace {

constexpr double kRise = 0.6, kFall = 0.1;  // duration of the window's rise and fall [s]
constexpr double kPart = 0.8;  // share of the acceleration that the chirp uses; the rest is for the
                               // window and the growing frequency

double Smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

}  // namespace

Chirp::Chirp(const ChirpOptions& options)
    : options_(options), growth_(std::log(options.high / options.low) / options.time) {
  constexpr double kStep = 0.0005;
  double q = 0;
  for (double t = kStep / 2; t < options_.time; t += kStep) {
    q += kStep * Forth(t);
    reach_ = std::max(reach_, std::abs(q));
  }
  scale_ = std::min(1.0, options_.angle / reach_);
  reach_ *= scale_;
}

double Chirp::Forth(double t) const noexcept {
  const double frequency = options_.low * std::exp(growth_ * t);
  const double phase = 2 * std::numbers::pi * (frequency - options_.low) / growth_;
  const double speed =
      std::min(options_.speed, kPart * options_.acceleration / (2 * std::numbers::pi * frequency));
  const double window = Smooth(t / kRise) * Smooth((options_.time - t) / kFall);
  return scale_ * window * speed * std::sin(phase);
}

double Chirp::v(double t) const noexcept {
  if (!(t > 0 && t < duration())) return 0;
  return t <= options_.time ? Forth(t) : -Forth(duration() - t);
}

}  // namespace predictor::commissioning
