#include "commissioning/motion_watch.h"

#include <algorithm>
#include <cmath>

#include "commissioning/arm_checks.h"
#include "core/error.h"
#include "core/format.h"
#include "core/words.h"
#include "devices/real_device.h"
#include "models/arm_limits.h"

namespace predictor::commissioning {
namespace {

SafetySpec SafetyOf(const MachineLimits& limits) {
  SafetySpec safety;
  safety.force = std::min(limits.force, MotionWatch::kTouch);
  safety.torque = std::min(limits.torque, MotionWatch::kTouchTorque);
  safety.max_age = limits.max_age;
  safety.frozen_samples = limits.frozen_samples;
  return safety;
}

std::array<SamplePeriods, kHands> PeriodsOf(const Station& station) {
  std::array<SamplePeriods, kHands> periods;
  const ArmSpec& arm = station.spec().arm;
  periods[static_cast<std::size_t>(station.hand())] = {1 / arm.sample_rate,
                                                       1 / arm.sensor.sample_rate};
  return periods;
}

// The station's sensor has noise, so repeated identical readings mean that the sensor is frozen.
std::array<bool, kHands> HasNoise(const Station& station) {
  std::array<bool, kHands> noise = {};
  noise[static_cast<std::size_t>(station.hand())] = true;
  return noise;
}

std::array<JointBounds, kHands> BoundsOf(const Station& station) {
  const ArmLimits limits = LimitsOf(station.spec().arm, station.model());
  std::array<JointBounds, kHands> bounds;
  bounds[static_cast<std::size_t>(station.hand())] = {limits.lower, limits.upper, limits.velocity,
                                                      limits.acceleration};
  return bounds;
}

// Returns the remedy during commissioning, where there is no run to reset.
std::string Advice(const Status& wrong) {
  switch (wrong.cause) {
    case StopCause::kForce:
    case StopCause::kTorque:
      return "Something touches the handle. Take your hands off, and keep everyone out of reach.";
    case StopCause::kJoint:
      return "Guide the arm to a pose further from its limits.";
    default:
      return CauseAdvice(wrong);
  }
}

}  // namespace

bool Consent::Update(char key, double now) {
  const bool held = Held(key, now);
  if (key != 0) silent_since_ = now;
  if (now - silent_since_ > HeldKey::kSilence) revoked_ = false;
  return held && !revoked_;
}

void Consent::Revoke(double now) {
  revoked_ = true;
  silent_since_ = now;
  was_released_ = granted_ = false;
}

std::string Consent::Wanted() const {
  if (contact_.station == nullptr)
    return revoked_ ? Formatted("release %c, then hold it again", key_) : HowToHold(key_, false);
  if (!was_released_)
    return Formatted("release the enabling device, hold it again and tap %c", key_);
  return pressed_ && repeats_ ? Formatted("release %c for a second, then tap it", key_)
                              : HowToHold(key_, true);
}

bool Consent::Held(char key, double now) {
  const bool touched = held_.Update(key, now) == KeySign::kTouched;
  if (key == key_) letter_ = now;
  repeats_ = now - letter_ < HeldKey::kFirstRepeat;
  if (contact_.station == nullptr) return held_.held();
  const Enabling device = EnablingOf(contact_.station->reading(), contact_.digital_input);
  if (device == Enabling::kReleased) was_released_ = true;
  if (key != 0 && key != key_) was_released_ = false;
  pressed_ = device == Enabling::kPressed && was_released_;
  return granted_ = pressed_ && (granted_ || touched);
}

MotionWatch::MotionWatch(const Station& station, const MachineLimits& limits)
    : station_(station),
      hand_(static_cast<std::size_t>(station.hand())),
      feeler_(station),
      monitor_(SafetyOf(limits), {}, HasNoise(station), Session::kStep, PeriodsOf(station), true) {
  const std::array<JointBounds, kHands> bounds = BoundsOf(station);
  guard_ = Guard(bounds, Session::kStep, ReactionTime(station.spec().arm.loop) + Session::kStep);
  lower_[hand_] = bounds[hand_].lower;
  upper_[hand_] = bounds[hand_].upper;
  velocity_[hand_] = bounds[hand_].velocity;
  if (const std::string refusal = PayloadRefusal(station.facts(), station.spec()); !refusal.empty())
    throw DeviceError(station.facts().name + ": " + refusal);
}

void MotionWatch::Begin() {
  guard_.Reset();
  monitor_.Reset();
  last_ = 0;
  static_cast<void>(feeler_.Feel(&wrench_));
  const double force = wrench_.F_H_W.head<3>().norm(), torque = wrench_.F_H_W.tail<3>().norm();
  if (force > kFree || torque > kFreeTorque)
    throw InputError(
        Formatted("Something presses on the %s handle (%.1f N, %.2f N·m). Take your hands off. "
                  "Nothing was written to the machine file.",
                  station_.name().c_str(), force, torque));
}

MonitorInput MotionWatch::Input() const {
  MonitorInput input;
  input.present.Add(static_cast<int>(hand_));
  input.sample = &sample_;
  input.wrench[hand_] = wrench_;
  input.real[hand_].X_W = station_.HandlePose();
  input.lower = lower_;
  input.upper = upper_;
  input.velocity = velocity_;
  input.sensing = sensing_;
  return input;
}

void MotionWatch::Check(double due) {
  sample_.arms[hand_] = station_.sample();
  sensing_ = feeler_.Feel(&wrench_);
  sensing_.hand = static_cast<std::int8_t>(hand_);
  MonitorInput input = Input();
  if (last_ > 0)
    input.missed_deadlines = static_cast<int>(std::lround((due - last_) / Session::kStep)) - 1;
  last_ = due;
  const Status wrong = monitor_.Check(input);
  if (wrong.ok()) return;
  std::string words = CauseWords(wrong) + ". " + Advice(wrong);
  // A frozen sensor (kCount) or a silent sensor (power_off) is not merely late.
  const bool late = wrong.cause == StopCause::kStale && wrong.quantity != Quantity::kCount;
  if (!wrong.power_off && (late || wrong.cause == StopCause::kDeadline)) throw HeldUp(words);
  words += " Nothing was written to the machine file.";
  const bool people = wrong.cause == StopCause::kForce || wrong.cause == StopCause::kTorque ||
                      wrong.cause == StopCause::kJoint;
  if (people) throw InputError(words);
  throw DeviceError(words);
}

JointVector MotionWatch::Bounded(const JointVector& v) {
  std::array<JointVector, kHands> q, command;
  q[hand_] = station_.reading().q;
  command[hand_] = v;
  guard_.Apply(q, &command);
  return command[hand_];
}

}  // namespace predictor::commissioning
