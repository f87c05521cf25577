#include "commissioning/bases.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/format.h"
#include "core/least_squares.h"
#include "core/linear_algebra.h"
#include "core/units.h"

namespace predictor::commissioning {
namespace {

// Smallest permitted rms distance of the points from their best-fitting line [m]. If the points are
// closer to a line, they determine the rotation about this line too poorly.
constexpr double kMinSpread = 0.05;
// The largest permitted residual of touched points [m]. A person can place a tip with an accuracy
// of about 1 mm.
constexpr double kMaxResidual = 0.005;

using Points = std::span<const TouchedPoint>;

struct Centres {
  Vector3 A = Vector3::Zero(), B = Vector3::Zero();
  explicit Centres(Points points) {
    for (const TouchedPoint& point : points) {
      A += point.p_A / static_cast<double>(points.size());
      B += point.p_B / static_cast<double>(points.size());
    }
  }
};

// Returns the rms distance of the points from their best-fitting line.
double SpreadOf(Points points, const Vector3& centre) {
  Matrix3 squares = Matrix3::Zero();
  for (const TouchedPoint& point : points) {
    const Vector3 d = point.p_A - centre;
    squares += d * d.transpose() / static_cast<double>(points.size());
  }
  const SymmetricModes modes = SymmetricModesOf(squares, Matrix3::Identity());
  return std::sqrt(std::max(0.0, modes.eigenvalues[0] + modes.eigenvalues[1]));
}

Quaternion BestRotation(Points points, const Centres& centres) {
  Matrix3 M = Matrix3::Zero();  // Σ p_B p_Aᵀ
  for (const TouchedPoint& point : points)
    M += (point.p_B - centres.B) * (point.p_A - centres.A).transpose();
  const Vector3 skew(M(1, 2) - M(2, 1), M(2, 0) - M(0, 2), M(0, 1) - M(1, 0));
  Eigen::Matrix4d N;
  N(0, 0) = M.trace();
  N.block<3, 1>(1, 0) = skew;
  N.block<1, 3>(0, 1) = skew.transpose();
  N.block<3, 3>(1, 1) = M + M.transpose() - M.trace() * Matrix3::Identity();
  const Eigen::VectorXd q = SymmetricModesOf(N, Eigen::Matrix4d::Identity()).eigenvectors.col(3);
  return Quaternion(q[0], q[1], q[2], q[3]).normalized();
}

void CheckResiduals(const BaseCalibration& found) {
  const auto worst = std::max_element(found.distances.begin(), found.distances.end());
  if (*worst <= kMaxResidual) return;
  throw InputError(
      Formatted("The points are inconsistent: point %zu is off by %.1f mm (limit %.1f mm). Touch "
                "all points again with both arms, in the same order. If the error persists, check "
                "the position of the tip and the models of the arms.",
                static_cast<std::size_t>(worst - found.distances.begin()) + 1, 1e3 * *worst,
                1e3 * kMaxResidual));
}

// The errors of the points are assumed to be equal in all directions. The errors of the rotation
// about the centre and of the translation are then independent.
void AddCovariance(Points points, const Centres& centres, BaseCalibration* found) {
  const int freedom = 3 * static_cast<int>(points.size()) - 6;
  double squares = 0;
  for (const double d : found->distances) squares += d * d;
  const double n = static_cast<double>(points.size());
  const double variance = squares / freedom;
  Matrix3 inertia = Matrix3::Zero();
  for (const TouchedPoint& point : points) {
    const Matrix3 S = Skew(point.p_A - centres.A);
    inertia += S.transpose() * S;
  }
  const Matrix3 turn = variance * Matrix3(Solve(inertia, Matrix3::Identity()));
  const Matrix3 arm = Skew(found->X_AB.p - centres.A);
  const Matrix3 shift = variance / n * Matrix3::Identity() + arm * turn * arm.transpose();
  const double t = StudentQuantile95(freedom);
  found->rotation = t * turn.diagonal().cwiseSqrt();
  found->position = t * shift.diagonal().cwiseSqrt();
  found->at_points = t * std::sqrt(variance / n);
  found->residual = std::sqrt(squares / n);
}

}  // namespace

BaseCalibration CalibrateBases(Points points) {
  if (points.size() < static_cast<std::size_t>(kMinBasePoints))
    throw InputError(
        Formatted("%zu points are too few. Touch at least %d points; six points are better.",
                  points.size(), kMinBasePoints));
  const Centres centres(points);
  if (const double spread = SpreadOf(points, centres.A); spread < kMinSpread)
    throw InputError(Formatted(
        "The points are nearly on a line or too close together (their distance from a common line "
        "is %.0f mm, but %.0f mm are needed). Choose points further apart, for example the "
        "corners of a table and a point above it.",
        1e3 * spread, 1e3 * kMinSpread));
  BaseCalibration found;
  found.X_AB.q = BestRotation(points, centres);
  found.X_AB.p = centres.A - found.X_AB.q * centres.B;
  for (const TouchedPoint& point : points)
    found.distances.push_back((point.p_A - found.X_AB * point.p_B).norm());
  CheckResiduals(found);
  AddCovariance(points, centres, &found);
  return found;
}

std::string BasesText(const BaseCalibration& found, const Pose& before) {
  const Vector3 turn = RotationError(found.X_AB.q, before.q);
  const Vector3 shift = found.X_AB.p - before.p;
  std::string text;
  AppendLine(
      &text,
      "Base of one arm in the base of the other, from %zu points; ± is half the 95 %% interval",
      found.distances.size());
  for (int i = 0; i < 3; ++i)
    AppendLine(
        &text,
        "  %c  %8.1f ± %.1f mm (%+.1f from the old value), rotation changed by %+.2f ± %.2f°",
        "xyz"[i], 1e3 * found.X_AB.p[i], 1e3 * found.position[i], 1e3 * shift[i],
        kDegrees * turn[i], kDegrees * found.rotation[i]);
  AppendLine(&text, "  at the centre of the points ± %.1f mm; residual of the points %.1f mm rms",
             1e3 * found.at_points, 1e3 * found.residual);
  for (std::size_t i = 0; i < found.distances.size(); ++i)
    AppendLine(&text, "  point %zu is off by %.1f mm", i + 1, 1e3 * found.distances[i]);
  return text;
}

}  // namespace predictor::commissioning
