// Admittance control of a position-controlled cobot (Keemink, van der Kooij & Stienen 2018,
// "Admittance control for physical human-robot interaction", figure 1).
//
//   M_d V̇ + D_d V + K_d x = F
//
// admittance_law.h describes F and the position loop.
#include "simulation/controllers/admittance_law.h"
#include "simulation/controllers/controllers.h"

namespace predictor::controllers {
namespace {

struct PlainAdmittanceParameters {
  AdmittanceParameters law;
  Vector3 stiffness_translation = {0, 0, 0};  // [N/m]
  Vector3 stiffness_rotation = {0, 0, 0};     // [N·m/rad]
};

template <class V>
void Fields(V& v, PlainAdmittanceParameters& p) {
  Fields(v, p.law);
  v.Group("virtual_stiffness", "K_d, towards the start", [&](V& g) {
    g("translation", p.stiffness_translation, Number("N/m", "along W's axes", From(0, 1e5)));
    g("rotation", p.stiffness_rotation, Number("N·m/rad", "about W's axes", From(0, 1e4)));
  });
}

class Admittance final : public AdmittanceLaw {
 public:
  Admittance(const ControllerContext& context, const PlainAdmittanceParameters& p)
      : AdmittanceLaw(context, p.law, 0), damping_(p.law.Damping()) {
    stiffness_ << p.stiffness_translation, p.stiffness_rotation;
  }

  // The energy is that of the virtual spring.
  double StoredEnergy(const ControllerInput&) const noexcept override {
    return 0.5 * x().dot(stiffness_.cwiseProduct(x()));
  }

 private:
  Wrench Accelerating(const ControllerInput&, const Wrench& F) noexcept override {
    return F - damping_.cwiseProduct(V()) - stiffness_.cwiseProduct(x());
  }

  Vector6 damping_, stiffness_;  // D_d, K_d
};

}  // namespace

const ControllerKind kAdmittance = ControllerKindOf<Admittance, PlainAdmittanceParameters>(
    "admittance", "a position-controlled cobot that yields to the force in its wrist");

}  // namespace predictor::controllers
