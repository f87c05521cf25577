// Small digital filters for scalars and fixed-size vectors. They do not allocate.
#pragma once

#include <array>
#include <cmath>

namespace predictor {

// Zero of type T. The initial value is explicit, because a default-constructed Eigen vector would
// be uninitialised.
template <class T>
T ZeroOf() {
  if constexpr (requires { T::Zero(); })
    return T::Zero();
  else
    return T{};
}

// First-order low-pass, y' = (x − y)·2π f. The discretisation is exact for an input that is
// constant between samples. The group delay of the filter at low frequency is 1/(2π f) plus half a
// sample.
template <class T>
class LowPass {
 public:
  LowPass() = default;
  // `cutoff` is in [Hz]; 0 or less passes everything through. `dt` is in [s].
  LowPass(double cutoff, double dt, const T& start)
      : gain_(cutoff > 0 ? 1 - std::exp(-2 * 3.14159265358979323846 * cutoff * dt) : 1),
        y_(start) {}
  const T& Update(const T& x) {
    y_ += gain_ * (x - y_);
    return y_;
  }
  void Reset(const T& y) { y_ = y; }
  const T& value() const { return y_; }
  template <class A>
  void Archive(A& a) {
    a(y_);
  }

 private:
  double gain_ = 1;
  T y_ = ZeroOf<T>();
};

// Pure delay by a whole number of samples. The number is at most N.
template <class T, int N>
class Delay {
 public:
  Delay() { buffer_.fill(ZeroOf<T>()); }
  void Reset(int samples, const T& value) {
    samples_ = samples < 0 ? 0 : (samples > N ? N : samples);
    buffer_.fill(value);
    head_ = 0;
  }
  // Stores x and returns the value that was stored `samples` calls ago. If `samples` is 0, returns
  // x itself.
  T Update(const T& x) {
    buffer_[static_cast<std::size_t>(head_)] = x;
    const int tail = (head_ + N + 1 - samples_) % (N + 1);
    head_ = (head_ + 1) % (N + 1);
    return buffer_[static_cast<std::size_t>(tail)];
  }
  // Archives only the samples that are still in the delay, beginning with the oldest sample.
  template <class A>
  void Archive(A& a) {
    a(samples_);
    if (samples_ < 0 || samples_ > N) return a.Fail();
    if (!a.saves()) head_ = samples_;
    for (int i = samples_; i > 0; --i)
      a(buffer_[static_cast<std::size_t>((head_ + N + 1 - i) % (N + 1))]);
  }

 private:
  std::array<T, N + 1> buffer_;
  int head_ = 0;
  int samples_ = 0;
};

// Pure delay of any length up to N − 1 samples, with linear interpolation between samples.
template <class T, int N>
class FractionalDelay {
 public:
  // `samples` is the delay divided by the sampling time, at least 0.
  void Reset(double samples, const T& value) {
    const double whole = std::floor(samples);
    fraction_ = samples - whole;
    whole_.Reset(static_cast<int>(whole), value);
    previous_ = value;
  }
  T Update(const T& x) {
    const T newer = whole_.Update(x);
    T y = (1 - fraction_) * newer + fraction_ * previous_;
    previous_ = newer;
    return y;
  }
  template <class A>
  void Archive(A& a) {
    a(whole_, previous_, fraction_);
  }

 private:
  Delay<T, N> whole_;
  T previous_ = ZeroOf<T>();
  double fraction_ = 0;
};

// First-order low-pass of a signal that is linear between its samples (first-order hold). The
// filter is exact at any sampling time. The lag of a slow signal is 1/(2π f), independent of the
// sampling time.
template <class T>
class RampLowPass {
 public:
  RampLowPass() = default;
  // `cutoff` is in [Hz]; 0 or less passes everything through. `dt` is in [s].
  RampLowPass(double cutoff, double dt, const T& start) : x_(start), y_(start) {
    if (cutoff <= 0) return;
    const double samples = 1 / (2 * 3.14159265358979323846 * cutoff * dt);  // time constant
    pole_ = std::exp(-1 / samples);
    now_ = 1 - (1 - pole_) * samples;
    before_ = 1 - pole_ - now_;
  }
  const T& Update(const T& x) {
    y_ = pole_ * y_ + now_ * x + before_ * x_;
    x_ = x;
    return y_;
  }
  void Reset(const T& y) { x_ = y_ = y; }
  const T& value() const { return y_; }
  template <class A>
  void Archive(A& a) {
    a(x_, y_);
  }

 private:
  double pole_ = 0, now_ = 1, before_ = 0;
  T x_ = ZeroOf<T>(), y_ = x_;
};

}  // namespace predictor
