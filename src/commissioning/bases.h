// Computes the pose of one arm's base in the frame of the other arm's base from points that both
// arms have touched.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor::commissioning {

// A point in the room that the tips of both arms touched. The point's positions are computed from
// the joints of each arm.
struct TouchedPoint {
  Vector3 p_A = Vector3::Zero();  // position in the base of A [m]
  Vector3 p_B = Vector3::Zero();  // position in the base of B [m]
};

struct BaseCalibration {
  Pose X_AB;                           // base of B in the base of A
  Vector3 position = Vector3::Zero();  // half-widths of 95 % intervals, along A's axes [m]
  Vector3 rotation = Vector3::Zero();  // half-widths for the rotation, about A's axes [rad]
  double at_points = 0;  // upper bound of the half-width for a point in the middle of the touched
                         // points [m]
  double residual = 0;   // rms distance between the mapped and the touched points [m]
  std::vector<double> distances;  // distance of each point [m]
};

inline constexpr int kMinBasePoints = 3;

// Returns the rigid motion that maps the points p_B onto the points p_A with the least squared
// error, and its covariance from the residuals. The method of Horn 1987 uses an eigenvector of a 4
// × 4 matrix, so the result is never a reflection. Throws InputError if there are too few points,
// if the points are on a line or too close together, or if the points do not fit.
BaseCalibration CalibrateBases(std::span<const TouchedPoint> points);

// Returns the result as a table. `before` is the nominal X_AB.
std::string BasesText(const BaseCalibration& found, const Pose& before);

}  // namespace predictor::commissioning
