// Virtual fixtures (Rosenberg 1993, "Virtual fixtures: perceptual tools for telerobotic
// manipulation"; Abbott, Marayong & Okamura 2007, "Haptic virtual fixtures for robot-assisted
// manipulation"; Bowyer, Davies & Rodriguez y Baena 2014, "Active constraints/virtual fixtures: a
// survey"). A guide is a line or a plane, with a spring and a damper perpendicular to it. A zone
// limits the speed.
//
//   F = −K P (x − x_0) − D P ẋ,   P = 1 − u uᵀ (line along u), u uᵀ (plane normal to u)
//
// The zone is a sphere with a damper, F = −D_z s ẋ. The factor s falls smoothly from 1 to 0 across
// the edge of the sphere. The cobot carries a known load. The file wrench_control.h describes the
// torques.
#include <string>

#include "core/error.h"
#include "core/minimum_jerk.h"
#include "simulation/controllers/controllers.h"
#include "simulation/controllers/wrench_control.h"

namespace predictor::controllers {
namespace {

struct VirtualFixturesParameters {
  WrenchControlParameters control;
  KnownLoad load;
  std::string guide = "none";
  Vector3 direction = {0, 0, 1};    // u, of any length
  Vector3 offset = {0, 0, 0};       // of x_0 from the start of E [m]
  double stiffness = 1000;          // K [N/m]
  double damping = 60;              // D [N·s/m]
  double zone_radius = 0;           // [m]
  Vector3 zone_center = {0, 0, 0};  // offset from the start of E [m]
  double zone_damping = 100;        // D_z [N·s/m]
  double zone_edge = 0.02;          // [m]
};

template <class V>
void Fields(V& v, VirtualFixturesParameters& p) {
  Fields(v, p.load);
  v.Group("guide", "a spring and a damper across a line or plane", [&](V& g) {
    g("type", p.guide, Word("what guides the end-effector", {"none", "line", "plane"}));
    g("direction", p.direction,
      Number("", "direction of the line, or normal of the plane, in W", Within(1)));
    g("offset", p.offset,
      Number("m", "offset from the start of a point on the line or plane, in W", Within(10)));
    g("stiffness", p.stiffness, Number("N/m", "stiffness across the line or plane", From(0, 1e5)));
    g("damping", p.damping, Number("N·s/m", "damping across the line or plane", From(0, 1e5)));
  });
  v.Group("zone", "a sphere in which a damper limits the speed", [&](V& g) {
    g("radius", p.zone_radius, Number("m", "radius of the zone; 0: no zone", From(0, 10)));
    g("center", p.zone_center,
      Number("m", "offset of the zone's centre from the start, in W", Within(10)));
    g("damping", p.zone_damping, Number("N·s/m", "damping in the zone", From(0, 1e5)));
    g("edge", p.zone_edge,
      Number("m", "distance outside the radius over which the damping fades", From(0.001, 1)));
  });
  Fields(v, p.control);
}

class VirtualFixtures final : public WrenchControl {
 public:
  VirtualFixtures(const ControllerContext& context, const VirtualFixturesParameters& parameters)
      : WrenchControl(context, parameters.control), p_(parameters) {
    if (p_.guide == "none") return;
    if (p_.direction.norm() < 1e-6) {
      const std::string key = "cobot.controller.guide.direction";
      throw InputError::At(key, key + " has no length. Give a direction, such as [0, 0, 1].");
    }
    const Vector3 u = p_.direction.normalized();
    across_ = u * u.transpose();
    if (p_.guide == "line") across_ = Matrix3::Identity() - across_;
  }

 private:
  Vector3 Displacement(const Pose& X) const noexcept {
    return across_ * (X.p - start().p - p_.offset);
  }
  double InZone(const Pose& X) const noexcept {
    const double distance = (X.p - start().p - p_.zone_center).norm();
    return p_.zone_radius > 0 ? MinimumJerk((p_.zone_radius - distance) / p_.zone_edge + 1) : 0;
  }
  Vector3 Weight() const noexcept { return p_.load.mass * gravity() * Vector3::UnitZ(); }

  Wrench Command(const Pose&, const Pose& X, const Twist& V) noexcept override {
    Wrench F = p_.load.WrenchOf(Weight(), X);
    F.head<3>() -= p_.stiffness * Displacement(X) + p_.damping * across_ * V.head<3>();
    F.head<3>() -= InZone(X) * p_.zone_damping * V.head<3>();
    return F;
  }

  double Potential(const Pose& X, const Pose&) const noexcept override {
    return 0.5 * p_.stiffness * Displacement(X).squaredNorm() -
           Weight().dot(X * p_.load.center_of_mass);
  }

  VirtualFixturesParameters p_;
  Matrix3 across_ = Matrix3::Zero();  // P
};

}  // namespace

const ControllerKind kVirtualFixtures =
    ControllerKindOf<VirtualFixtures, VirtualFixturesParameters>(
        "virtual_fixtures", "follows the hand along a line or plane, slowly in a zone");

}  // namespace predictor::controllers
