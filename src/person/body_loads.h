// Computes the loads of the body in one posture and motion: joint torques, lower back and balance.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "person/body_sample.h"
#include "person/legs.h"

namespace predictor::person {

// A posture and its derivatives [rad, rad/s, rad/s²]. The position of the pelvis and its
// derivatives are in [m, m/s, m/s²].
struct BodyMotion {
  BodyVector q = BodyVector::Zero(), v = BodyVector::Zero(), a = BodyVector::Zero();
};

// The loads of the disc between the fifth lumbar vertebra and the sacrum. The disc carries the
// weight of the whole body above it.
struct DiscLoads {
  double flexion_moment = 0;  // moment that the back muscles must produce, positive: extensors
                              // [N·m]
  double lateral_moment = 0;  // positive: the muscles bend to the left [N·m]
  double twist_moment = 0;    // moment about the pelvis's long axis, positive to the left [N·m]
  double compression = 0;     // [N]
  double shear = 0;           // shear force of the upper body on the disc, positive forward [N]
};

struct Balance {
  double ground_force = 0;  // vertical [N]
  double x = 0, y = 0;      // centre of pressure in S [m]
  double margin = 0;        // distance from the edge of the footprint [m]; negative: the person
                            // falls
};

struct BodyLoads {
  BodyVector torque;    // torque that the muscles produce [N·m], see JointLoads
  BodyVector overload;  // part due to the hands' wrenches: torque with them minus torque without
                        // them [N·m]
  // Magnitude of the moment that the torso exerts on each upper arm at the shoulder [N·m].
  std::array<double, kHands> shoulder_moment = {};
  DiscLoads l5s1;
  Balance balance;
};

// The extensor muscles are modelled as a single equivalent muscle (Chaffin & Andersson; marks R).
// The disc is perpendicular to a direction that is fixed to the pelvis and leans forward by
// kSacralAngle from the pelvis's long axis. The compression is the force along this direction +
// √(flexion² + lateral moment²) / muscle_arm. The shear is the forward force perpendicular to this
// direction. The muscle pulls in the direction of the compression. Abdominal pressure and
// co-contraction are neglected, so the loads of upright standing are underestimated. Literature for
// comparison gives a limit of 3.4 kN for the compression (NIOSH, R), and of 0.7 to 1 kN for the
// shear (Gallagher & Marras 2012, R).
inline constexpr double kSacralAngle = 0.698;   // 40° [rad]
inline constexpr double kBackMuscleArm = 0.06;  // 0.05 to 0.07 [m]

class BodyDynamics {
 public:
  BodyDynamics(const BodyModel& model, const Stance& stance, double muscle_arm = kBackMuscleArm)
      : model_(model), stance_(stance), muscle_arm_(muscle_arm) {}

  // Computes the loads with the wrenches of `sample`.
  BodyLoads Evaluate(const BodyMotion& motion, const BodySample& sample) const;

 private:
  DiscLoads DiscOf(const Placement& at, const JointLoads& loads) const;
  Balance BalanceOf(const BodyMotion& motion, const Placement& at, const JointLoads& loads) const;

  BodyModel model_;
  Stance stance_;
  double muscle_arm_;
};

// Calls f(name, value&) for each value of the lower back and the balance.
template <class Loads, class F>
void ForEachBodyValue(Loads& loads, F f) {
  f("l5s1_flexion_moment", loads.l5s1.flexion_moment);
  f("l5s1_lateral_moment", loads.l5s1.lateral_moment);
  f("l5s1_twist_moment", loads.l5s1.twist_moment);
  f("l5s1_compression", loads.l5s1.compression);
  f("l5s1_shear", loads.l5s1.shear);
  f("ground_force", loads.balance.ground_force);
  f("pressure_x", loads.balance.x);
  f("pressure_y", loads.balance.y);
  f("balance_margin", loads.balance.margin);
}

// Smooths postures at the constant interval dt [s] without phase shift and computes their
// derivatives. The function runs a second-order Butterworth filter forward and backward, and then
// takes central differences. The overall cutoff is kMotionCutoff, and the cutoff of each pass is
// 1/0.802 of it (Winter 2009). The filter causes no delay, but the results of the last half second
// change if samples are added afterwards. The cutoff is at most half of the Nyquist frequency. If
// there are fewer than three postures, the derivatives are zero.
inline constexpr double kMotionCutoff = 6;  // [Hz]
std::vector<BodyMotion> SmoothMotion(std::span<const BodyVector> q, double dt);

}  // namespace predictor::person
