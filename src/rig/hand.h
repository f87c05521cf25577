// One hand of the virtual operator: a delayed impedance with mass, noise and a grip.
#pragma once

#include <array>
#include <string>

#include "core/archive.h"
#include "core/filters.h"
#include "core/messages.h"
#include "rig/operator.h"
#include "rig/random_process.h"
#include "scenario/scenario.h"

namespace predictor {

// What a hand is to do with its handle now.
struct HandGoal {
  bool hold = false;
  double grip_time = 0.3;                  // in which the grip closes [s]
  Pose X_WH;                               // where the handle should be
  Twist V_WH = Twist::Zero();              // how it should move there
  Vector3 object_error = Vector3::Zero();  // object's reference − object as seen, in W [m]
  Vector3 force = Vector3::Zero();         // feed-forward, in W [N]
};

// F = s · (sat[K e + D de/dt + reflex + visual + feed-forward + noise + tremor] − M a), with e the
// reference less the handle; the reflex is a part of K e + D de/dt, late. Torque alike, about H.
class HandModel {
 public:
  static constexpr double kMaxDelay = 0.5;  // of reflex and sight [s]

  // `name` names the hand's random streams.
  HandModel(const HandSpec& spec, HandInertia inertia, std::uint64_t seed, const std::string& name);

  // Free hand, step time dt [s].
  void Reset(double dt) noexcept;
  // One step later: the wrench F_H_W on the handle that moves as told.
  Wrench Step(const HandGoal& goal, const FrameMotion& handle) noexcept;

  void Archive(StateArchive& a) {
    a(noise_, tremor_, dt_, grip_, grip_start_, grip_phase_, keep_, held_, reflex_);
  }

  double grip() const { return grip_; }  // s in [0, 1]; 0: the hand is off the handle

 private:
  void StepGrip(bool hold, double grip_time) noexcept;

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
