// The force/torque sensor in the virtual cobot's wrist.
#pragma once

#include "core/archive.h"
#include "core/filters.h"
#include "core/random.h"
#include "core/types.h"
#include "scenario/scenario.h"

namespace predictor {

// The reading is the low-pass filtered true wrench, plus a bias and white noise. The true wrench is
// the wrench of the load on the end-effector, about E, in axes of W.
class WristSensor {
 public:
  // `dt` is the sampling time [s].
  WristSensor(const WristSensorSpec& spec, double dt, std::uint64_t seed);

  // Sets the filter to its steady state at the true wrench F_E_W, without noise.
  void Reset(const Wrench& F_E_W) noexcept;
  // Advances the filter by one sampling time under the true wrench.
  void Step(const Wrench& F_E_W) noexcept;
  Wrench reading() const noexcept { return filter_.value() + bias_ + noise_; }

  // Returns the filter's state, for linearisation. The derivative of this state is cutoff() · (true
  // wrench − filtered wrench).
  const Wrench& filtered() const noexcept { return filter_.value(); }
  void SetFiltered(const Wrench& F_E_W) noexcept { filter_.Reset(F_E_W); }
  double cutoff() const noexcept;  // [rad/s]

  void Archive(StateArchive& a) noexcept { a(filter_, noise_, random_); }

 private:
  WristSensorSpec spec_;
  LowPass<Wrench> filter_;
  Wrench bias_, noise_ = Wrench::Zero();
  RandomStream start_, random_;
};

}  // namespace predictor
