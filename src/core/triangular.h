// Computes products with the inverse of a small triangular matrix.
#pragma once

#include <Eigen/Core>

namespace predictor {

// Replaces X by X L⁻ᵀ. The matrix L is in the lower triangle of `L`. The product is computed column
// by column, because Eigen's solver for several right-hand sides is designed for large matrices and
// takes several times as long.
template <class Lower, class Matrix>
void MultiplyByInverseTranspose(const Lower& L, Matrix* X) noexcept {
  for (Eigen::Index j = 0; j < L.cols(); ++j) {
    for (Eigen::Index k = 0; k < j; ++k) X->col(j) -= L(j, k) * X->col(k);
    X->col(j) /= L(j, j);
  }
}

// X ← X L⁻¹.
template <class Lower, class Matrix>
void MultiplyByInverse(const Lower& L, Matrix* X) noexcept {
  for (Eigen::Index j = L.cols() - 1; j >= 0; --j) {
    for (Eigen::Index k = j + 1; k < L.cols(); ++k) X->col(j) -= L(k, j) * X->col(k);
    X->col(j) /= L(j, j);
  }
}

}  // namespace predictor
