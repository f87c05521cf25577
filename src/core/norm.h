// Norm of the first three components of a recorded wrench or twist.
#pragma once

#include <cmath>

namespace predictor {

inline double Norm(const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace predictor
