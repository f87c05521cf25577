// The twist of a frame that moves with the joints of an arm.
#pragma once

#include "core/types.h"

namespace predictor {

// Returns the twist J v of the frame to which the Jacobian `J` refers, for the joint velocities `v`
// [rad/s or m/s]. `v` must have at least as many entries as J has columns. Does not allocate.
inline Twist TwistOf(const Jacobian& J, const JointVector& v) noexcept {
  Twist V = Twist::Zero();
  for (Eigen::Index j = 0; j < J.cols(); ++j) V += v[j] * J.col(j);
  return V;
}

}  // namespace predictor
