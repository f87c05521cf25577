// The damped pseudo-inverse of a Jacobian, which stays bounded in singular postures.
#pragma once

#include <Eigen/Cholesky>

#include "core/types.h"

namespace predictor {

// Factorises the matrix J Jᵀ + λ² 1 with λ = 10⁻³. The matrix Jᵀ (J Jᵀ + λ² 1)⁻¹ is then nearly J⁺.
// Does not use the heap.
inline void FactorDamped(const Jacobian& J, Eigen::LLT<Matrix6>* factor) noexcept {
  constexpr double kDamping = 1e-3;
  Matrix6 JJt = J.lazyProduct(J.transpose());
  JJt.diagonal().array() += kDamping * kDamping;
  factor->compute(JJt);
}

}  // namespace predictor
