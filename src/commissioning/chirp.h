// A small swing of one joint that shows its velocity loop: slow to fast, and the same way back.
#pragma once

namespace predictor {

struct ChirpOptions {
  double low = 0.7, high = 40;  // frequencies [Hz]
  double time = 5;              // from low to high; the way back takes as long [s]
  double speed = 0.05;          // never faster [rad/s]
  double acceleration = 3;      // never harder: what the joint's limit lets pass unbent [rad/s²]
  double angle = 0.03;          // never farther from where it began [rad]
};

// v(t) = w(t) a(f) sin φ(t), f = φ'/(2π) growing exponentially from low to high, a(f) the speed or
// what the acceleration allows, w a window that begins and ends with zero. The way back is −v(2T −
// t): so it begins and ends at rest, and where it began.
class Chirp {
 public:
  explicit Chirp(const ChirpOptions& options);

  double duration() const { return 2 * options_.time; }          // [s]
  double acceleration() const { return options_.acceleration; }  // at most [rad/s²]
  // Velocity at t after the beginning [rad/s]; 0 outside of the duration. No heap.
  double v(double t) const noexcept;
  // By which it leaves its start at most [rad].
  double reach() const { return reach_; }

 private:
  double Forth(double t) const noexcept;

  ChirpOptions options_;
  double growth_;     // of the frequency: ln(high/low)/time [1/s]
  double scale_ = 1;  // that keeps it within the angle
  double reach_ = 0;
};

}  // namespace predictor
