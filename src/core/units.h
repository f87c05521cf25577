// Factors between SI units and the units in which figures are displayed.
#pragma once

#include <numbers>

namespace predictor {

inline constexpr double kDegrees = 180 / std::numbers::pi;  // [°/rad]
inline constexpr double kMillimetres = 1e3;                 // [mm/m]

}  // namespace predictor
