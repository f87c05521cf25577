// What is believed of the inertia of links and load before any motion is seen.
#pragma once

#include "analysis/identify/identify.h"
#include "models/torque_regressor.h"

namespace predictor {

// π = believed + spread z, where z is normal with mean 0 and variance 1.
struct InertialPrior {
  InertialParameters believed;
  Eigen::Matrix<double, 10, 10> spread;
};

// Of a link with parameters π, as uncertain as `options` say, to first order.
InertialPrior LinkPrior(const InertialParameters& believed, const IdentifyOptions& options);

// Of the load: as good as unknown (its mass by 100 %, its centre of gravity by 0.1 m).
InertialPrior LoadPrior(double mass, const Vector3& com, const Matrix3& inertia);

}  // namespace predictor
