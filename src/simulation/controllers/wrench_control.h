// The common part of the controllers that exert a wrench F at the end-effector while the cobot
// carries its own weight:
//
//   τ = g + Jᵀ (F − D (V − V_d) + k e)
//
// k e keeps the orientation of the set-point (rotation vector e), and D damps every motion relative
// to that of the set-point. The set-point rests at the start, unless the derived controller moves
// it or an event shifts it.
#pragma once

#include "simulation/controller.h"

namespace predictor::controllers {

struct WrenchControlParameters {
  double damping_translation = 20;  // [N·s/m]
  double damping_rotation = 5;      // [N·m·s/rad]
  double stiffness_rotation = 100;  // k [N·m/rad]
};

template <class V>
void Fields(V& v, WrenchControlParameters& p) {
  v("damping_translation", p.damping_translation,
    Number("N·s/m", "damping of the end-effector's translation", From(0, 1e5)));
  v("damping_rotation", p.damping_rotation,
    Number("N·m·s/rad", "damping of the end-effector's rotation", From(0, 1e4)));
  v("stiffness_rotation", p.stiffness_rotation,
    Number("N·m/rad",
           "stiffness towards the orientation of the set-point, by default that of the start",
           From(0, 1e4)));
}

// The data of the object that the controller knows.
struct KnownLoad {
  double mass = 0;                     // [kg]
  Vector3 center_of_mass = {0, 0, 0};  // p in E [m]

  // Returns the wrench about E, in axes of W, that exerts `force` [N] at the centre of mass.
  Wrench WrenchOf(const Vector3& force, const Pose& X_WE) const noexcept {
    return (Wrench() << force, (X_WE.q * center_of_mass).cross(force)).finished();
  }
};

template <class V>
void Fields(V& v, KnownLoad& p) {
  v("object_mass", p.mass,
    Number("kg", "mass of the object that the controller assumes", From(0, 1000)));
  v("object_center_of_mass", p.center_of_mass,
    Number("m", "centre of mass in the end-effector's frame; for a ball joint, the joint's centre",
           Within(10)));
}

class WrenchControl : public Controller {
 public:
  void Compute(const ControllerInput& input, JointVector* torque) noexcept final;
  double StoredEnergy(const ControllerInput& input) const noexcept final;
  void ShiftSetPoint(const Vector6& shift) noexcept final { jump_ = shift; }
  Vector6 set_point_axes() const noexcept override;
  void ResetTuning() noexcept final { jump_.setZero(); }
  void Archive(StateArchive& a) noexcept override { a(jump_); }

 protected:
  WrenchControl(const ControllerContext& context, const WrenchControlParameters& parameters)
      : p_(parameters), gravity_(context.gravity), X_start_(context.X_WE_start) {}

  // Returns F, about E, in axes of W. `set_point` is the pose that SetPoint returns, after the
  // shift by an event.
  virtual Wrench Command(const Pose& set_point, const Pose& X_WE, const Twist& V_WE) noexcept = 0;
  // Returns the potential energy of F [J] for a pose of the end-effector and a set-point.
  virtual double Potential(const Pose&, const Pose&) const noexcept { return 0; }
  // Returns the set-point at the time [s].
  virtual FrameMotion SetPoint(double) const noexcept {
    FrameMotion motion;
    motion.X_W = X_start_;
    return motion;
  }

  const Pose& start() const noexcept { return X_start_; }
  double gravity() const noexcept { return gravity_; }

 private:
  FrameMotion Target(double time) const noexcept;  // set-point including its shift

  WrenchControlParameters p_;
  double gravity_;  // [m/s²]
  Pose X_start_;
  Vector6 jump_ = Vector6::Zero();  // by ShiftSetPoint [m], [rad]
  Jacobian J_;                      // workspace
};

}  // namespace predictor::controllers
