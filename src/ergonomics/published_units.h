// Non-SI units that the sources use.
#pragma once

namespace predictor::ergonomics {

inline constexpr double kKilogramForce = 9.80665;               // [N]
inline constexpr double kPound = 0.45359237;                    // [kg]
inline constexpr double kPoundForce = kPound * kKilogramForce;  // [N]
inline constexpr double kInch = 0.0254;                         // [m]

}  // namespace predictor::ergonomics
