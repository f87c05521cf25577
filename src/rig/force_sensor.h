// The force/torque sensor between flange and handle, as its controller reports it.
#pragma once

#include "core/filters.h"
#include "core/messages.h"
#include "core/motion.h"
#include "core/random.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns the wrench that the rigid handle itself exerts on the sensor: its weight minus its rate
// of change of momentum, about S, in axes of S. `sensor` is the motion of S. `gravity` [m/s²] acts
// along −z of W.
Wrench HandleLoad(const HandlePayloadSpec& handle, const FrameMotion& sensor, double gravity);

// reading = quantum[ delay(low-pass(true wrench)) + bias + white noise ], clipped at the range.
class ForceSensor {
 public:
  static constexpr double kMaxDelay = 0.05;  // [s]

  // `dt` is the sampling time [s], at least 1 ms. `random` draws the noise.
  ForceSensor(const SensorSpec& spec, const Wrench& bias, double dt, RandomStream random);

  // Resets the sensor to its steady state under the wrench F_S.
  void Reset(const Wrench& F_S) noexcept;
  // Advances by one sampling time under the true wrench F_S about S, in axes of S.
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
