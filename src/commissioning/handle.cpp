#include "commissioning/handle.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/format.h"
#include "core/linear_algebra.h"
#include "sensing/hand_estimator.h"

namespace predictor::commissioning {
namespace {

// Smallest permitted spread of the directions of gravity about their mean: the rms along the axis
// with the second largest spread. Poses that tilt the handle by 20° in either direction have about
// this spread.
constexpr double kMinTilt = 0.2;
// Largest residual of a pose that sensor and cables can cause: the sum of a constant, the
// resolution, and a share of the weight [N], [N·m].
constexpr double kResidualForce = 0.1;
constexpr double kResidualTorque = 0.01;
constexpr double kResidualPart = 0.02;
// Required accuracy.
constexpr double kMaxRelativeMassError = 0.05;  // half-width as a share of the mass
constexpr double kMaxMassError = 0.010;         // half-width as an amount [kg]
constexpr double kNoMass = 0.020;               // a smaller mass counts as no weight [kg]
constexpr double kMaxCenterError = 0.005;       // [m]

using Poses = std::span<const RestingPose>;

// Fits the model b + d t + x p to the poses: b is a constant, d is a drift over the time t, and x
// is the effect of gravity for each parameter p.
template <int kColumns, class Gravity>
LinearFit FitPart(Poses poses, double last, Eigen::Index first_axis, const Gravity& by_gravity) {
  const auto rows = static_cast<Eigen::Index>(3 * poses.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, 6 + kColumns);
  Eigen::VectorXd b(rows);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    A.block<3, 3>(row, 0).setIdentity();
    A.block<3, 3>(row, 3).diagonal().setConstant(poses[i].time - last);
    A.block<3, kColumns>(row, 6) = by_gravity(poses[i].g_S);
    b.segment<3>(row) = poses[i].F_S.segment<3>(first_axis);
  }
  return FitLinear(A, b);
}

struct HandleFit {
  LinearFit force, torque;  // bias, drift, then m [kg] or m c [kg·m]

  explicit HandleFit(Poses poses)
      : force(FitPart<1>(poses, poses.back().time, 0, [](const Vector3& g) { return g; })),
        torque(FitPart<3>(poses, poses.back().time, 3,
                          [](const Vector3& g) { return Matrix3(-Skew(g)); })) {}

  double mass() const { return force.value[6]; }
  Vector3 moment() const { return torque.value.segment<3>(6); }
  // Returns the unexplained part of a pose [N], [N·m].
  double ForceError(std::size_t pose) const { return ErrorOf(force, pose); }
  double TorqueError(std::size_t pose) const { return ErrorOf(torque, pose); }

 private:
  static double ErrorOf(const LinearFit& fit, std::size_t pose) {
    return fit.residual.segment<3>(static_cast<Eigen::Index>(3 * pose)).norm();
  }
};

struct Allowed {
  double force, torque;  // force and torque of a pose [N], [N·m]

  Allowed(const HandleFit& fit, const SensorSpec& sensor)
      : force(kResidualForce + sensor.force_resolution +
              kResidualPart * 9.81 * std::abs(fit.mass())),
        torque(kResidualTorque + sensor.torque_resolution +
               kResidualPart * 9.81 * fit.moment().norm()) {}
  // Returns the ratio of an error to its allowed value: the larger of the ratios for force and
  // torque. A ratio above 1 means that the pose does not fit.
  double Share(const HandleFit& fit, std::size_t pose) const {
    return std::max(fit.ForceError(pose) / force, fit.TorqueError(pose) / torque);
  }
  double WorstShare(const HandleFit& fit, std::size_t poses) const {
    double worst = 0;
    for (std::size_t i = 0; i < poses; ++i) worst = std::max(worst, Share(fit, i));
    return worst;
  }
};

// Returns how strongly the poses tilt the handle (see kMinTilt).
double TiltOf(Poses poses) {
  Vector3 mean = Vector3::Zero();
  for (const RestingPose& pose : poses)
    mean += pose.g_S.normalized() / static_cast<double>(poses.size());
  Matrix3 squares = Matrix3::Zero();
  for (const RestingPose& pose : poses) {
    const Vector3 d = pose.g_S.normalized() - mean;
    squares += d * d.transpose() / static_cast<double>(poses.size());
  }
  const SymmetricModes modes = SymmetricModesOf(squares, Matrix3::Identity());
  return std::sqrt(std::max(0.0, modes.eigenvalues[1]));
}

// Returns the pose without which the other poses fit best, and the worst ratio to the allowed value
// in this fit.
std::pair<std::size_t, double> OddOne(Poses poses, const Allowed& allowed) {
  std::pair<std::size_t, double> odd{0, HUGE_VAL};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::vector<RestingPose> others(poses.begin(), poses.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double share = allowed.WorstShare(HandleFit(others), others.size());
    if (share < odd.second) odd = {i, share};
  }
  return odd;
}

[[noreturn]] void RefuseResiduals(Poses poses, const HandleFit& fit, const Allowed& allowed) {
  const auto [odd, rest] = OddOne(poses, allowed);
  if (rest <= 1)
    throw InputError(Formatted(
        "Pose %zu does not fit the other poses (error %.2f N and %.3f N·m). The handle may "
        "have been touched, or a cable may have pulled on it. Repeat the poses.",
        odd + 1, fit.ForceError(odd), fit.TorqueError(odd)));
  std::size_t worst = 0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (allowed.Share(fit, i) > allowed.Share(fit, worst)) worst = i;
  throw InputError(Formatted(
      "No handle explains the readings: %.2f N and %.3f N·m remain unexplained in pose %zu. Either "
      "the handle was touched in several poses, or the orientation of arm.base or sensor.pose in "
      "the machine file is wrong, or the sensor itself subtracts a weight.",
      fit.ForceError(worst), fit.TorqueError(worst), worst + 1));
}

void CheckSureness(const HandleCalibration& found) {
  const double mass = found.mass.value;
  if (mass < -std::max(kMaxMassError, found.mass.half_width))
    throw InputError(
        Formatted("The handle's mass would be %.3f kg. The readings have the wrong sign, or the "
                  "sensor is mounted upside down (sensor.pose).",
                  mass));
  const double center =
      std::max({found.center_of_mass[0].half_width, found.center_of_mass[1].half_width,
                found.center_of_mass[2].half_width});
  const bool sure = found.mass.half_width <= std::max(kMaxMassError, kMaxRelativeMassError * mass);
  const bool placed = center <= kMaxCenterError || mass < kNoMass;
  if (sure && placed) return;
  throw InputError(
      Formatted("The result is too uncertain: ± %.0f g for the mass, ± %.1f mm for the centre of "
                "mass. Add further poses that differ more from one another.",
                1e3 * found.mass.half_width, 1e3 * center));
}

HandleCalibration Found(Poses poses, const HandleFit& fit) {
  HandleCalibration found;
  found.poses = static_cast<int>(poses.size());
  found.mass = fit.force.estimate(6);
  const double m = found.mass.value, mass_error = found.mass.half_width;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Estimate moment = fit.torque.estimate(6 + i);
    const double c = moment.value / m;
    found.center_of_mass[k] = {c, std::hypot(moment.half_width, c * mass_error) / std::abs(m)};
    found.bias[k] = fit.force.estimate(i);
    found.bias[k + 3] = fit.torque.estimate(i);
    found.drift[i] = fit.force.value[3 + i];
    found.drift[3 + i] = fit.torque.value[3 + i];
  }
  for (std::size_t p = 0; p < poses.size(); ++p)
    for (int i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(3 * p) + i;
      found.residual[i] += std::pow(fit.force.residual[row], 2) / found.poses;
      found.residual[3 + i] += std::pow(fit.torque.residual[row], 2) / found.poses;
    }
  found.residual = found.residual.cwiseSqrt();
  return found;
}

}  // namespace

PoseRecorder::PoseRecorder(const SensorSpec& sensor)
    : quiet_(HandEstimator::QuietDeviation(sensor)) {}

void PoseRecorder::Begin() {
  count_ = 0;
  moved_ = 0;
  sum_.setZero();
  squares_.setZero();
}

void PoseRecorder::Add(const JointVector& q, const Vector3& g_S, const Wrench& F_S, double time) {
  if (count_ == 0) {
    q_ = q;
    g_S_ = g_S;
    first_ = F_S;
    time_ = time;
  }
  moved_ = std::max(moved_, (q - q_).cwiseAbs().maxCoeff());
  const Wrench difference = F_S - first_;
  sum_ += difference;
  squares_ += difference.cwiseProduct(difference);
  ++count_;
}

std::string PoseRecorder::Refusal() const {
  if (!complete()) return "The sensor sent too few readings.";
  if (!(moved_ <= kMoves))
    return Formatted(
        "The arm moved (a joint by %.1f mrad). Take your hands off and let the arm come to rest.",
        1e3 * moved_);
  const Wrench mean = sum_ / count_;
  const Wrench deviation = (squares_ / count_ - mean.cwiseProduct(mean)).cwiseMax(0).cwiseSqrt();
  if (((deviation - quiet_).array() <= 0).all()) return "";
  return Formatted(
      "The readings vary by %.2f N and %.3f N·m. Take your hands off the handle, and check that "
      "nothing else touches it.",
      deviation.head<3>().maxCoeff(), deviation.tail<3>().maxCoeff());
}

RestingPose PoseRecorder::pose() const { return {time_, g_S_, first_ + sum_ / count_}; }

HandleCalibration CalibrateHandle(Poses poses, const SensorSpec& sensor) {
  if (poses.size() < static_cast<std::size_t>(kMinHandlePoses))
    throw InputError(
        Formatted("%zu poses are too few. Take at least %d.", poses.size(), kMinHandlePoses));
  if (const double tilt = TiltOf(poses); tilt < kMinTilt)
    throw InputError(Formatted(
        "The poses are too alike (the direction of gravity at the handle varies by %.2f, "
        "but a variation of %.2f about two axes is needed). Tilt the handle far to the "
        "left, right, front and back. It is best if each axis of the handle points down once.",
        tilt, kMinTilt));
  const HandleFit fit(poses);
  const Allowed allowed(fit, sensor);
  if (allowed.WorstShare(fit, poses.size()) > 1) RefuseResiduals(poses, fit, allowed);
  const HandleCalibration found = Found(poses, fit);
  CheckSureness(found);
  return found;
}

std::string HandleText(const HandleCalibration& found, const HandlePayloadSpec& before) {
  std::string text;
  AppendLine(&text, "Handle, from %d poses; ± is half the 95 %% interval", found.poses);
  AppendLine(&text, "  mass               %8.4f ± %.4f kg  (was %.3f)", found.mass.value,
             found.mass.half_width, before.mass);
  for (std::size_t i = 0; i < 3; ++i)
    AppendLine(&text, "  centre of mass %c  %8.2f ± %.2f mm    (was %.1f)", "xyz"[i],
               1e3 * found.center_of_mass[i].value, 1e3 * found.center_of_mass[i].half_width,
               1e3 * before.center_of_mass[static_cast<Eigen::Index>(i)]);
  AppendLine(&text, "Bias of the sensor at the end (tared at each start)");
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    AppendLine(&text, "  %s %c  %9.3f ± %.3f %-4s drift %+.3f per minute, residual %.3f rms",
               i < 3 ? "force " : "torque", "xyz"[i % 3], found.bias[i].value,
               found.bias[i].half_width, i < 3 ? "N" : "N·m", 60 * found.drift[axis],
               found.residual[axis]);
  }
  return text;
}

HandlePayloadSpec WithCalibration(const HandlePayloadSpec& before, const HandleCalibration& found) {
  HandlePayloadSpec after = before;
  after.mass = std::max(0.0, found.mass.value);
  for (std::size_t i = 0; i < 3 && after.mass >= kNoMass; ++i)
    after.center_of_mass[static_cast<Eigen::Index>(i)] = found.center_of_mass[i].value;
  if (before.mass > 0) after.inertia *= after.mass / before.mass;
  return after;
}

}  // namespace predictor::commissioning
