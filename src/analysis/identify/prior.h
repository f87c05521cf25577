// Prior knowledge about the inertia of links and load before any motion.
#pragma once

#include "analysis/identify/identify.h"
#include "models/torque_regressor.h"

namespace predictor {

// π = nominal + spread z, where z is normal with mean 0 and variance 1.
struct InertialPrior {
  InertialParameters believed;
  Eigen::Matrix<double, 10, 10> spread;
};

// Prior of a link with parameters π and the uncertainty in `options`, to first order.
InertialPrior LinkPrior(const InertialParameters& believed, const IdentifyOptions& options);

// Prior of the load, which is nearly unknown (its mass by 100 %, its centre of gravity by 0.1 m).
InertialPrior LoadPrior(double mass, const Vector3& com, const Matrix3& inertia);

}  // namespace predictor
