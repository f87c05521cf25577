#include "muscles/wrap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor::muscles {
namespace {

// Returns the angle at the centre between a point at distance rho and the point at which the
// tangent from it touches the circle.
double TangentAngle(double radius, double rho) { return std::acos(std::min(1.0, radius / rho)); }

// Returns the distance from a point to the point at which the tangent from it touches the circle.
double TangentLength(double radius, double rho) {
  return std::sqrt(std::max(0.0, rho * rho - radius * radius));
}

}  // namespace

std::optional<Contact> AroundBall(const Vector3& from, const Vector3& to, const Vector3& center,
                                  double radius) {
  const Vector3 a = from - center, b = to - center;
  const Vector3 normal = a.cross(b);
  const double sine = normal.norm(), cosine = a.dot(b);
  if (!(sine > 0)) return {};
  const double before = TangentAngle(radius, a.norm());
  const double turn = std::atan2(sine, cosine) - before - TangentAngle(radius, b.norm());
  if (!(turn > 0)) return {};
  const Vector3 e1 = a.normalized(), e2 = normal.cross(a).normalized();
  const auto at = [&](double angle) -> Vector3 {
    return center + radius * (std::cos(angle) * e1 + std::sin(angle) * e2);
  };
  return Contact{at(before), at(before + turn), radius * turn};
}

std::optional<Contact> AroundCylinder(const Vector3& from, const Vector3& to, const Vector3& center,
                                      const Vector3& axis, double radius) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kMaxTurn = kPi * 7 / 6;
  const Vector3 a = from - center, b = to - center;
  const double z_a = a.dot(axis), z_b = b.dot(axis);
  const Vector3 flat_a = a - z_a * axis, flat_b = b - z_b * axis;
  const double rho_a = flat_a.norm(), rho_b = flat_b.norm();
  if (!(rho_a > 0 && rho_b > 0)) return {};
  const Vector3 e1 = flat_a / rho_a, e2 = axis.cross(e1);
  const double between = std::atan2(flat_b.dot(e2), flat_b.dot(e1));
  const double before = TangentAngle(radius, rho_a);
  double turn = between - before - TangentAngle(radius, rho_b);
  if (turn <= kMaxTurn - 2 * kPi) turn += 2 * kPi;
  if (!(turn > 0)) return {};
  // On the unrolled surface, the path is a straight line. The path rises along the axis in
  // proportion to its length in the plane normal to the axis.
  const double first = TangentLength(radius, rho_a), arc = radius * turn;
  const double flat = first + arc + TangentLength(radius, rho_b);
  const double slope = (z_b - z_a) / flat;
  const auto at = [&](double angle, double walked) -> Vector3 {
    return center + radius * (std::cos(angle) * e1 + std::sin(angle) * e2) +
           (z_a + slope * walked) * axis;
  };
  return Contact{at(before, first), at(before + turn, first + arc), arc * std::hypot(1, slope)};
}

}  // namespace predictor::muscles
