// Admittance control that contributes to the movement that the person intends (Maeda, Hara & Arai
// 2001, "Human-robot cooperative manipulation with motion estimation"; Corteville, Aertbeliën,
// Bruyninckx, De Schutter & Van Brussel 2007, "Human-inspired robot assistant for fast
// point-to-point movements").
//
// A person moves a thing from one place to another with minimum jerk. The estimate in
// minimum_jerk_estimate.h yields the distance and the duration from the pose and twist of the
// end-effector. The cobot then contributes a share α of the force that this movement needs:
//
//   M_d V̇ + D_d V = F + α w (D_d V_e + (M_d + m) V̇_e)
//
// V_e and V̇_e are the twist and the acceleration of the estimated movement, and m is the mass of
// the load. With α = 1 and the right m, the movement continues as it began, without a force of the
// hand. The weight w is less than 1 at both ends of the movement, where the estimate is uncertain.
// Rotation is plain admittance.
#include <algorithm>

#include "simulation/controllers/admittance_law.h"
#include "simulation/controllers/controllers.h"
#include "simulation/controllers/minimum_jerk_estimate.h"

namespace predictor::controllers {
namespace {

constexpr double kUncertain = 0.1, kCertain = 0.3;  // phases between which w rises
constexpr double kFades = 0.9;                      // from here to the end, w falls
constexpr double kLongest = 2, kSlowest = 15;       // movement by hand [m], [s]

struct MinimumJerkParameters {
  AdmittanceParameters law;
  double assistance = 0.5;    // α
  double onset_speed = 0.02;  // [m/s]
  double load_mass = 0;       // m [kg]
};

template <class V>
void Fields(V& v, MinimumJerkParameters& p) {
  Fields(v, p.law);
  v("assistance", p.assistance,
    Number("", "the cobot's share of the force of the movement", From(0, 1)));
  v("onset_speed", p.onset_speed,
    Number("m/s",
           "speed at which a movement is detected; below a quarter of it, the hand is at rest",
           Above(0, 1)));
  v("load_mass", p.load_mass,
    Number("kg", "mass of the object, whose inertia the cobot also shares", From(0, 1000)));
}

class MinimumJerkIntention final : public AdmittanceLaw {
 public:
  MinimumJerkIntention(const ControllerContext& context, const MinimumJerkParameters& p)
      : AdmittanceLaw(context, p.law, MovementOnset::kSize), p_(p), damping_(p.law.Damping()) {}

 private:
  Wrench Accelerating(const ControllerInput& input, const Wrench& F) noexcept override {
    Wrench sum = F - damping_.cwiseProduct(V());
    sum.head<3>() += Assistance(input);
    return sum;
  }

  Vector3 Assistance(const ControllerInput& input) noexcept {
    const MinimumJerkEstimate e = MovementOnset(own()).Estimate(Position(input), Velocity(input));
    const double rise = (e.phase - kUncertain) / (kCertain - kUncertain);
    const double fall = (1 - e.phase) / (1 - kFades);
    const double w = std::clamp(std::min(rise, fall), 0.0, 1.0);
    if (w == 0 || e.duration > kSlowest || e.distance.norm() > kLongest) return Vector3::Zero();
    return p_.assistance * w *
           (p_.law.damping_translation * e.Velocity() +
            (p_.law.mass + p_.load_mass) * e.Acceleration());
  }

  void AdvanceOwn(const ControllerInput& input, const Wrench&, double dt) noexcept override {
    MovementOnset(own()).Advance(Position(input), Velocity(input), p_.onset_speed, dt);
  }

  static Vector3 Position(const ControllerInput& input) {
    return input.data->FramePose(*input.model, input.end_effector).p;
  }
  static Vector3 Velocity(const ControllerInput& input) {
    return input.data->FrameTwist(*input.model, input.end_effector).head<3>();
  }

  MinimumJerkParameters p_;
  Vector6 damping_;
};

}  // namespace

const ControllerKind kMinimumJerkIntention =
    ControllerKindOf<MinimumJerkIntention, MinimumJerkParameters>(
        "minimum_jerk_intention", "admittance that assists the movement that the person intends");

}  // namespace predictor::controllers
