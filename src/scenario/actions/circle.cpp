// Moves the object along a horizontal circle, counter-clockwise as seen from above. The motion
// starts at the point of the circle with the largest x, so centre = start − radius · x. The speed
// rises during one ramp and falls during another one, each with minimum jerk. The path consists of
// exactly `cycles` turns.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/minimum_jerk.h"
#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"

namespace predictor::actions {
namespace {

constexpr double kMaxRamp = 1.0;  // [s]

struct CircleParameters {
  double radius = 0.15;  // [m]
  double period = 8;     // [s]
  double cycles = 4;
};

template <class V>
void Fields(V& v, CircleParameters& p) {
  v("radius", p.radius, Number("m", "radius of the circle", Above(0, 10)));
  v("period", p.period, Number("s", "duration of one cycle", Above(0, 3600)));
  v("cycles", p.cycles, Number("", "number of cycles", Above(0, 1e5)));
}

double Ramp(const CircleParameters& p) { return std::min(kMaxRamp, p.cycles * p.period); }

class Circle final : public Action {
 public:
  explicit Circle(const CircleParameters& p)
      : radius_(p.radius),
        rate_(2 * std::numbers::pi / p.period),
        ramp_(Ramp(p)),
        duration_(Time(p)) {}
  // The motion takes one ramp longer than the cycles at constant speed, because the speed rises and
  // falls.
  static double Time(const CircleParameters& p) { return p.cycles * p.period + Ramp(p); }
  static std::string Sentence(const CircleParameters& p, double) {
    return "Follow the circle of " + InCentimetres(p.radius) + " radius, " +
           WithUnit(p.cycles, p.cycles == 1 ? " turn, " : " turns, ") +
           WithUnit(p.period, " s each.");
  }
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
  // Returns the integral of MinimumJerk. While the speed ramps up for x · ramp_, the angle changes
  // by rate_ · ramp_ times this integral.
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

}  // namespace

const ActionKind kCircle = ActionKindOf<Circle, CircleParameters>(
    "circle", "moves the object along a circle", ActionMotion::kMoves);

}  // namespace predictor::actions
