// ½ ε |x|² makes the problem strictly convex: P = JᵀJ has rank 12 of 14. ε grows near a
// singularity, where it bounds joint speeds (damped least squares, Nakamura & Hanafusa 1986). The
// damping reduces a handle's speed along a direction with the singular value σ by the fraction ε /
// (σ² + ε).
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/triangular.h"
#include "haptics/assemble.h"
#include "haptics/registry.h"

namespace predictor {
namespace {

constexpr double kRegularDamping = 1e-5;  // ε away from singularities
constexpr double kSingularValue = 0.05;   // smallest singular value below which ε grows

// Returns tr(A⁻¹) = ‖L⁻ᵀ‖² (Frobenius) for A = L Lᵀ.
double TraceOfInverse(const Matrix6& A) {
  const Eigen::LLT<Matrix6> factor(A);
  Matrix6 inverse_transpose = Matrix6::Identity();
  MultiplyByInverseTranspose(factor.matrixLLT(), &inverse_transpose);
  return inverse_transpose.squaredNorm();
}

class Damping final : public Task {
 public:
  explicit Damping(const RenderSetup& setup)
      : Task(0),
        rotation_length_(setup.scenario.rendering.characteristic_length),
        grows_(setup.repairs.Has(Repair::kSingularityDamping)) {}

  void Update(const RenderContext& context, JointObjective* joints) noexcept override {
    Vector6 scale;
    scale << 1, 1, 1, rotation_length_, rotation_length_, rotation_length_;
    for (int i = 0; i < kHands; ++i) {
      if (!context.Has(i)) continue;
      const Jacobian& J = context.J[i];
      joints->damping.segment(context.offset[i], J.cols()).array() += kRegularDamping;
      if (!grows_) continue;
      Matrix6 JJt = 1e-12 * Matrix6::Identity();
      for (int c = 0; c < J.cols(); ++c) {
        const Vector6 column = scale.cwiseProduct(J.col(c));
        JJt.noalias() += column * column.transpose();
      }
      // 1/tr((J Jᵀ)⁻¹) lies between σ_min²/6 and σ_min². This measure requires little computation
      // and is a smooth function of q.
      const double sigma = 1 / std::sqrt(TraceOfInverse(JJt));
      const double near = std::max(0.0, 1 - sigma / kSingularValue);
      joints->damping.segment(context.offset[i], J.cols()).array() +=
          kSingularDamping * near * near;
    }
  }

 private:
  double rotation_length_;  // [m]
  bool grows_;
};

}  // namespace

const TaskKind tasks::kDamping =
    TaskKindOf<Damping>("damping", "bounds joint speeds near a singular posture");

}  // namespace predictor
