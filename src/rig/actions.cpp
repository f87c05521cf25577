#include "rig/actions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "scenario/action_time.h"

namespace predictor {
namespace {

bool Concerns(const ActionSpec& spec, std::size_t hand) {
  return spec.hand == "both" || spec.hand == kHandNames[hand];
}

// Closes hands, within its duration, or opens them.
class Grip final : public Action {
 public:
  Grip(const ActionSpec& spec, bool hold) : spec_(spec), hold_(hold) {}
  void Begin(Intent* intent) noexcept override {
    left_ = spec_.duration;
    for (std::size_t i = 0; i < kHands; ++i) {
      if (!Concerns(spec_, i)) continue;
      intent->hold[i] = hold_;
      intent->grip_time[i] = spec_.duration;
    }
  }
  bool Advance(double dt, double, Intent*) noexcept override { return (left_ -= dt) > 0; }
  void Archive(StateArchive& a) noexcept override { a(left_); }

 private:
  ActionSpec spec_;
  bool hold_;
  double left_ = 0;
};

// Keeps the reference where it is for as long as it lasts.
class Hold final : public Action {
 public:
  explicit Hold(const ActionSpec& spec) : duration_(spec.duration) {}
  void Begin(Intent*) noexcept override { left_ = duration_; }
  bool Advance(double dt, double, Intent*) noexcept override { return (left_ -= dt) > 0; }
  void Archive(StateArchive& a) noexcept override { a(left_); }

 private:
  double duration_, left_ = 0;
};

// Displaces and turns the reference with minimum jerk.
class Transport : public Action {
 public:
  Transport(const ActionSpec& spec, const Vector3& by, const Vector3& rotate_by)
      : duration_(spec.duration), by_(by), rotate_by_(rotate_by) {}
  void Begin(Intent*) noexcept override { phase_ = 0; }
  bool Advance(double dt, double pace, Intent* intent) noexcept override {
    const double before = MinimumJerk(phase_);
    phase_ += pace * dt / duration_;
    const double step = MinimumJerk(phase_) - before;
    const double rate = MinimumJerkRate(phase_) * pace / duration_;
    intent->Move(step * by_, rate * by_);
    intent->Turn(step * rotate_by_, rate * rotate_by_);
    return phase_ < 1;
  }
  bool NeedsHold() const noexcept override { return true; }
  void Archive(StateArchive& a) noexcept override { a(phase_); }

 private:
  double duration_;
  Vector3 by_, rotate_by_;
  double phase_ = 0;
};

class PutDown final : public Transport {
 public:
  explicit PutDown(const ActionSpec& spec)
      : Transport(spec, spec.by, Vector3::Zero()), release_(spec, false) {}
  bool Advance(double dt, double pace, Intent* intent) noexcept override {
    if (Transport::Advance(dt, pace, intent)) return true;
    release_.Begin(intent);
    return false;
  }

 private:
  Grip release_;
};

// The reference runs on a horizontal circle, counter-clockwise seen from above. It starts at the
// circle's point of largest x: centre = start − radius · x. The speed rises and falls with minimum
// jerk over CircleRamp each; the way is exactly `cycles` turns.
class Circle final : public Action {
 public:
  explicit Circle(const ActionSpec& spec)
      : radius_(spec.radius),
        rate_(2 * std::numbers::pi / spec.period),
        ramp_(CircleRamp(spec)),
        duration_(ActionTime(spec)) {}
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
  // Angle run by ramping up for x · ramp_, over rate_ · ramp_: the integral of MinimumJerk.
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

  double radius_, rate_, ramp_, duration_;
  double time_ = 0;  // at the person's pace [s]
};

// A feed-forward force: rises for `rise`, stays for `duration`, falls for `rise`.
class Push final : public Action {
 public:
  explicit Push(const ActionSpec& spec) : spec_(spec) {}
  void Begin(Intent*) noexcept override { time_ = 0; }
  bool Advance(double dt, double, Intent* intent) noexcept override {
    time_ += dt;
    const double total = ActionTime(spec_);
    const double rise = std::max(spec_.rise, 1e-9);
    const double part = std::clamp(std::min(time_, total - time_) / rise, 0.0, 1.0);
    for (std::size_t i = 0; i < kHands; ++i) {
      if (Concerns(spec_, i)) intent->push[i] += part * spec_.force;
    }
    return time_ < total;
  }
  void Archive(StateArchive& a) noexcept override { a(time_); }

 private:
  ActionSpec spec_;
  double time_ = 0;
};

void Check(bool good, int index, const char* sentence) {
  if (good) return;
  throw InputError("operator.script[" + std::to_string(index) + "]", sentence);
}

}  // namespace

std::unique_ptr<Action> MakeAction(const ActionSpec& spec, int index) {
  Check(spec.hand == "both" || spec.hand == "left" || spec.hand == "right", index,
        "The hand must be left, right or both.");
  Check(spec.duration > 0 && std::isfinite(spec.duration), index,
        "The duration must be a positive number of seconds.");
  switch (spec.action) {
    case ActionType::kGrip:
      return std::make_unique<Grip>(spec, true);
    case ActionType::kRelease:
      return std::make_unique<Grip>(spec, false);
    case ActionType::kHold:
      return std::make_unique<Hold>(spec);
    case ActionType::kMove:
      return std::make_unique<Transport>(spec, spec.by, Vector3::Zero());
    case ActionType::kRotate:
      return std::make_unique<Transport>(spec, Vector3::Zero(), spec.rotate_by);
    case ActionType::kPutDown:
      return std::make_unique<PutDown>(spec);
    case ActionType::kCircle:
      Check(spec.period > 0 && spec.cycles > 0 && spec.radius > 0, index,
            "A circle needs a positive radius, period and number of cycles.");
      return std::make_unique<Circle>(spec);
    case ActionType::kPush:
      Check(spec.rise >= 0, index, "The rise of a push cannot be negative.");
      return std::make_unique<Push>(spec);
  }
  throw InputError("operator.script[" + std::to_string(index) + "]", "The action is not known.");
}

double MinimumJerk(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (-15 + 6 * x));
}

double MinimumJerkRate(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return 30 * x * x * (1 - x) * (1 - x);
}

}  // namespace predictor
