// Generates stationary random signals of unit standard deviation, which are exact at any sampling
// time.
#pragma once

#include <cmath>
#include <numbers>

#include "core/random.h"

namespace predictor {

// An Ornstein-Uhlenbeck process is white noise that has passed a first-order low-pass filter, and
// has the correlation exp(−|t|/τ).
class OrnsteinUhlenbeck {
 public:
  // `time_constant` is in [s], and 0 gives white noise. The process starts in its stationary
  // distribution.
  OrnsteinUhlenbeck(double time_constant, RandomStream random)
      : time_constant_(time_constant), random_(random), x_(random_.Normal()) {}

  double Step(double dt) noexcept {
    if (dt != dt_) {
      dt_ = dt;
      keep_ = time_constant_ > 0 ? std::exp(-dt / time_constant_) : 0;
      kick_ = std::sqrt(1 - keep_ * keep_);
    }
    return x_ = keep_ * x_ + kick_ * random_.Normal();
  }
  template <class A>
  void Archive(A& a) {
    a(random_, x_, dt_, keep_, kick_);
  }

 private:
  double time_constant_;
  RandomStream random_;
  double x_;
  double dt_ = 0, keep_ = 0, kick_ = 0;
};

// An oscillation near a centre frequency, whose amplitude and phase drift. The signal is an
// Ornstein-Uhlenbeck process in a rotating frame, with the correlation exp(−|t|/τ) cos(2π f t).
class NarrowBandNoise {
 public:
  // `frequency` is in [Hz], and time_constant in [s].
  NarrowBandNoise(double frequency, double time_constant, RandomStream random)
      : frequency_(frequency), time_constant_(time_constant), random_(random) {
    x_ = random_.Normal();
    y_ = random_.Normal();
  }

  double Step(double dt) noexcept {
    if (dt != dt_) {
      dt_ = dt;
      const double keep = std::exp(-dt / time_constant_);
      const double angle = 2 * std::numbers::pi * frequency_ * dt;
      cos_ = keep * std::cos(angle);
      sin_ = keep * std::sin(angle);
      kick_ = std::sqrt(1 - keep * keep);
    }
    const double x = cos_ * x_ - sin_ * y_ + kick_ * random_.Normal();
    y_ = sin_ * x_ + cos_ * y_ + kick_ * random_.Normal();
    return x_ = x;
  }
  template <class A>
  void Archive(A& a) {
    a(random_, x_, y_, dt_, cos_, sin_, kick_);
  }

 private:
  double frequency_, time_constant_;
  RandomStream random_;
  double x_ = 0, y_ = 0;
  double dt_ = 0, cos_ = 0, sin_ = 0, kick_ = 0;
};

}  // namespace predictor
