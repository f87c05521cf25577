// The parts that the worksheets of RULA and REBA have in common, and the format in which their
// tables are stored.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "ergonomics/posture.h"

namespace predictor::ergonomics {

// Returns a cell of a printed table that is stored as text. The characters are 0 … 9, then A = 10,
// B = 11, C = 12.
constexpr int Cell(std::string_view row, int column) {
  const char cell = row[static_cast<std::size_t>(column)];
  return cell >= 'A' ? cell - 'A' + 10 : cell - '0';
}

// Returns 1 if the upper arm is within 20° of the hanging position, 2 up to 45° or if the arm is
// stretched backwards, 3 up to 90°, and 4 above 90°.
inline int UpperArmFlexionScore(double flexion) {
  if (flexion > Degrees(90)) return 4;
  if (flexion > Degrees(45)) return 3;
  return std::abs(flexion) > Degrees(20) ? 2 : 1;
}

// Returns 1 if the elbow angle is between 60° and 100°, and otherwise 2.
inline int ElbowScore(double flexion) {
  return flexion >= Degrees(60) && flexion <= Degrees(100) ? 1 : 2;
}

// Returns 1 for an upright trunk, 2 for a bend of up to 20° in either direction, 3 for up to 60°
// forwards or more than 20° backwards, and 4 for more than 60°. RULA's worksheet does not include
// extension, so extension is scored as in REBA (design choice).
inline int TrunkFlexionScore(double flexion) {
  if (std::abs(flexion) <= kDeclaredThresholds.neutral) return 1;
  if (flexion > Degrees(60)) return 4;
  return std::abs(flexion) > Degrees(20) ? 3 : 2;
}

inline bool Exceeds(double angle, double threshold) { return std::abs(angle) > threshold; }

}  // namespace predictor::ergonomics
