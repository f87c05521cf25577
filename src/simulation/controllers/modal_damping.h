// Computes a damping by double diagonalisation, which gives each mode of stiffness and inertia the
// desired damping ratio.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

namespace predictor {

// In the basis Q = L U, both an inertia Λ = L Lᵀ and a diagonal stiffness K are diagonal. They are
// Λ = Q Qᵀ and K = Q K0 Qᵀ, with L⁻¹ K L⁻ᵀ = U K0 Uᵀ. The damping D = Q diag(2 ζ √K0) Qᵀ acts on
// each mode separately (Albu-Schäffer, Ott, Frese & Hirzinger 2003, "double diagonalization
// design"). Vector and Matrix are Eigen types of fixed size or of fixed capacity. Does not use the
// heap.
template <class Vector, class Matrix>
class ModalDamping {
 public:
  // `size` is the number of elements of the vectors.
  explicit ModalDamping(Eigen::Index size) : eigen_(size), H_(size, size), damping_(size) {}

  // `L_inverse_transposed` is L⁻ᵀ, `K` the diagonal of the stiffness, and `ratio` the ζ of each
  // axis. The damping ratio of a mode is the mean of the axes' ratios, weighted by each axis's
  // share of the energy in the mode's springs.
  void Compute(const Matrix& L_inverse_transposed, const Vector& K, const Vector& ratio) {
    // With L⁻¹ K L⁻ᵀ = Hᵀ H, column i of H U contains the displacements of mode i, multiplied by
    // √K.
    H_.noalias() = K.cwiseSqrt().asDiagonal() * L_inverse_transposed;
    eigen_.compute(H_.transpose().lazyProduct(H_));
    const Matrix& U = eigen_.eigenvectors();
    const bool same = (ratio.array() == ratio[0]).all();
    for (Eigen::Index i = 0; i < damping_.size(); ++i) {
      const double k0 = std::fmax(eigen_.eigenvalues()[i], 0);
      double zeta = ratio[0];
      if (!same && k0 > 0) zeta = ratio.dot(H_.lazyProduct(U.col(i)).cwiseAbs2()) / k0;
      damping_[i] = 2 * zeta * std::sqrt(k0);
    }
  }

  // Returns U diag(2 ζ √K0) Uᵀ x. If x = Lᵀ v, then L times the result is D v.
  Vector Apply(const Vector& x) const {
    const Matrix& U = eigen_.eigenvectors();
    const Vector modal = damping_.cwiseProduct(U.transpose().lazyProduct(x));
    return U.lazyProduct(modal);
  }

 private:
  Eigen::SelfAdjointEigenSolver<Matrix> eigen_;
  Matrix H_;
  Vector damping_;
};

}  // namespace predictor
