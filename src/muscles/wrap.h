// Computes shortest paths around round obstacles.
#pragma once

#include <optional>

#include "core/types.h"

namespace predictor::muscles {

// The part of a shortest path that touches the obstacle. `begin` and `end` are its ends [m], and
// `length` is its length [m].
struct Contact {
  Vector3 begin, end;
  double length = 0;
};

// Returns the path around the ball about `center`, on the shorter side, or no value if the straight
// line misses the ball. A point inside the ball is treated as if it were on the surface.
std::optional<Contact> AroundBall(const Vector3& from, const Vector3& to, const Vector3& center,
                                  double radius);

// Returns the path around the cylinder whose axis is the line through `center` along the unit
// vector `axis`. The path turns in the positive sense about `axis`, by at most 210°. Returns no
// value if the straight line passes the cylinder on the given side without touching it. A point
// inside the cylinder is treated as if it were on the surface.
std::optional<Contact> AroundCylinder(const Vector3& from, const Vector3& to, const Vector3& center,
                                      const Vector3& axis, double radius);

}  // namespace predictor::muscles
