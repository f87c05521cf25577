#include "commissioning/push_test.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/units.h"

namespace predictor::commissioning {
namespace {

constexpr double kNoOne = 1;  // largest force at the pushed handle if the other handle's sensor
                              // reads the push [N]

using Readings = std::array<AxisReading, PushTest::kAxes>;

// Returns the axis along which a force clearly points, or no value if there is no such axis.
AxisReading DirectionOf(const Vector3& force) noexcept {
  int axis = 0;
  const double most = force.cwiseAbs().maxCoeff(&axis);
  for (int i = 0; i < 3; ++i)
    if (i != axis && std::abs(force[i]) * PushTest::kDominant >= most) return {};
  return {static_cast<std::int8_t>(axis), force[axis] < 0, false};
}

// Returns the matrix R for which reading = R · push. Each column of R is one of W's axes, possibly
// with the opposite sign.
Matrix3 MatrixOf(const Readings& readings) {
  Matrix3 R = Matrix3::Zero();
  for (int i = 0; i < 3; ++i) {
    const AxisReading& reading = readings[static_cast<std::size_t>(i)];
    R(reading.axis, i) = reading.negative ? -1 : 1;
  }
  return R;
}

std::string TurnOf(const Matrix3& R) {
  const Eigen::AngleAxisd turn(R);
  const Vector3 axis = turn.axis();
  int along = 0;
  if (axis.cwiseAbs().maxCoeff(&along) < 0.99)
    return Formatted("rotated by %.0f° about the axis (%.1f, %.1f, %.1f)", kDegrees * turn.angle(),
                     axis.x(), axis.y(), axis.z());
  return Formatted("rotated by %.0f° about %c%c", kDegrees * turn.angle(),
                   axis[along] < 0 ? '-' : '+', "xyz"[along]);
}

// Describes the pattern of the three readings.
std::string LooksLike(const Readings& readings) {
  const auto other = [](const AxisReading& r) { return r.other_hand; };
  if (std::all_of(readings.begin(), readings.end(), other))
    return "The other handle's sensor measured the pushes: the addresses or the cables of the two "
           "sensors are swapped.";
  if (std::any_of(readings.begin(), readings.end(), other))
    return "The other handle's sensor measured some of the pushes. Push one handle at a time, and "
           "make sure that no one touches the other handle.";
  const Matrix3 R = MatrixOf(readings);
  if (R.isApprox(-Matrix3::Identity()))
    return "All signs are reversed: the readings are the force that the sensor exerts on the "
           "handle, not the force that the handle exerts on the sensor. Check sensor.make in the "
           "machine file, and check that the sensor is not mounted back to front.";
  const double determinant = R.determinant();
  if (determinant > 0.5)
    return "The sensor appears to be " + TurnOf(R) +
           " (axes of the world). Correct sensor.pose.rpy or the arm's base in the machine file.";
  if (determinant < -0.5)
    return "The axes are mirrored, which no mounting can cause. Either one push was in the wrong "
           "direction, or sensor.make in the machine file is wrong. Repeat the test first.";
  return "Two pushes gave the same axis, so one of the pushes was in the wrong direction. Repeat "
         "the test.";
}

}  // namespace

const char* Name(const AxisReading& reading) noexcept {
  static constexpr const char* kNames[2][3] = {{"+x", "+y", "+z"}, {"-x", "-y", "-z"}};
  return reading.axis < 0 ? "nothing" : kNames[reading.negative ? 1 : 0][reading.axis];
}

const char* Sentence(PushTest::Hint hint) noexcept {
  switch (hint) {
    case PushTest::Hint::kNone:
      return "";
    case PushTest::Hint::kPush:
      return "Push with 5 to 25 N.";
    case PushTest::Hint::kSofter:
      return "Push more gently, with at most 25 N.";
    case PushTest::Hint::kStraighter:
      return "Push along this axis only.";
    case PushTest::Hint::kLetGo:
      return "Release the handle.";
  }
  return "";
}

void PushTest::Update(const Wrench& pushed, const Wrench& other, double dt) noexcept {
  if (done()) return;
  const Vector3 own = pushed.head<3>(), far = other.head<3>();
  const bool swapped = own.norm() < kNoOne && far.norm() >= kMinForce;
  const Vector3& force = swapped ? far : own;
  const double size = force.norm();
  if (!std::isfinite(size)) {
    time_ = 0;
    return;
  }
  if (!free_) {
    free_ = own.norm() < kFree && far.norm() < kFree;
    hint_ = free_ ? Hint::kPush : Hint::kLetGo;
    time_ = 0;
    return;
  }
  AxisReading reading = DirectionOf(force);
  reading.other_hand = swapped && reading.axis >= 0;
  if (size < kMinForce) {
    hint_ = Hint::kPush;
  } else if (size > kMaxForce) {
    hint_ = Hint::kSofter;
  } else if (reading.axis < 0) {
    hint_ = Hint::kStraighter;
  } else {
    hint_ = Hint::kNone;
    return Await(reading, dt);
  }
  time_ = 0;
}

void PushTest::Await(const AxisReading& reading, double dt) noexcept {
  time_ = reading == seen_ ? time_ + dt : 0;
  seen_ = reading;
  if (time_ < kLong) return;
  readings_[static_cast<std::size_t>(axis_)] = reading;
  ++axis_;
  time_ = 0;
  free_ = false;
  hint_ = done() ? Hint::kNone : Hint::kLetGo;
}

bool PushTest::passed() const noexcept {
  if (!done()) return false;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (readings_[i] != AxisReading{static_cast<std::int8_t>(i), false, false}) return false;
  return true;
}

std::string PushTest::Wrong(int axis) const {
  const AxisReading& reading = readings_[static_cast<std::size_t>(axis)];
  if (axis >= axis_ || reading == AxisReading{static_cast<std::int8_t>(axis), false, false})
    return "";
  const bool mirrored = reading.axis == axis && !reading.other_hand;
  return Formatted("The push along +%c reads %s%s.", "xyz"[axis], Name(reading),
                   reading.other_hand ? " at the other handle" : (mirrored ? ": mirrored" : ""));
}

std::string PushTest::Refusal() const {
  if (!done() || passed()) return "";
  std::string text;
  for (int axis = 0; axis < kAxes; ++axis)
    if (const std::string wrong = Wrong(axis); !wrong.empty()) text += wrong + ' ';
  return text + LooksLike(readings_);
}

}  // namespace predictor::commissioning
