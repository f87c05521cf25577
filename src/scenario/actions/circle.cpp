// Moves the object along a horizontal circle, counter-clockwise as seen from above. It starts at
// the point of the circle with the largest x: centre = start − radius · x. The speed rises and
// falls within one ramp each, with minimum jerk. The path is exactly `cycles` turns.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/minimum_jerk.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

constexpr double kMaxRamp = 1.0;  // [s]

double Ramp(const ActionSpec& spec) noexcept {
  return std::min(kMaxRamp, spec.cycles * spec.period);
}

// The cycles plus one ramp, because the speed rises and falls.
double CircleTime(const ActionSpec& spec) noexcept {
  return spec.cycles * spec.period + Ramp(spec);
}

class Circle final : public Action {
 public:
  explicit Circle(const ActionSpec& spec)
      : radius_(spec.radius),
        rate_(2 * std::numbers::pi / spec.period),
        ramp_(Ramp(spec)),
        duration_(CircleTime(spec)) {}
  void Begin(Intent*) noexcept override { time_ = 0; }
  bool Advance(double dt, double pace, Intent* intent) noexcept override {
    const double before = Angle(time_);
    time_ = std::min(time_ + pace * dt, duration_);
    const double angle = Angle(time_);
    const Vector3 step(std::cos(angle) - std::cos(before), std::sin(angle) - std::sin(before), 0);
    const double rate = pace * Rate(time_);
    const Vector3 v(-std::sin(angle) * rate, std::cos(angle) * rate, 0);
    intent->Move(radius_ * step, radius_ * v);
    return time_ < duration_;
  }
  bool NeedsHold() const noexcept override { return true; }
  void Archive(StateArchive& a) noexcept override { a(time_); }

 private:
  // Integral of MinimumJerk: while ramping up for x · ramp_, the angle changes by rate_ · ramp_
  // times this value.
  static double RampAngle(double x) { return x * x * x * x * (2.5 + x * (-3 + x)); }
  double Rate(double t) const {
    return rate_ * MinimumJerk(t / ramp_) * MinimumJerk((duration_ - t) / ramp_);
  }
  double Angle(double t) const {
    if (t < ramp_) return rate_ * ramp_ * RampAngle(t / ramp_);
    const double end = std::min(t, duration_ - ramp_);
    const double angle = rate_ * (end - ramp_ / 2);
    if (t <= duration_ - ramp_) return angle;
    return angle + rate_ * ramp_ * (0.5 - RampAngle((duration_ - t) / ramp_));
  }

  double radius_, rate_, ramp_, duration_;  // [m], [rad/s], [s], [s]
  double time_ = 0;                         // scaled by the operator's pace [s]
};

std::string Sentence(const ActionSpec& spec, int) {
  return "Follow the circle of " + InCentimetres(spec.radius) + " radius, " +
         WithUnit(spec.cycles, spec.cycles == 1 ? " turn, " : " turns, ") +
         WithUnit(spec.period, " s each.");
}

}  // namespace

const ActionKind kCircle = {
    .name = "circle",
    .uses = {{{"radius"}, {"period"}, {"cycles"}}},
    .motion = ActionMotion::kMoves,
    .sentence = Sentence,
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      if (!(s.period > 0 && s.cycles > 0 && s.radius > 0))
        throw InputError("A circle needs a positive radius, period and number of cycles.");
      return std::make_unique<Circle>(s);
    },
    .time = CircleTime,
};

}  // namespace predictor::actions
