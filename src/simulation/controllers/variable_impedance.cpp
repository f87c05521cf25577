// Admittance control whose damping of translation adapts to the person.
//
// adaptation: velocity    d = d_min + (d_0 − d_min) exp(−|v| / v_a)
//   High damping for precision at low speed, low damping for effort at high speed (Ficuciello,
//   Villani & Siciliano 2015, "Variable impedance control of redundant manipulators for intuitive
//   human-robot physical interaction": damping falls exponentially with speed).
//
// adaptation: intention   d = d_0 − α Ḟ·v / |v|, within [d_min, d_max]
//   A force that grows along the motion shows the intention to accelerate, one that falls the
//   intention to brake (Duchaine & Gosselin 2007, "General model of human-robot cooperation using a
//   novel velocity based variable impedance control"). Ḟ = (F − F_f) / T with the low-passed force
//   F_f, Ḟ_f = Ḟ. Below kSlow, the direction v / |v| fades, so that the law is smooth at rest.
//
// d_0 (damping_translation) acts at rest, where the linear model describes the cobot.
// admittance_law.h describes the rest of the law.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/text.h"
#include "simulation/controllers/admittance_law.h"
#include "simulation/controllers/controllers.h"

namespace predictor::controllers {
namespace {

constexpr double kSlow = 0.005;  // [m/s]

struct VariableImpedanceParameters {
  AdmittanceParameters law;
  std::string adaptation = "velocity";
  double damping_minimum = 20;    // [N·s/m]
  double damping_maximum = 500;   // [N·s/m]
  double adaptation_speed = 0.1;  // v_a [m/s]
  double adaptation_gain = 2;     // α [s²/m]
  double derivative_time = 0.05;  // T [s]
};

template <class V>
void Fields(V& v, VariableImpedanceParameters& p) {
  Fields(v, p.law);
  v("adaptation", p.adaptation,
    Word("what changes the damping of translation", {"velocity", "intention"}));
  v("damping_minimum", p.damping_minimum,
    Number("N·s/m", "minimum damping of translation", From(0, 1e5)));
  v("damping_maximum", p.damping_maximum,
    Number("N·s/m", "intention: maximum damping of translation", From(0, 1e5)));
  v("adaptation_speed", p.adaptation_speed,
    Number("m/s", "velocity: speed at which the damping above the minimum has fallen by a factor e",
           Above(0, 10)));
  v("adaptation_gain", p.adaptation_gain,
    Number("s²/m", "intention: decrease of the damping for each N/s along the motion",
           From(0, 1000)));
  v("derivative_time", p.derivative_time,
    Number("s", "intention: time constant of the force's derivative", From(0.002, 1)));
}

class VariableImpedance final : public AdmittanceLaw {
 public:
  VariableImpedance(const ControllerContext& context, const VariableImpedanceParameters& p)
      : AdmittanceLaw(context, p.law, 3),
        p_(p),
        by_velocity_(p.adaptation == "velocity"),
        damping_(p.law.Damping()) {
    RequireOrder("damping_minimum", p.damping_minimum, p.law.damping_translation, "at most");
    if (!by_velocity_)
      RequireOrder("damping_maximum", p.law.damping_translation, p.damping_maximum, "at least");
  }

 private:
  void RequireOrder(const char* key, double low, double high, const char* must) const {
    if (low <= high) return;
    const std::string path = std::string("cobot.controller.") + key;
    const double value = std::string(must) == "at most" ? low : high;
    throw InputError::At(path, path + " is " + FormatNumber(value) + " N·s/m; it must be " + must +
                                   " damping_translation, " +
                                   FormatNumber(p_.law.damping_translation) + " N·s/m.");
  }

  Vector3 ForceRate(const Wrench& F) noexcept {
    return (F.head<3>() - Vector3::Map(own())) / p_.derivative_time;
  }

  double Damping(const Wrench& F) noexcept {
    const double d0 = p_.law.damping_translation;
    const Vector3 v = V().head<3>();
    if (by_velocity_)
      return p_.damping_minimum +
             (d0 - p_.damping_minimum) * std::exp(-v.norm() / p_.adaptation_speed);
    const double along = ForceRate(F).dot(v) / std::sqrt(v.squaredNorm() + kSlow * kSlow);
    return std::clamp(d0 - p_.adaptation_gain * along, p_.damping_minimum, p_.damping_maximum);
  }

  Wrench Accelerating(const ControllerInput&, const Wrench& F) noexcept override {
    damping_.head<3>().setConstant(Damping(F));
    return F - damping_.cwiseProduct(V());
  }

  void AdvanceOwn(const ControllerInput&, const Wrench& F, double dt) noexcept override {
    const Vector3 rate = ForceRate(F);
    Vector3::Map(own()) += std::min(dt, p_.derivative_time) * rate;
  }

  VariableImpedanceParameters p_;
  bool by_velocity_;
  Vector6 damping_;  // at present
};

}  // namespace

const ControllerKind kVariableImpedance =
    ControllerKindOf<VariableImpedance, VariableImpedanceParameters>(
        "variable_impedance", "admittance whose damping adapts to the speed or to the intention");

}  // namespace predictor::controllers
