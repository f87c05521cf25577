#include "emulator/perturbation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "scenario/perturbation.h"

namespace predictor {
namespace {

constexpr double kHolding = 0.5;  // least force of a holding hand, both present and smoothed [N]
constexpr double kSmoothing = 2;  // cutoff of that smoothing [Hz]

}  // namespace

// With s = time/T, these polynomials bring an initial position, velocity or acceleration of 1 to
// zero. The polynomial 10 s³ − 15 s⁴ + 6 s⁵ leads to the goal.
QuinticMotion::Point QuinticMotion::At(double time) const noexcept {
  const double T = duration_;
  const double s = std::clamp(time / T, 0.0, 1.0);
  const double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
  const double way = goal_ - from_.position;
  const double v = from_.velocity * T, a = from_.acceleration * T * T;
  Point p;
  p.position = from_.position + way * (10 * s3 - 15 * s4 + 6 * s5) +
               v * (s - 6 * s3 + 8 * s4 - 3 * s5) + a / 2 * (s2 - 3 * s3 + 3 * s4 - s5);
  p.velocity = (way * (30 * s2 - 60 * s3 + 30 * s4) + v * (1 - 18 * s2 + 32 * s3 - 15 * s4) +
                a / 2 * (2 * s - 9 * s2 + 12 * s3 - 5 * s4)) /
               T;
  p.acceleration = (way * (60 * s - 180 * s2 + 120 * s3) + v * (-36 * s + 96 * s2 - 60 * s3) +
                    a / 2 * (2 - 18 * s + 36 * s2 - 20 * s3)) /
                   (T * T);
  return p;
}

Perturbation::Perturbation(const Scenario& scenario, double margin, double dt)
    : spec_(scenario.perturbation), dt_(dt), random_(scenario.seed, "perturbation") {
  if (!spec_) return;
  if (!(margin >= spec_->margin))
    throw InputError("perturbation.margin",
                     "perturbation.margin is " + FormatNumber(spec_->margin) +
                         ", but the haptic loop's predicted stability margin is only " +
                         FormatNumber(std::round(100 * margin) / 100) +
                         ". Displacements could cause vibration in a loop that is so close to "
                         "instability. Set `rendering.lead: auto`, make the cobot softer or the "
                         "object heavier (see `predictor check`), or set `perturbation: null`.");
  expected_force_ = PerturbationForce(*spec_, scenario.operator_.hand);
  plane_ = PerturbationPlane(*spec_);
  Reset();
}

void Perturbation::Reset() noexcept {
  phase_ = Phase::kWait;
  phase_time_ = 0;
  left_ = 0;
  load_.fill(0);
  now_ = {};
  if (spec_) earliest_ = spec_->after + spec_->window * random_.Uniform();
}

bool Perturbation::MayBegin(const PerturbationInput& input) const noexcept {
  if (input.run_time < earliest_ || input.limited) return false;
  for (const int i : input.present) {
    const std::size_t hand = static_cast<std::size_t>(i);
    const double force = input.wrench[hand].F_H_W.head<3>().norm();
    if (!(std::min(force, load_[hand]) >= kHolding) || !(force + expected_force_ <= spec_->force))
      return false;
    if (!(input.virtual_[hand].V_W.head<3>().norm() <= spec_->speed)) return false;
  }
  return true;
}

// Draws a direction that has not been used in the current round, so that all directions are used
// equally often.
void Perturbation::Begin() noexcept {
  const int count = spec_->directions;
  if (left_ == 0) {
    for (int i = 0; i < count; ++i)
      order_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i);
    left_ = count;
  }
  const int drawn = std::min(left_ - 1, static_cast<int>(left_ * random_.Uniform()));
  --left_;
  std::swap(order_[static_cast<std::size_t>(drawn)], order_[static_cast<std::size_t>(left_)]);
  const double angle =
      2 * std::numbers::pi * order_[static_cast<std::size_t>(left_)] / static_cast<double>(count);
  direction_ = std::cos(angle) * plane_[0] + std::sin(angle) * plane_[1];
  motion_ = QuinticMotion({}, spec_->amplitude, spec_->ramp);
  phase_ = Phase::kOut;
  phase_time_ = 0;
}

void Perturbation::TakeBack() noexcept {
  motion_ = QuinticMotion(now_, 0, spec_->ramp);
  phase_ = Phase::kBack;
  phase_time_ = 0;
}

void Perturbation::Wait(double run_time) noexcept {
  now_ = {};
  phase_ = Phase::kWait;
  earliest_ = run_time + spec_->pause + spec_->window * random_.Uniform();
}

void Perturbation::Step(const PerturbationInput& input) noexcept {
  if (!spec_) return;
  bool beyond = false;
  for (const int i : input.present) {
    const std::size_t hand = static_cast<std::size_t>(i);
    const double force = input.wrench[hand].F_H_W.head<3>().norm();
    load_[hand] += std::min(1.0, 2 * std::numbers::pi * kSmoothing * dt_) * (force - load_[hand]);
    beyond = beyond || !(force <= spec_->force);
  }
  phase_time_ += dt_;
  if (phase_ == Phase::kWait && MayBegin(input)) Begin();
  if (beyond && (phase_ == Phase::kOut || phase_ == Phase::kHold)) TakeBack();
  if (phase_ == Phase::kOut && phase_time_ >= spec_->ramp) {
    phase_ = Phase::kHold;
    phase_time_ -= spec_->ramp;
  }
  if (phase_ == Phase::kOut || phase_ == Phase::kBack) now_ = motion_.At(phase_time_);
  if (phase_ == Phase::kHold) now_ = {spec_->amplitude, 0, 0};
  if (phase_ == Phase::kHold && phase_time_ >= spec_->hold) TakeBack();
  if (phase_ == Phase::kBack && phase_time_ >= spec_->ramp) Wait(input.run_time);
}

void Perturbation::Archive(StateArchive& a) noexcept {
  if (!spec_) return;
  a(random_, order_, left_, phase_, phase_time_, earliest_, load_, direction_, motion_, now_);
  // A forged state must not displace the handles farther than the scenario allows.
  const bool plausible = std::abs(now_.position) <= 1.01 * spec_->amplitude &&
                         direction_.squaredNorm() < 1.01 && motion_.duration() > 0.01;
  if (!plausible || left_ < 0 || left_ > spec_->directions || phase_ > Phase::kBack) a.Fail();
  for (const std::uint8_t number : order_)
    if (number >= spec_->directions && number != 0) a.Fail();
}

}  // namespace predictor
