// Springs and dampers in the joints: τ = g + K (q_0 − q) − D q̇, D by double diagonalisation of the
// cobot's mass matrix and K. The set-point is the posture; it does not move.
#include <Eigen/Cholesky>

#include "core/error.h"
#include "simulation/controllers/controllers.h"
#include "simulation/controllers/modal_damping.h"

namespace predictor {
namespace {

class JointImpedance final : public Controller {
 public:
  explicit JointImpedance(const ControllerContext& context)
      : posture_(context.posture),
        K_(context.posture.size()),
        ratio_(context.posture.size()),
        L_inverse_transposed_(context.posture.size(), context.posture.size()),
        damping_(context.posture.size()) {
    if (!context.spec.trajectory.empty()) {
      throw InputError(
          "cobot.controller.trajectory: joint_impedance holds cobot.posture and follows no "
          "waypoints. Leave the trajectory out, or choose type: cartesian_impedance.");
    }
    for (int i = 0; i < K_.size(); ++i) {
      K_[i] = OneOrEach(context.spec.joint_stiffness, i);
      ratio_[i] = OneOrEach(context.spec.joint_damping_ratio, i);
    }
  }

  void Compute(const ControllerInput& input, JointVector* torque) noexcept override {
    M_factor_.compute(input.data->M());
    L_inverse_transposed_.setIdentity();
    M_factor_.matrixU().solveInPlace(L_inverse_transposed_);
    damping_.Compute(L_inverse_transposed_, K_, ratio_);
    const JointVector x = M_factor_.matrixU() * *input.v;
    const JointVector y = damping_.Apply(x);
    *torque = input.data->gravity() + K_.cwiseProduct(posture_ - *input.q);
    torque->noalias() -= M_factor_.matrixL() * y;
  }

  double StoredEnergy(const ControllerInput& input) const noexcept override {
    return 0.5 * K_.dot((posture_ - *input.q).cwiseAbs2());
  }

 private:
  JointVector posture_;  // [rad]
  JointVector K_;        // [N·m/rad]
  JointVector ratio_;
  // Workspace.
  Eigen::LLT<JointMatrix> M_factor_;
  JointMatrix L_inverse_transposed_;
  ModalDamping<JointVector, JointMatrix> damping_;
};

}  // namespace

std::unique_ptr<Controller> MakeJointImpedance(const ControllerContext& context) {
  return std::make_unique<JointImpedance>(context);
}

}  // namespace predictor
