// Computes the target poses of the real handles.
#pragma once

#include <Eigen/Core>

#include "core/record.h"

namespace predictor {

// Returns the pose in W that the real handle of this hand follows. This is the pose of the virtual
// handle plus the commanded displacement (TickRecord::perturbation).
inline Pose HandleTarget(const TickRecord& record, std::size_t hand) {
  Pose X_WT = FromRecord(record.hands[hand].virtual_.pose);
  X_WT.p += Eigen::Map<const Vector3>(record.perturbation.data());
  return X_WT;
}

}  // namespace predictor
