// The cobot carries a share of a load that it knows (Lawitzky, Mörtl & Hirche 2010, "Load sharing
// in human-robot cooperative manipulation"; Mörtl, Lawitzky, Kucukyilmaz, Sezgin, Basdogan & Hirche
// 2012, "The role of roles: physical cooperation between humans and robots"). The cobot and the
// person divide the force that moves the object in fixed shares.
//
//   F = α m g_up + β m ẍ,   at the object's centre of mass
//
// ẍ is the acceleration of the end-effector, from its velocity: ẍ = (ẋ − v_f) / T, v̇_f = ẍ. The
// hands carry the rest. The file wrench_control.h describes the torques.
#include <array>

#include "simulation/controllers/controllers.h"
#include "simulation/controllers/wrench_control.h"

namespace predictor::controllers {
namespace {

struct LoadSharingParameters {
  WrenchControlParameters control;
  KnownLoad load;
  double share = 0.5;               // α
  double inertia_share = 0;         // β
  double acceleration_time = 0.02;  // T [s]
};

template <class V>
void Fields(V& v, LoadSharingParameters& p) {
  Fields(v, p.load);
  v("share", p.share,
    Number("", "share of the object's weight that the cobot carries", From(0, 1)));
  v("inertia_share", p.inertia_share,
    Number("", "share of the object's inertial force that the cobot exerts", From(0, 0.9)));
  v("acceleration_time", p.acceleration_time,
    Number("s", "time constant of the filter of the measured acceleration", From(0.002, 1)));
  Fields(v, p.control);
}

class LoadSharing final : public WrenchControl {
 public:
  LoadSharing(const ControllerContext& context, const LoadSharingParameters& parameters)
      : WrenchControl(context, parameters.control), p_(parameters) {}

  std::span<double> memory() noexcept override { return velocity_; }
  void Start(const ControllerInput&) noexcept override { velocity_.fill(0); }
  // The step is implicit, because Compute uses the v_f that results from this step. If the
  // acceleration is constant, ẍ is therefore exact.
  void Advance(const ControllerInput& input, double dt) noexcept override {
    const Twist V = input.data->FrameTwist(*input.model, input.end_effector);
    auto v_f = Vector3::Map(velocity_.data());
    v_f += dt / (p_.acceleration_time + dt) * (V.head<3>() - v_f);
  }

 private:
  Vector3 Acceleration(const Twist& V) const noexcept {
    return (V.head<3>() - Vector3::Map(velocity_.data())) / p_.acceleration_time;
  }

  Vector3 Carried() const noexcept {
    return p_.share * p_.load.mass * gravity() * Vector3::UnitZ();
  }

  Wrench Command(const Pose&, const Pose& X, const Twist& V) noexcept override {
    return p_.load.WrenchOf(Carried() + p_.inertia_share * p_.load.mass * Acceleration(V), X);
  }

  double Potential(const Pose& X, const Pose&) const noexcept override {
    return -Carried().dot(X * p_.load.center_of_mass);
  }

  LoadSharingParameters p_;
  std::array<double, 3> velocity_ = {};  // v_f
};

}  // namespace

const ControllerKind kLoadSharing = ControllerKindOf<LoadSharing, LoadSharingParameters>(
    "load_sharing", "carries a share of a known load; the hands carry the rest");

}  // namespace predictor::controllers
