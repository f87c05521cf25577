// Models one hand of the virtual operator as a delayed impedance with mass, noise and a grip.
#pragma once

#include <array>
#include <string>

#include "core/archive.h"
#include "core/filters.h"
#include "core/messages.h"
#include "rig/arm_ability.h"
#include "rig/operator.h"
#include "rig/random_process.h"
#include "scenario/scenario.h"

namespace predictor {

// The present goal of a hand for its handle.
struct HandGoal {
  bool hold = false;
  double grip_time = 0.3;                  // time in which the grip closes [s]
  Pose X_WH;                               // desired pose of the handle
  Twist V_WH = Twist::Zero();              // desired velocity of the handle
  Vector3 object_error = Vector3::Zero();  // object's reference minus its seen position, in W [m]
  Vector3 force = Vector3::Zero();         // feed-forward, in W [N]
};

// The force is F = s · (sat[K e + D de/dt + reflex + visual + feed-forward + noise + tremor] − M
// a), where e is the reference minus the handle's pose. The reflex force is a delayed share of K e
// + D de/dt. The torque about H is computed in the same way. If the arm's ability is modelled,
// noise and tremor are divided by the capacity that is left after fatigue, because a tired muscle
// needs more activation for the same force. The stiffness K_x and the damping D_x = 2 ζ √(M K_x) of
// the arm were measured with reflexes. In a slow motion, a reflex of gain g and delay τ adds the
// force g (K e + D de/dt)
// - g τ K de/dt. Therefore K = K_x / (1 + g) and D = (D_x + g τ K) / (1 + g).
class HandModel {
 public:
  static constexpr double kMaxDelay = 0.5;  // maximum delay of reflex and vision [s]

  // `name` identifies the hand's random streams.
  HandModel(const HandSpec& spec, HandInertia inertia, std::uint64_t seed, const std::string& name);

  // Resets the hand, which is then free. `dt` is the step time [s].
  void Reset(double dt) noexcept;
  // Advances by one step and returns the wrench F_H_W on the handle, whose motion is `handle`.
  Wrench Step(const HandGoal& goal, const FrameMotion& handle) noexcept {
    return Deliver(Intend(goal, handle, nullptr), handle);
  }
  // The following functions are the two parts of Step. The two parts are separate so that a body
  // can limit the muscles' wrench between them. `arm` is null if the stiffness does not depend on a
  // posture.
  Wrench Intend(const HandGoal& goal, const FrameMotion& handle, const ArmAbility* arm) noexcept;
  Wrench Deliver(const Wrench& muscles, const FrameMotion& handle) const noexcept;

  void Archive(StateArchive& a) {
    a(noise_, tremor_, dt_, grip_, grip_start_, grip_phase_, keep_, held_, reflex_);
  }

  double grip() const { return grip_; }  // s in [0, 1]; 0: the hand does not hold the handle

 private:
  void StepGrip(bool hold, double grip_time) noexcept;
  // Returns the force K e + D de/dt, with e and its rate in W.
  Vector3 Impedance(const Vector3& error, const Vector3& rate,
                    const ArmAbility* arm) const noexcept;

  HandSpec spec_;
  HandInertia inertia_;
  Vector3 damping_;  // [N·s/m]
  std::array<OrnsteinUhlenbeck, 6> noise_;
  std::array<NarrowBandNoise, 3> tremor_;

  double dt_ = 0.001;
  double grip_ = 0, grip_start_ = 0, grip_phase_ = 0, keep_ = 0;
  bool held_ = false;
  FractionalDelay<Wrench, 1024> reflex_;
};

}  // namespace predictor
