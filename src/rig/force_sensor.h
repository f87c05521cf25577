// The force/torque sensor between flange and handle, as its controller reports it.
#pragma once

#include "core/filters.h"
#include "core/messages.h"
#include "core/motion.h"
#include "core/random.h"
#include "scenario/scenario.h"

namespace predictor {

// Wrench that the rigid handle exerts on the sensor by itself: weight less rate of momentum, about
// S, axes of S. `sensor`: motion of S. gravity [m/s²] along −z of W.
Wrench HandleLoad(const HandlePayloadSpec& handle, const FrameMotion& sensor, double gravity);

// reading = quantum[ delay(low-pass(true wrench)) + bias + white noise ], clipped at the range.
class ForceSensor {
 public:
  static constexpr double kMaxDelay = 0.05;  // [s]

  // dt: sampling time [s], at least 1 ms. `random` draws the noise.
  ForceSensor(const SensorSpec& spec, const Wrench& bias, double dt, RandomStream random);

  // In steady state under F_S.
  void Reset(const Wrench& F_S) noexcept;
  // One sampling time later, under the true wrench F_S about S, axes of S.
  void Step(const Wrench& F_S) noexcept;

  template <class A>
  void Archive(A& a) {
    a(reading_, saturated_, low_pass_, delay_, random_);
  }

  const Wrench& reading() const { return reading_; }
  bool saturated() const { return saturated_; }

 private:
  SensorSpec spec_;
  Wrench bias_, reading_ = Wrench::Zero();
  bool saturated_ = false;
  RampLowPass<Wrench> low_pass_;
  double delay_samples_;
  FractionalDelay<Wrench, 64> delay_;
  RandomStream random_;
};

}  // namespace predictor
