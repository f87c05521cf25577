#include "safety/vibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor {
namespace {

constexpr double kSample = 0.004;         // h [s]
constexpr double kMaxShareOfRate = 0.35;  // highest corner of a filter, as a share of the tick rate
constexpr double kMinPower = 1e-12;       // [N²]
constexpr double kMinSine = 0.03;         // sin²(2π f h) at kLow is 0.09
constexpr double kMinAngle = 1e-6;        // sin² between past samples that are not parallel
constexpr std::array<double, 2> kButterworth = {1.847759065022573, 0.7653668647301796};  // 1/Q

}  // namespace

void VibrationDetector::Section::Step(const Vector3& x, Vector3* high, Vector3* low) noexcept {
  // The section is the same as in the detector of growing oscillations (oscillation.cpp).
  *high = (x - (k + g) * s1 - s2) / (1 + g * (k + g));
  const Vector3 band = g * *high + s1;
  *low = g * band + s2;
  s1 = g * *high + band;
  s2 = g * band + *low;
}

VibrationDetector::VibrationDetector(double dt) {
  ticks_a_sample_ = std::max(1, static_cast<int>(std::lround(kSample / dt)));
  const double h = ticks_a_sample_ * dt;
  jump_share_ = std::min(1.0, h / kJumpTime);
  lasting_share_ = std::min(1.0, h / kLastingTime);
  for (std::size_t i = 0; i < kScales.size(); ++i) {
    lag_[i] = std::clamp(static_cast<int>(std::lround(kScales[i].lag / h)), 2, kHistory - 2);
    share_[i] = std::min(1.0, h / kScales[i].window);
  }
  for (std::size_t i = 0; i < high_pass_.size(); ++i) {
    high_pass_[i].g = std::tan(std::numbers::pi * std::min(kLow, kMaxShareOfRate / dt) * dt);
    high_pass_[i].k = kButterworth[i];
  }
  low_pass_.g = std::tan(std::numbers::pi * std::min(kHigh, kMaxShareOfRate / dt) * dt);
  low_pass_.k = std::numbers::sqrt2;
  history_.fill(Vector3::Zero());
}

void VibrationDetector::Start(const Vector3& force) noexcept {
  for (Section* section : {&high_pass_[0], &high_pass_[1], &low_pass_}) {
    section->s1.setZero();
    section->s2.setZero();
  }
  high_pass_[0].s2 = settled_ = force;
  jump_ = lasting_ = 0;
  history_.fill(Vector3::Zero());
  means_ = {};
  head_ = ticks_ = 0;
  started_ = true;
}

VibrationDetector::Finding VibrationDetector::Update(const Vector3& force) noexcept {
  if (!started_) Start(force);
  Vector3 first, second, y, slow, unused;
  high_pass_[0].Step(force, &first, &slow);
  high_pass_[1].Step(first, &second, &unused);
  low_pass_.Step(second, &unused, &y);
  if (++ticks_ < ticks_a_sample_) return {};
  ticks_ = 0;
  head_ = (head_ + 1) % kHistory;
  history_[static_cast<std::size_t>(head_)] = y;
  FollowJump(slow);
  Finding finding;
  for (std::size_t i = 0; i < kScales.size(); ++i) {
    Means& m = means_[i];
    m.now += share_[i] * (y.squaredNorm() - m.now);
    m.next += share_[i] * (y.dot(Past(1)) - m.next);
    Follow(share_[i], lag_[i], &m.whole);
    Follow(share_[i], lag_[i] / 2, &m.half);
    if (finding.amplitude == 0 && Counts(kScales[i], means_[i]))
      finding = {std::sqrt(2 * means_[i].now), kScales[i].amplitude};
  }
  const bool now = Counts(kLasting, means_[0]);
  lasting_ += lasting_share_ * ((now ? 1.0 : 0.0) - lasting_);
  if (finding.amplitude == 0 && now && lasting_ > kLastingShare)
    finding = {std::sqrt(2 * means_[0].now), kLasting.amplitude};
  return finding;
}

void VibrationDetector::FollowJump(const Vector3& slow) noexcept {
  settled_ += jump_share_ * (slow - settled_);
  jump_ = std::max((slow - settled_).norm(), (1 - jump_share_) * jump_);
}

const Vector3& VibrationDetector::Past(int samples) const noexcept {
  return history_[static_cast<std::size_t>((head_ + kHistory - samples) % kHistory)];
}

void VibrationDetector::Follow(double share, int lag, Across* across) const noexcept {
  const Vector3& y = Past(0);
  const Vector3& late = Past(lag);
  const Vector3& earlier = Past(lag + 1);
  across->before += share * (late.squaredNorm() - across->before);
  across->earlier += share * (earlier.squaredNorm() - across->earlier);
  across->past += share * (late.dot(earlier) - across->past);
  across->shorter += share * (y.dot(Past(lag - 1)) - across->shorter);
  across->lag += share * (y.dot(late) - across->lag);
  across->longer += share * (y.dot(earlier) - across->longer);
}

double VibrationDetector::Across::Explained() const noexcept {
  // Solves the normal equations of two variables.
  const double area = before * earlier - past * past;
  if (area < kMinAngle * before * earlier) return lag * lag / std::max(before, kMinPower);
  const double power = lag * lag * earlier - 2 * lag * longer * past + longer * longer * before;
  return std::max(0.0, power) / std::max(area, kMinPower * kMinPower);
}

bool VibrationDetector::Counts(const Scale& scale, const Means& m) const noexcept {
  const double least = std::max(scale.amplitude, scale.share_of_jump * jump_);
  if (2 * m.now < least * least) return false;
  const double growth = std::sqrt(m.now / std::max(m.whole.before, kMinPower));
  if (growth < scale.growth || growth > scale.max_growth) return false;
  const double cosine = m.next / m.now;
  const double sine2 = std::max(kMinSine, 1 - cosine * cosine);
  const auto is_coherent = [&](const Across& a) {
    const double squared = a.lag * a.lag - a.shorter * a.longer;
    const double whole = m.now * a.before * sine2;
    return whole > 0 && squared >= scale.coherence * scale.coherence * whole &&
           a.Explained() >= scale.explained * scale.explained * m.now;
  };
  return is_coherent(m.whole) && is_coherent(m.half);
}

void VibrationDetector::Archive(StateArchive& a) noexcept {
  a(high_pass_, low_pass_, history_, settled_, jump_, lasting_, head_, ticks_, means_, started_);
  if (head_ < 0 || head_ >= kHistory || ticks_ < 0 || ticks_ >= ticks_a_sample_) {
    head_ = ticks_ = 0;
    a.Fail();
  }
}

}  // namespace predictor
