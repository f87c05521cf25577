// Admittance control of a position-controlled cobot (Keemink, van der Kooij & Stienen 2018,
// "Admittance control for physical human-robot interaction", figure 1).
//
//   M_d V̇ + D_d V + K_d x = F,   F: wrist sensor's reading minus its value at the start
//
// The reference twist V of the end-effector becomes joint velocities by damped least squares, with
// a slow return to cobot.posture in the null space. A stiff loop follows the joint reference:
//
//   τ = g + M (ω² (q_ref − q) + 2 ω (q̇_ref − q̇))
//
// The tare at the start includes the load's weight, as on a real cobot. The loop has memory: V, x
// and q_ref.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "simulation/controllers/controllers.h"

namespace predictor::controllers {
namespace {

constexpr double kDampedInverse = 1e-3;  // of the pseudo-inverse
constexpr double kPostureRate = 0.5;     // return to the posture in the null space [1/s]

struct AdmittanceParameters {
  double mass = 8;                            // [kg]
  double inertia = 0.3;                       // [kg·m²]
  double damping_translation = 60;            // [N·s/m]
  double damping_rotation = 2;                // [N·m·s/rad]
  Vector3 stiffness_translation = {0, 0, 0};  // [N/m]
  Vector3 stiffness_rotation = {0, 0, 0};     // [N·m/rad]
  double inner_frequency = 8;                 // natural frequency of the position loop [Hz]
};

template <class V>
void Fields(V& v, AdmittanceParameters& p) {
  v("virtual_mass", p.mass, Number("kg", "M_d of translation", Above(0, 1000)));
  v("virtual_inertia", p.inertia, Number("kg·m²", "M_d of rotation", Above(0, 100)));
  v("damping_translation", p.damping_translation,
    Number("N·s/m", "D_d of translation", From(0, 1e5)));
  v("damping_rotation", p.damping_rotation, Number("N·m·s/rad", "D_d of rotation", From(0, 1e4)));
  v.Group("virtual_stiffness", "K_d, towards the start", [&](V& g) {
    g("translation", p.stiffness_translation, Number("N/m", "along W's axes", From(0, 1e5)));
    g("rotation", p.stiffness_rotation, Number("N·m/rad", "about W's axes", From(0, 1e4)));
  });
  v("inner_frequency", p.inner_frequency,
    Number("Hz", "natural frequency of the position loop", Above(0, 50)));
}

class Admittance final : public Controller {
 public:
  Admittance(const ControllerContext& context, const AdmittanceParameters& p)
      : posture_(context.posture),
        omega_(2 * std::numbers::pi * p.inner_frequency),
        memory_(static_cast<std::size_t>(kReference + context.posture.size())) {
    mass_ << Vector3::Constant(p.mass), Vector3::Constant(p.inertia);
    damping_ << Vector3::Constant(p.damping_translation), Vector3::Constant(p.damping_rotation);
    stiffness_ << p.stiffness_translation, p.stiffness_rotation;
    Reference() = posture_;
  }

  bool uses_wrist_sensor() const noexcept override { return true; }
  std::span<double> memory() noexcept override { return memory_; }

  void Start(const ControllerInput& input) noexcept override {
    tare_ = input.F_E_W;
    std::fill(memory_.begin(), memory_.end(), 0.0);
    Reference() = posture_;
  }

  void Advance(const ControllerInput& input, double dt) noexcept override {
    const Vector6 V = Part(kTwist), x = Part(kDisplacement);
    const Vector6 F = input.F_E_W - tare_;
    const Vector6 rate =
        (F - damping_.cwiseProduct(V) - stiffness_.cwiseProduct(x)).cwiseQuotient(mass_);
    const JointVector speed = ReferenceSpeed(input);
    Part(kTwist) = V + dt * rate;
    Part(kDisplacement) = x + dt * V;
    Reference() += dt * speed;
  }

  void Compute(const ControllerInput& input, JointVector* torque) noexcept override {
    const JointVector speed = ReferenceSpeed(input);
    const JointVector wanted =
        omega_ * omega_ * (Reference() - *input.q) + 2 * omega_ * (speed - *input.v);
    *torque = input.data->gravity();
    torque->noalias() += input.data->M().lazyProduct(wanted);
  }

  // The virtual spring's.
  double StoredEnergy(const ControllerInput&) const noexcept override {
    const Eigen::Map<const Vector6> x(memory_.data() + kDisplacement);
    return 0.5 * x.dot(stiffness_.cwiseProduct(x));
  }

  void Archive(StateArchive& a) noexcept override { a(tare_); }

 private:
  static constexpr int kTwist = 0, kDisplacement = 6, kReference = 12;  // places in the memory

  Eigen::Map<Vector6> Part(int at) { return Eigen::Map<Vector6>(memory_.data() + at); }
  Eigen::Map<JointVector> Reference() {
    return Eigen::Map<JointVector>(memory_.data() + kReference, posture_.size());
  }

  // q̇_ref = J⁺ V + (1 − J⁺ J) (posture − q_ref) / time.
  JointVector ReferenceSpeed(const ControllerInput& input) noexcept {
    input.data->FrameJacobian(*input.model, input.end_effector, &J_);
    Matrix6 JJt = J_.lazyProduct(J_.transpose());
    JJt.diagonal().array() += kDampedInverse * kDampedInverse;
    factor_.compute(JJt);
    const JointVector home = kPostureRate * (posture_ - Reference());
    const Vector6 twist = Part(kTwist) - J_.lazyProduct(home);
    return home + J_.transpose().lazyProduct(factor_.solve(twist));
  }

  JointVector posture_;                 // [rad]
  double omega_;                        // of the position loop [rad/s]
  Vector6 mass_, damping_, stiffness_;  // M_d, D_d, K_d
  Vector6 tare_ = Vector6::Zero();      // [N], [N·m]
  std::vector<double> memory_;          // V (6), x (6), q_ref
  Jacobian J_;                          // workspace
  Eigen::LLT<Matrix6> factor_;
};

}  // namespace

const ControllerKind kAdmittance = ControllerKindOf<Admittance, AdmittanceParameters>(
    "admittance", "a position-controlled cobot that yields to the force in its wrist");

}  // namespace predictor::controllers
