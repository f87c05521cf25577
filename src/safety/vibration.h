// Detects a vibration of one hand's force that grows, or that is narrow-band and steady.
#pragma once

#include <array>
#include <cmath>

#include "core/archive.h"
#include "core/types.h"

namespace predictor {

// The haptic loop becomes unstable above 10 Hz, where no person moves deliberately. Coherence, not
// amplitude, distinguishes such a vibration from noise, because a vibration continues its own past
// and noise does not.
//
// Each axis of the force is band-passed (kLow to kHigh, or to the limit that the tick allows) and
// sampled every 4 ms. Let R(T) be the mean of y(t)·y(t − T), summed over the axes. Any sinusoid
// then satisfies R(T)² − R(T−h) R(T+h) = R(0)² sin²(2π f h), whatever its frequency, phase and
// direction. The left side divided by the right side is the squared coherence after a lag T. The
// coherence is 1 for a vibration. The coherence is near 0 for the response of a damped loop to
// noise, a push or a release, because that response decays within T. A growing vibration is
// normalised by the power at both times, so that it stays coherent.
//
// A jump of the force (a push, a release, the step of a mouse) contains all frequencies, and the
// filter rings after it. The vibration must therefore exceed a share of the force's latest jump.
// Two jumps that are one lag apart look coherent after that lag, but not after half of it. The
// force must therefore be coherent after both the lag and half of the lag.
//
// The identity above holds only if the power is constant during the averaging. After a jolt, the
// power is not constant. The mean contains the onset of the jolt, so the left side can exceed the
// right side for a force that only decays. The three shorter scales, which require growth,
// therefore also require that the past signal explains the present signal. The past explains the
// present if the least-squares projection of y(t) on y(t − T) and y(t − T − h) has more than half
// of the power of y(t). The projection does not explain a signal that began within the last T, so a
// ringing decays before the past explains it. A growing vibration, however, consists mostly of its
// latest cycles, which the preceding cycles explain.
//
// Each of the four scales has its own lag, averaging time, coherence and amplitude. A scale with a
// shorter lag responds sooner but needs a larger amplitude. The three shorter scales also require
// growth, whereas the longest scale finds a steady vibration. A vibration that beats or whose
// amplitude is modulated is coherent only for short times, but repeatedly. A vibration of this kind
// is reported if it has been coherent at the shortest lag for a share of the last second. The
// reasons are in docs/concepts/vibration.md.
class VibrationDetector {
 public:
  static constexpr double kLow = 12, kHigh = 65;  // [Hz]

  struct Scale {
    double lag, window;  // T, and the time constant of the mean [s]
    double coherence;    // minimum coherence
    double amplitude;    // minimum amplitude [N]
    // The minimum and the maximum growth of the amplitude during one lag. The maximum is necessary
    // because a vibration that did not exist one lag ago cannot be compared with itself.
    double growth, max_growth;
    double share_of_jump;  // minimum share of the latest jump of the force below kLow
    double explained;      // minimum share of the amplitude that the past explains
  };
  static constexpr std::array<Scale, 4> kScales = {{
      {0.032, 0.016, 0.85, 2.0, 3.00, 20, 1.0, 0.75},
      {0.060, 0.040, 0.75, 1.8, 1.15, 20, 1.0, 0.75},
      {0.100, 0.080, 0.80, 1.5, 1.10, 20, 1.0, 0.75},
      {0.240, 0.300, 0.65, 1.0, 0, HUGE_VAL, 0.5, 0},
  }};

  // Coherence is repeated if the force is coherent at the first scale's lag for the share
  // kLastingShare of about kLastingTime [s].
  static constexpr Scale kLasting = {
      kScales[0].lag, kScales[0].window, 0.75, 1.0, 0, HUGE_VAL, 0.5, 0};
  static constexpr double kLastingShare = 0.4, kLastingTime = 0.8;

  static constexpr double kJumpTime = 0.15;  // time constant with which a jump is forgotten [s]

  struct Finding {
    double amplitude = 0;  // amplitude of the vibration [N]; 0: none
    double limit = 0;      // threshold of the scale that found it [N]
  };

  VibrationDetector() = default;
  // `dt` is the time between calls of Update [s].
  explicit VibrationDetector(double dt);
  // `force` [N] is finite and in axes of W. Does not use the heap.
  Finding Update(const Vector3& force) noexcept;
  // The filters start from the next force as if that force had always acted.
  void Reset() noexcept { started_ = false; }
  void Archive(StateArchive& a) noexcept;

 private:
  static constexpr int kHistory = 96;  // samples; at least two more than the longest lag

  // A second-order filter section in state-variable form, for three axes.
  struct Section {
    double g = 0, k = 0;  // tan(π f dt), 1/Q
    Vector3 s1 = Vector3::Zero(), s2 = Vector3::Zero();
    void Step(const Vector3& x, Vector3* high, Vector3* low) noexcept;
    void Archive(StateArchive& a) noexcept { a(s1, s2); }
  };
  // The means of products across a lag L, and of products of past values [N²].
  struct Across {
    double before = 0, earlier = 0;           // power at t − L and at t − L − h
    double past = 0;                          // product of y(t − L) and y(t − L − h)
    double shorter = 0, lag = 0, longer = 0;  // products across L − h, L, L + h
    // Returns the mean power of the projection of y(t) on y(t − L) and y(t − L − h) [N²].
    double Explained() const noexcept;
    void Archive(StateArchive& a) noexcept { a(before, earlier, past, shorter, lag, longer); }
  };
  // The means that one scale uses: those of the present power, of the product with the previous
  // sample, and of the products across T and T/2 [N²].
  struct Means {
    double now = 0, next = 0;
    Across whole, half;
    void Archive(StateArchive& a) noexcept { a(now, next, whole, half); }
  };

  void FollowJump(const Vector3& slow) noexcept;
  void Start(const Vector3& force) noexcept;
  const Vector3& Past(int samples) const noexcept;
  bool Counts(const Scale& scale, const Means& means) const noexcept;
  void Follow(double share, int lag, Across* across) const noexcept;

  int ticks_a_sample_ = 4;
  std::array<int, kScales.size()> lag_{};       // [samples]
  std::array<double, kScales.size()> share_{};  // weight of a new product in its mean
  double jump_share_ = 0, lasting_share_ = 0;
  std::array<Section, 2> high_pass_;
  Section low_pass_;
  std::array<Vector3, kHistory> history_;
  Vector3 settled_ = Vector3::Zero();  // recent mean of the force below kLow [N]
  double jump_ = 0;                    // recent largest deviation from that mean [N]
  double lasting_ = 0;                 // share of the recent time in which kLasting was met
  int head_ = 0;                       // index of the newest sample
  int ticks_ = 0;                      // ticks since the newest sample
  std::array<Means, kScales.size()> means_;
  bool started_ = false;
};

}  // namespace predictor
