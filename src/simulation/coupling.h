// Computes the wrench that keeps the virtual object close to the arms that display it.
#pragma once

#include "core/messages.h"
#include "scenario/scenario.h"

namespace predictor {

// The mobility of the free object at one handle. A cobot that holds the object can only reduce the
// mobility. Therefore the mobility of the free object bounds the effect of an explicit damper in
// one step.
struct HandleMobility {
  double translation = 1;  // maximum, for a force [1/kg]
  double rotation = 1;     // maximum, for a torque [1/(kg·m²)]
};

// Returns the mobility of an object with `mass` [kg] and `inertia` about its centre of mass
// [kg·m²]. `lever` is the vector from the centre of mass to the handle [m], in the same axes as the
// inertia.
HandleMobility MobilityAt(double mass, const Matrix3& inertia, const Vector3& lever);

// The wrench on a virtual handle D that results from the device's limits; zero in normal running:
// * If the distance between D and the real handle H exceeds a deadband, a spring force grows from 0
//   there, and a damper on the relative motion grows to its full value at twice the deadband.
// * If D is faster than the handles' speed cap, which the arms cannot follow, a damper acts on the
//   excess speed.
// Translation and rotation are treated in the same way. Each damper is limited so that
// d·dt·mobility ≤ 0.3. Even the two dampers of both handles together (1.2) then leave an explicit
// step of a light object stable (limit: 2).
class Coupling {
 public:
  Coupling() = default;
  // The speed caps are in [m/s] and [rad/s]. `dt` is the integration step, and `mobility` is the
  // mobility at D.
  Coupling(const CouplingSpec& spec, double speed_cap, double rotation_speed_cap,
           const HandleMobility& mobility, double dt);

  // Returns the wrench on D, about D, in axes of W [N, N·m]. Does not use the heap or a lock, or
  // throw.
  Wrench Compute(const FrameMotion& D, const FrameMotion& H) const noexcept;

 private:
  // The parameters of translation, in units with m, or of rotation, in units with rad.
  struct Part {
    double deadband = 0, stiffness = 0, damping = 0;  // [m], [N/m], [N·s/m]
    double speed_cap = 0, speed_damping = 0;          // [m/s], [N·s/m]
    Vector3 Compute(const Vector3& error, const Vector3& v_D, const Vector3& v_H) const noexcept;
  };
  Part translation_, rotation_;
};

}  // namespace predictor
