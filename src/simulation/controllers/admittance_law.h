// The law of the controllers that yield to the force in the wrist, and the position loop that
// follows its reference.
//
//   M_d V̇ + D_d V = F + F_a,   F: wrist sensor's reading minus its value at the start
//
// The reference twist V of the end-effector becomes joint velocities by damped least squares, with
// a slow return to cobot.posture in the null space. A stiff loop follows the joint reference:
//
//   τ = g + M (ω² (q_ref − q) + 2 ω (q̇_ref − q̇))
//
// q_ref is the integral of q̇_ref, so this is also the loop of a velocity-controlled cobot, with
// proportional and integral action on the error of the velocity.
//
// The tare at the start includes the load's weight, as on a real cobot. The memory contains V, the
// displacement x (its integral), q_ref, and the state of the derived controller.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "simulation/controller.h"

namespace predictor::controllers {

struct AdmittanceParameters {
  double mass = 8;                  // [kg]
  double inertia = 0.3;             // [kg·m²]
  double damping_translation = 60;  // [N·s/m]
  double damping_rotation = 2;      // [N·m·s/rad]
  double inner_frequency = 8;       // natural frequency of the position loop [Hz]

  Vector6 Mass() const noexcept;     // diagonal of M_d
  Vector6 Damping() const noexcept;  // diagonal of D_d
};

template <class V>
void Fields(V& v, AdmittanceParameters& p) {
  v("virtual_mass", p.mass, Number("kg", "M_d of translation", Above(0, 1000)));
  v("virtual_inertia", p.inertia, Number("kg·m²", "M_d of rotation", Above(0, 100)));
  v("damping_translation", p.damping_translation,
    Number("N·s/m", "D_d of translation", From(0, 1e5)));
  v("damping_rotation", p.damping_rotation, Number("N·m·s/rad", "D_d of rotation", From(0, 1e4)));
  v("inner_frequency", p.inner_frequency,
    Number("Hz", "natural frequency of the position loop", Above(0, 50)));
}

class AdmittanceLaw : public Controller {
 public:
  bool uses_wrist_sensor() const noexcept final { return true; }
  std::span<double> memory() noexcept final { return memory_; }
  void Start(const ControllerInput& input) noexcept final;
  // The reference begins at the value at which the torques do not jump, and the set-point continues
  // from the place of the end-effector. The tare that was taken at the start remains valid.
  void TakeOver(const ControllerInput& input) noexcept final;
  void Advance(const ControllerInput& input, double dt) noexcept final;
  void Compute(const ControllerInput& input, JointVector* torque) noexcept final;
  double StoredEnergy(const ControllerInput&) const noexcept override { return 0; }
  void Archive(StateArchive& a) noexcept override { a(tare_); }

 protected:
  // `own` is the number of values that the derived controller has in the memory. These values are 0
  // at the start.
  AdmittanceLaw(const ControllerContext& context, const AdmittanceParameters& parameters, int own);

  // Returns the wrench that accelerates M_d.
  virtual Wrench Accelerating(const ControllerInput& input, const Wrench& F) noexcept = 0;
  // Returns the displacement x_d of the set-point since the start [m], [rad].
  virtual Vector6 PathAt(double) const noexcept { return Vector6::Zero(); }
  // Advances the derived controller's values before V and x advance.
  virtual void AdvanceOwn(const ControllerInput&, const Wrench&, double) noexcept {}

  Vector6 V() const noexcept { return Vector6::Map(memory_.data()); }
  Vector6 x() const noexcept { return Vector6::Map(memory_.data() + kDisplacement); }
  double* own() noexcept { return memory_.data() + kReference + posture_.size(); }

 private:
  static constexpr int kDisplacement = 6, kReference = 12;  // places in the memory

  Eigen::Map<JointVector> Reference() noexcept {
    return Eigen::Map<JointVector>(memory_.data() + kReference, posture_.size());
  }
  JointVector ReferenceSpeed(const ControllerInput& input) noexcept;

  JointVector posture_;  // [rad]
  Vector6 mass_;
  double omega_;                  // of the position loop [rad/s]
  Wrench tare_ = Wrench::Zero();  // [N], [N·m]
  std::vector<double> memory_;    // V (6), x (6), q_ref, the derived controller's
  Jacobian J_;                    // workspace
  Eigen::LLT<Matrix6> factor_;
  Eigen::LLT<JointMatrix> M_factor_;
};

}  // namespace predictor::controllers
