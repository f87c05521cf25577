// A small swing of one joint that reveals its velocity loop. The frequency rises from low to high
// and then falls again in the same way.
#pragma once

namespace predictor::commissioning {

struct ChirpOptions {
  double low = 0.7, high = 40;  // frequencies [Hz]
  double time = 5;              // time from low to high frequency; the way back takes as long [s]
  double speed = 0.05;          // maximum [rad/s]
  double acceleration = 3;      // maximum, below the joint's own limit [rad/s²]
  double angle = 0.03;          // maximum distance from the start [rad]
};

// v(t) = w(t) a(f) sin φ(t), f = φ'/(2π) grows exponentially from low to high, a(f) is the speed or
// what the acceleration allows, w is a window that begins and ends with zero. The second half of
// the velocity is −v(2T − t), so the swing begins and ends at rest and ends at its initial
// position.
class Chirp {
 public:
  explicit Chirp(const ChirpOptions& options);

  double duration() const { return 2 * options_.time; }          // [s]
  double acceleration() const { return options_.acceleration; }  // maximum [rad/s²]
  // Returns the velocity at t after the start [rad/s], or 0 outside the duration. This function
  // does not use the heap.
  double v(double t) const noexcept;
  // Returns the largest distance from the start [rad].
  double reach() const { return reach_; }

 private:
  double Forth(double t) const noexcept;

  ChirpOptions options_;
  double growth_;     // growth rate of the frequency: ln(high/low)/time [1/s]
  double scale_ = 1;  // keeps the swing within the angle
  double reach_ = 0;
};

}  // namespace predictor::commissioning
