// What the virtual object feels of the device: it may not run away from the arms that show it.
#pragma once

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// How easily the object, free in space, gives way at one handle. The cobot that holds it can only
// make it give way less, so this bounds what an explicit damper may do in a step.
struct HandleMobility {
  double translation = 1;  // largest, of a force [1/kg]
  double rotation = 1;     // largest, of a torque [1/(kg·m²)]
};

// Of an object of `mass` [kg] and `inertia` about its centre of mass [kg·m²], at `lever` from the
// centre of mass to the handle [m] (both in the same axes).
HandleMobility MobilityAt(double mass, const Matrix3& inertia, const Vector3& lever);

// The wrench on a virtual handle D that the device's shortcomings cause; zero in normal running:
// * D parted from the real handle H by more than a deadband: a spring that grows from 0 there, and
//   a damper on the relative motion that grows to its full value at twice the deadband;
// * D faster than the handles' speed cap, which the arms cannot show: a damper on the excess.
// Translation and rotation alike. Each damper is limited so that d·dt·mobility ≤ 0.3: even the two
// dampers of both handles together (1.2) leave an explicit step of a light object stable (2).
class Coupling {
 public:
  Coupling() = default;
  // Caps in [m/s] and [rad/s]; dt: step of the integration [s]; `mobility` at D.
  Coupling(const CouplingSpec& spec, double speed_cap, double rotation_speed_cap,
           const HandleMobility& mobility, double dt);

  // Wrench on D, about D, axes of W [N, N·m]. No heap, lock or exception.
  Wrench Compute(const FrameMotion& D, const FrameMotion& H) const noexcept;

 private:
  // One of translation and rotation; units with m for the first, rad for the second.
  struct Part {
    double deadband = 0, stiffness = 0, damping = 0;  // [m], [N/m], [N·s/m]
    double speed_cap = 0, speed_damping = 0;          // [m/s], [N·s/m]
    Vector3 Compute(const Vector3& error, const Vector3& v_D, const Vector3& v_H) const noexcept;
  };
  Part translation_, rotation_;
};

}  // namespace predictor
