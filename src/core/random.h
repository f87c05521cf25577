// Generates random numbers from one seed. The numbers are identical on every computer.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/sincos.h"

namespace predictor {

// One stream of random numbers (xoshiro256++, Blackman & Vigna 2019). Each stream is named after
// its use. Additional numbers drawn from one stream therefore do not change the other streams. It
// does not allocate.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view use) {
    std::uint64_t x = seed;
    for (const char c : use) x = (x ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    for (auto& s : state_) s = SplitMix(&x);
  }

  std::uint64_t Next() {
    const std::uint64_t result = Rotate(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = Rotate(state_[3], 45);
    return result;
  }

  // Returns a number that is uniformly distributed in [0, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }

  // Returns a normally distributed number with mean 0 and standard deviation 1. The Box-Muller
  // method computes two such numbers at a time, and both are used.
  double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double r = std::sqrt(-2 * std::log(1 - Uniform()));
    const double angle = 2 * 3.14159265358979323846 * Uniform();
    double sine = 0, cosine = 0;
    SinesAndCosines(&angle, 1, &sine, &cosine);
    spare_ = r * sine;
    has_spare_ = true;
    return r * cosine;
  }

  // Continues with other numbers, which depend on `seed` and on the present state. The present
  // state differs between streams, so that streams with the same seed remain independent.
  void Reseed(std::uint64_t seed) {
    std::uint64_t x = SplitMix(&seed);
    for (auto& s : state_) {
      x ^= s;
      s = SplitMix(&x);
    }
    spare_ = 0;
    has_spare_ = false;
  }

  template <class A>
  void Archive(A& a) {
    a(state_, spare_, has_spare_);
    if (a.seed()) Reseed(*a.seed());
  }

 private:
  static std::uint64_t Rotate(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  static std::uint64_t SplitMix(std::uint64_t* x) {
    std::uint64_t z = (*x += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::uint64_t state_[4];
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace predictor
