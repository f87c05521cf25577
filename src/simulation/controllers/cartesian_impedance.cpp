// Cartesian impedance with the cobot's natural inertia (eq. 2 of the paper).
//
//   τ = g + Jᵀ (Λ ẍ_d + D ẋ̃ + w_K) + τ_posture,   x̃ = set-point − pose of E
//
// Λ = (J M⁻¹ Jᵀ)⁻¹ is the inertia of the cobot alone, so no force has to be measured (Ott 2008). If
// Λ included the load, the damping D would be too large for the wrist. The Coriolis term stays in
// the loop, which is Λ ẍ̃ + (μ + D) ẋ̃ + w_K = F_ext. Cancelling this term would make the loop
// active, since Λ varies (½ Λ̇ − μ is skew-symmetric). The wrench w_K is the gradient of the
// springs' energy (below), and D is positive semidefinite for any posture. Therefore the loop is
// passive if the set-point does not move. While the set-point moves, μ ẋ_d (quadratic in speed)
// acts as a disturbance.
#include <Eigen/Cholesky>
#include <cmath>
#include <string>

#include "core/triangular.h"
#include "simulation/controllers/controllers.h"
#include "simulation/controllers/modal_damping.h"
#include "simulation/controllers/set_point.h"

namespace predictor::controllers {
namespace {

struct CartesianImpedanceParameters {
  // Stiffness and damping apply along and about W's axes, at the end-effector.
  Vector3 stiffness_translation = {500, 500, 500};  // [N/m]
  Vector3 stiffness_rotation = {100, 100, 100};     // [N·m/rad]
  std::vector<double> damping_ratio = {0.7};        // one, or six: x y z, rotation x y z
  double posture_stiffness = 10;                    // null space, towards cobot.posture
                                                    // [N·m/rad], [N/m]
  double posture_damping_ratio = 1.0;
  SetPointParameters set_point;
};

template <class V>
void Fields(V& v, CartesianImpedanceParameters& p) {
  v.Group("stiffness", "at the end-effector", [&](V& g) {
    g("translation", p.stiffness_translation, Number("N/m", "along W's axes", From(0, 1e5)));
    g("rotation", p.stiffness_rotation, Number("N·m/rad", "about W's axes", From(0, 1e4)));
  });
  v("damping_ratio", p.damping_ratio,
    OneOrList(Number("", "one, or x y z, rotation x y z", From(0, 5)), 6, 6));
  v("posture_stiffness", p.posture_stiffness,
    Number("N·m/rad or N/m", "null space, towards cobot.posture", From(0, 1e4)));
  v("posture_damping_ratio", p.posture_damping_ratio, Number("", "null space", From(0, 5)));
  Fields(v, p.set_point);
}

// This value is added to Λ⁻¹ to bound Λ in a singular posture. In such a posture, J cancels the
// large values of Λ, so that the joint torques stay bounded (a test checks this). In other
// postures, the effect is negligible.
constexpr double kMinMobility = 1e-9;  // [1/kg], [1/(kg·m²)]

// Returns the inverse of the left Jacobian of the rotation vector e [rad]. If R = exp(e)ᵀ R_set and
// the spring energy is ½ eᵀ K e, the torque on the body is Jl⁻¹(e) K e. This torque equals K e if K
// is isotropic.
Matrix3 InverseLeftJacobian(const Vector3& e) {
  const double angle2 = e.squaredNorm();
  const double angle = std::sqrt(angle2);
  const double c =
      angle < 1e-3 ? 1.0 / 12 + angle2 / 720 : 1 / angle2 - 0.5 / (angle * std::tan(0.5 * angle));
  const Matrix3 S = Skew(e);
  return Matrix3::Identity() - 0.5 * S + c * S * S;
}

class CartesianImpedance final : public Controller {
 public:
  CartesianImpedance(const ControllerContext& context,
                     const CartesianImpedanceParameters& parameters)
      : set_point_(parameters.set_point.trajectory, context.X_WE_start),
        posture_(context.posture),
        posture_stiffness_(parameters.posture_stiffness),
        posture_ratio_(parameters.posture_damping_ratio),
        damping_(6) {
    K_spec_ << parameters.stiffness_translation, parameters.stiffness_rotation;
    for (int i = 0; i < 6; ++i) ratio_spec_[i] = OneOrEach(parameters.damping_ratio, i);
    ResetTuning();
  }

  // The new offset satisfies K' (e + s') = K (e + s) on each axis.
  void Tune(const ControllerTuning& tuning, const ControllerInput& input,
            bool keeps_force) noexcept override {
    const Vector6 e = Error(Target(input.time).X_W, input);
    Vector6 K = K_spec_;
    K.head<3>() *= tuning.stiffness_translation;
    K.tail<3>() *= tuning.stiffness_rotation;
    for (int i = 0; i < 6; ++i)
      if (K[i] > 0 && keeps_force) shift_[i] = K_[i] / K[i] * (e[i] + shift_[i]) - e[i];
    K_ = K;
    ratio_ = tuning.damping_ratio * ratio_spec_;
  }
  bool has_springs() const noexcept override { return true; }
  void ShiftSetPoint(const Vector6& shift) noexcept override { jump_ = shift; }
  Vector6 set_point_axes() const noexcept override { return StiffAxes(K_spec_); }

  void ResetTuning() noexcept override {
    K_ = K_spec_;
    ratio_ = ratio_spec_;
    shift_.setZero();
    jump_.setZero();
  }
  void Archive(StateArchive& a) noexcept override { a(K_, ratio_, shift_, jump_); }

  void Compute(const ControllerInput& input, JointVector* torque) noexcept override {
    const FrameMotion target = Target(input.time);
    input.data->FrameJacobian(*input.model, input.end_effector, &J_);
    UpdateInertia(input.data->M());

    const Vector6 velocity = J_.lazyProduct(*input.v);
    Vector6 wrench = SpringWrench(target.X_W, input);
    wrench += DampingWrench(target.V_W - velocity);
    if (!target.A_W.isZero(0)) wrench += mobility_.solve(target.A_W);
    *torque = input.data->gravity();
    torque->noalias() += J_.transpose().lazyProduct(wrench);
    if (input.q->size() > 6) AddPostureTorque(input, velocity, torque);
  }

  // Returns the energy of the Cartesian springs. The null-space spring is excluded, because its
  // projection does no work on E, so it has no potential energy.
  double StoredEnergy(const ControllerInput& input) const noexcept override {
    const Vector6 e = Error(Target(input.time).X_W, input) + shift_;
    return 0.5 * e.dot(K_.cwiseProduct(e));
  }

 private:
  FrameMotion Target(double time) const noexcept {
    FrameMotion target = set_point_.At(time);
    ShiftPose(jump_, &target.X_W);
    return target;
  }

  static Vector6 Error(const Pose& X_Wset, const ControllerInput& input) {
    return PoseError(X_Wset, input.data->FramePose(*input.model, input.end_effector));
  }

  Vector6 SpringWrench(const Pose& X_Wset, const ControllerInput& input) const {
    const Vector6 e = Error(X_Wset, input);
    Vector6 wrench = K_.cwiseProduct(e + shift_);
    wrench.tail<3>() = InverseLeftJacobian(e.tail<3>()) * wrench.tail<3>();
    return wrench;
  }

  // The factors follow from the equations M = L Lᵀ and Λ⁻¹ = J M⁻¹ Jᵀ = (J L⁻ᵀ)(J L⁻ᵀ)ᵀ.
  void UpdateInertia(const JointMatrix& M) {
    M_factor_.compute(M);
    half_ = J_;
    MultiplyByInverseTranspose(M_factor_.matrixLLT(), &half_);
    Matrix6 mobility = half_.lazyProduct(half_.transpose());
    mobility.diagonal().array() += kMinMobility;
    mobility_.compute(mobility);
  }

  // Returns D v. If Λ⁻¹ = G Gᵀ, then Λ = L Lᵀ with L = G⁻ᵀ.
  Vector6 DampingWrench(const Twist& v) {
    const Matrix6 G = mobility_.matrixL();
    damping_.Compute(G, K_, ratio_);
    Vector6 x = v;
    mobility_.matrixL().solveInPlace(x);
    Vector6 wrench = damping_.Apply(x);
    mobility_.matrixU().solveInPlace(wrench);
    return wrench;
  }

  // Adds a spring and a damper towards the posture, in the part of the joint space that does not
  // accelerate E. The torque is τ = Pᵀ k (q_0 − q) − c M P q̇, where P = 1 − M⁻¹ Jᵀ Λ J and M P =
  // Pᵀ M P. In a one-dimensional null space, c sets the damping ratio exactly.
  void AddPostureTorque(const ControllerInput& input, const Twist& velocity, JointVector* torque) {
    const auto n = input.q->size();
    const double k = posture_stiffness_;
    if (k <= 0) return;
    from_joints_ = half_;  // J M⁻¹
    MultiplyByInverse(M_factor_.matrixLLT(), &from_joints_);
    J_Lambda_ = J_.transpose();  // Jᵀ Λ
    MultiplyByInverseTranspose(mobility_.matrixLLT(), &J_Lambda_);
    MultiplyByInverse(mobility_.matrixLLT(), &J_Lambda_);

    P_transposed_.setIdentity(n, n);
    P_transposed_.noalias() -= J_Lambda_.lazyProduct(from_joints_);
    const double inertia = input.data->M().cwiseProduct(P_transposed_).sum();  // tr(M P)
    if (inertia <= 0) return;
    const double c = 2 * posture_ratio_ * std::sqrt(k * P_transposed_.squaredNorm() / inertia);
    spring_ = k * (posture_ - *input.q);
    torque->noalias() += P_transposed_.lazyProduct(spring_);
    torque->noalias() -= c * input.data->M().lazyProduct(*input.v);
    torque->noalias() += c * J_Lambda_.lazyProduct(velocity);
  }

  SetPointTrajectory set_point_;
  JointVector posture_;       // [rad]
  double posture_stiffness_;  // [N·m/rad]
  double posture_ratio_;
  Vector6 K_spec_, ratio_spec_;  // from the scenario
  Vector6 K_;                    // as tuned, axes of W [N/m], [N·m/rad]
  Vector6 ratio_;
  Vector6 shift_;  // shift of the set-point by tuning [m], [rad]
  Vector6 jump_;   // by ShiftSetPoint
  // The following members are temporary storage for one step.
  Jacobian J_, half_, from_joints_;
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxJoints, 6> J_Lambda_;
  Eigen::LLT<JointMatrix> M_factor_;
  Eigen::LLT<Matrix6> mobility_;
  ModalDamping<Vector6, Matrix6> damping_;
  JointMatrix P_transposed_;
  JointVector spring_;
};

}  // namespace

const ControllerKind kCartesianImpedance =
    ControllerKindOf<CartesianImpedance, CartesianImpedanceParameters>(
        "cartesian_impedance", "a spring and damper at the end-effector, with the natural inertia");

}  // namespace predictor::controllers
