// Numbers that many tests use.
#pragma once

#include <limits>
#include <numbers>

namespace predictor {

inline constexpr double kDt = 0.001;  // duration of a tick [s]
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace predictor
