// Admittance control of a position-controlled cobot (Keemink, van der Kooij & Stienen 2018,
// "Admittance control for physical human-robot interaction", figure 1).
//
//   M_d (V̇ − V̇_d) + D_d (V − V_d) + K_d (x − x_d) = F
//
// admittance_law.h describes F and the position loop. V_d is the twist of the set-point, and x_d is
// the integral of V_d. Without a trajectory, both are 0. A jump of the set-point changes only x_d,
// because the speed of a jump is not finite.
#include "simulation/controllers/admittance_law.h"
#include "simulation/controllers/controllers.h"
#include "simulation/controllers/set_point.h"

namespace predictor::controllers {
namespace {

struct PlainAdmittanceParameters {
  AdmittanceParameters law;
  Vector3 stiffness_translation = {0, 0, 0};  // [N/m]
  Vector3 stiffness_rotation = {0, 0, 0};     // [N·m/rad]
  SetPointParameters set_point;
};

template <class V>
void Fields(V& v, PlainAdmittanceParameters& p) {
  Fields(v, p.law);
  v.Group("virtual_stiffness", "K_d, towards the set-point", [&](V& g) {
    g("translation", p.stiffness_translation, Number("N/m", "along W's axes", From(0, 1e5)));
    g("rotation", p.stiffness_rotation, Number("N·m/rad", "about W's axes", From(0, 1e4)));
  });
  Fields(v, p.set_point);
}

class Admittance final : public AdmittanceLaw {
 public:
  Admittance(const ControllerContext& context, const PlainAdmittanceParameters& p)
      : AdmittanceLaw(context, p.law, 0),
        set_point_(p.set_point.trajectory, context.X_WE_start),
        mass_(p.law.Mass()),
        damping_(p.law.Damping()) {
    stiffness_ << p.stiffness_translation, p.stiffness_rotation;
  }

  // The energy is that of the virtual spring.
  double StoredEnergy(const ControllerInput& input) const noexcept override {
    const Vector6 e = x() - PathAt(input.time);
    return 0.5 * e.dot(stiffness_.cwiseProduct(e));
  }
  void ShiftSetPoint(const Vector6& shift) noexcept override { jump_ = shift; }
  Vector6 set_point_axes() const noexcept override { return StiffAxes(stiffness_); }
  void ResetTuning() noexcept override { jump_.setZero(); }
  void Archive(StateArchive& a) noexcept override {
    AdmittanceLaw::Archive(a);
    a(jump_);
  }

 private:
  Wrench Accelerating(const ControllerInput& input, const Wrench& F) noexcept override {
    Vector6 path;
    const FrameMotion d = set_point_.At(input.time, &path);
    return F + mass_.cwiseProduct(d.A_W) - damping_.cwiseProduct(V() - d.V_W) -
           stiffness_.cwiseProduct(x() - path - jump_);
  }
  Vector6 PathAt(double time) const noexcept override { return set_point_.PathAt(time) + jump_; }

  SetPointTrajectory set_point_;
  Vector6 mass_, damping_, stiffness_;  // M_d, D_d, K_d
  Vector6 jump_ = Vector6::Zero();      // by ShiftSetPoint [m], [rad]
};

}  // namespace

const ControllerKind kAdmittance = ControllerKindOf<Admittance, PlainAdmittanceParameters>(
    "admittance", "a position-controlled cobot that yields to the force in its wrist");

}  // namespace predictor::controllers
