// Computes the distance of the object from the path that guides a person.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "scenario/scenario.h"

namespace predictor {

// Returns the distance [m], or no value if there is no path. `object` is the current position of
// the object, and `start` is the position of the object when RUN began, in W [m].
inline std::optional<double> GuidanceDistance(const GuidanceSpec& guidance,
                                              const std::array<double, 3>& object,
                                              const std::array<double, 3>& start) noexcept {
  if (guidance.type != "circle") return std::nullopt;
  const double x = object[0] - start[0] - guidance.center[0];
  const double y = object[1] - start[1] - guidance.center[1];
  const double z = object[2] - start[2] - guidance.center[2];
  return std::hypot(std::hypot(x, y) - guidance.radius, z);
}

}  // namespace predictor
