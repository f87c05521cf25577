// Springs and dampers in the joints, τ = g + K (q_0 − q) − D q̇. D results from double
// diagonalisation of the cobot's mass matrix and K. The set-point is the posture and does not move.
#include <Eigen/Cholesky>

#include "simulation/controllers/controllers.h"
#include "simulation/controllers/modal_damping.h"

namespace predictor::controllers {
namespace {

struct JointImpedanceParameters {
  std::vector<double> stiffness = {100};      // one for all, or one per joint [N·m/rad], [N/m]
  std::vector<double> damping_ratio = {0.7};  // one for all, or one per joint
};

template <class V>
void Fields(V& v, JointImpedanceParameters& p) {
  v("joint_stiffness", p.stiffness,
    OneOrList(Number("N·m/rad or N/m", "stiffness for all joints, or one per joint", From(0, 1e5)),
              1, kMaxCobotJoints));
  v("joint_damping_ratio", p.damping_ratio,
    OneOrList(Number("", "damping ratio for all joints, or one per joint", From(0, 5)), 1,
              kMaxCobotJoints));
}

class JointImpedance final : public Controller {
 public:
  JointImpedance(const ControllerContext& context, const JointImpedanceParameters& parameters)
      : posture_(context.posture),
        K_(PerJoint(context, "joint_stiffness", parameters.stiffness)),
        ratio_(PerJoint(context, "joint_damping_ratio", parameters.damping_ratio)),
        L_inverse_transposed_(context.posture.size(), context.posture.size()),
        damping_(context.posture.size()) {
    K_spec_ = K_;
    ratio_spec_ = ratio_;
    posture_spec_ = posture_;
  }

  // The new set-point satisfies K' (q_0' − q) = K (q_0 − q). A joint uses the factor for the
  // stiffness of its kind (rotation or translation).
  void Tune(const ControllerTuning& tuning, const ControllerInput& input,
            bool keeps_force) noexcept override {
    for (int j = 0; j < K_.size(); ++j) {
      const double K = (input.model->is_prismatic(j) ? tuning.stiffness_translation
                                                     : tuning.stiffness_rotation) *
                       K_spec_[j];
      const double q = (*input.q)[j];
      if (K > 0 && keeps_force) posture_[j] = q + K_[j] / K * (posture_[j] - q);
      K_[j] = K;
    }
    ratio_ = tuning.damping_ratio * ratio_spec_;
  }
  bool has_springs() const noexcept override { return true; }

  void ResetTuning() noexcept override {
    K_ = K_spec_;
    ratio_ = ratio_spec_;
    posture_ = posture_spec_;
  }
  void Archive(StateArchive& a) noexcept override { a(posture_, K_, ratio_); }

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
  JointVector posture_;  // [rad], [m]
  JointVector K_;        // [N·m/rad], [N/m]
  JointVector ratio_;
  JointVector posture_spec_, K_spec_, ratio_spec_;  // from the scenario
  // The following members are temporary storage for one step.
  Eigen::LLT<JointMatrix> M_factor_;
  JointMatrix L_inverse_transposed_;
  ModalDamping<JointVector, JointMatrix> damping_;
};

}  // namespace

const ControllerKind kJointImpedance = ControllerKindOf<JointImpedance, JointImpedanceParameters>(
    "joint_impedance", "springs and dampers in the joints hold cobot.posture");

}  // namespace predictor::controllers
