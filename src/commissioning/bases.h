// Where one arm's base stands in the frame of the other's, out of points that both have touched.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace predictor {

// The same point of the room, touched by the tip of each arm, as that arm's joints tell it.
struct TouchedPoint {
  Vector3 p_A = Vector3::Zero();  // in the base of A [m]
  Vector3 p_B = Vector3::Zero();  // in the base of B [m]
};

struct BaseCalibration {
  Pose X_AB;                           // base of B in the base of A
  Vector3 position = Vector3::Zero();  // half-widths of 95 % intervals, along A's axes [m]
  Vector3 rotation = Vector3::Zero();  // the same, about A's axes [rad]
  double at_points = 0;                // the same of a point amid those touched, at most [m]
  double residual = 0;                 // rms distance of a point from where it should be [m]
  std::vector<double> distances;       // of each point [m]
};

inline constexpr int kLeastBasePoints = 3;

// The rigid motion that brings the p_B nearest to the p_A (least squares; Horn 1987, by the
// largest eigenvector of a 4 × 4 matrix, so never a reflection), with the covariance that the
// residuals show. Throws InputError: too few points, points on a line or too near one another,
// points that do not fit.
BaseCalibration CalibrateBases(std::span<const TouchedPoint> points);

// As a table; `before`: X_AB as it was believed.
std::string BasesText(const BaseCalibration& found, const Pose& before);

}  // namespace predictor
