// The force/torque sensor in the virtual cobot's wrist.
#pragma once

#include "core/archive.h"
#include "core/random.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// reading = low-pass(true wrench) + bias + white noise. The wrench is that of the load on the
// end-effector, about E, in axes of W.
class WristSensor {
 public:
  WristSensor(const WristSensorSpec& spec, std::uint64_t seed);

  // Settles at the true wrench F_E_W, without noise.
  void Reset(const Wrench& F_E_W) noexcept;
  // Advances by dt [s] under the true wrench.
  void Step(const Wrench& F_E_W, double dt) noexcept;
  Wrench reading() const noexcept { return filtered_ + bias_ + noise_; }

  // The filter's state, for linearisation. Its derivative is cutoff() · (true wrench − filtered).
  Wrench& filtered() noexcept { return filtered_; }
  double cutoff() const noexcept;  // [rad/s]

  void Archive(StateArchive& a) noexcept { a(filtered_, noise_, random_); }

 private:
  WristSensorSpec spec_;
  Wrench bias_, filtered_ = Wrench::Zero(), noise_ = Wrench::Zero();
  RandomStream start_, random_;
};

}  // namespace predictor
