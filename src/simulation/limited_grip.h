// A grip with limits by which one body holds another one. It holds, slips or is open.
#pragma once

#include <cmath>

#include "core/archive.h"
#include "core/types.h"
#include "simulation/disturbance.h"
#include "simulation/engine.h"

namespace predictor {

// How a grip holds the other body: rigidly, or by a ball joint with this damping.
struct GripJoint {
  bool is_fixed = true;
  double damping = 0;  // [N·m·s/rad]
};

// Holds a point A of the held body H at a place in the frame of its holder B. In each step, the
// wrench λ of H on B, about A, is the one with which both have the same velocity at A after the
// step, if its force and its torque are within the grip's limits. Otherwise, the force or the
// torque is at its limit and opposes the sliding: λ minimises ½ λᵀ G λ + λᵀ V/dt within both
// limits, where G = J M⁻¹ Jᵀ, and V is the relative velocity that would result without λ (maximum
// dissipation, Moreau 1977; Stewart & Trinkle 1996). The grip then holds at the new place.
//
// If the limits rise while H slides, the grip tightens at kForceRate and kTorqueRate until H no
// longer slides. A grip that held immediately would stop H within one step.
//
// A ball joint transmits no torque except that of its damping, so only its mount slips.
//
// The end-effector can hold a free object, and the object can hold a movable object. No other grip
// may act in the same step.
class LimitedGrip {
 public:
  // The rates at which a grip tightens [N/s], [N·m/s]. About 100 N within 0.1 s is a design choice.
  static constexpr double kForceRate = 1000, kTorqueRate = 100;
  // The largest number of velocities of a scene that it can solve.
  static constexpr int kMaxDof = kMaxCobotJoints + 6 + 6 * kMaxMovables;

  // `engine` must outlive this. `velocities` is the number of velocities on which both bodies
  // depend: engine->dof(), or all if the held body is a movable object. At most kMaxDof.
  LimitedGrip(SceneBody holder, GripJoint joint, Engine* engine, Eigen::Index velocities);

  // Holds `held` at its point p_HA [m] from now on, where it is. A grip that is not `tight` begins
  // without force and tightens.
  void Close(SceneBody held, const Vector3& p_HA, bool tight) noexcept;
  void Open() noexcept { is_released_ = true; }
  // Sets the limits that the grip should reach.
  void SetLimits(const GripLimits& limits) noexcept { wanted_ = limits; }

  bool is_released() const noexcept { return is_released_; }  // by Open, until Close
  bool is_lost() const noexcept { return is_lost_; }          // it slid out of reach
  AttachmentState state() const noexcept {
    if (is_open()) return AttachmentState::kOpen;
    return slides_ || turns_ ? AttachmentState::kSlips : AttachmentState::kHolds;
  }
  // Returns X_BA with the rotation of H instead of that of A.
  Pose Place() const noexcept;

  // Adds the grip's forces to the engine's. All other forces must be complete. `object_wrench` is
  // the one that was set by SetObjectWrench. Uses the state of the last Prepare of the engine.
  // Returns false on an error of the engine. Does not use the heap.
  bool Hold(const Wrench& object_wrench) noexcept;
  // Moves the place of the grip by the distance that H has slid. Call it after the step.
  void Follow() noexcept;

  // Returns the wrench of H on B in the last Hold, about B, in axes of W [N, N·m].
  const Wrench& load() const noexcept { return load_; }

  void Archive(StateArchive& a) noexcept {
    a(place_, first_, is_lost_, wrench_, limits_.force, limits_.torque, limits_.reach, slides_,
      turns_, is_released_, p_HA_);
  }
  // Call it after a state was loaded in which the grip holds `held`.
  void SetHeld(SceneBody held) noexcept { held_ = held; }

 private:
  using DofVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDof, 1>;
  using DofMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDof, kMaxDof>;
  using DofJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor, 6, kMaxDof>;

  bool is_open() const noexcept {
    return is_released_ || is_lost_ || (limits_.force <= 0 && limits_.torque <= 0);
  }
  Engine::Values velocities() const noexcept {
    return held_ == SceneBody::kObject ? engine_.velocities() : engine_.all_velocities();
  }
  void Tighten() noexcept;
  void Apply() noexcept;
  void Prepare() noexcept;
  void UpdateMobility() noexcept;
  Wrench Solve() noexcept;
  Wrench WithinLimits(const Vector6& b, Wrench wrench) noexcept;

  Engine& engine_;
  SceneBody holder_, held_ = SceneBody::kObject;
  GripJoint joint_;
  Vector3 p_HA_ = Vector3::Zero();
  GripLimits wanted_, limits_;       // requested, and at present
  Pose place_;                       // X_BA where the grip holds; its rotation is that of H
  Vector3 first_ = Vector3::Zero();  // p_BA where it held first [m]
  bool is_lost_ = false, is_released_ = false;
  bool slides_ = false, turns_ = false;  // in the last Hold
  Wrench load_ = Wrench::Zero();
  Wrench wrench_ = Wrench::Zero();  // λ in the last Hold: on B, about A, in axes of W
  // The following members are workspace.
  Wrench object_wrench_ = Wrench::Zero();
  Vector3 p_WA_ = Vector3::Zero();
  DofVector others_;                // the other forces of the joints
  DofJacobian J_, other_;           // V_WB − V_WH at A, by the velocities
  Vector6 bias_ = Vector6::Zero();  // J̇ v
  DofMatrix M_, holding_;           // without and with contacts and friction
  Eigen::LLT<DofMatrix> factor_, holding_factor_;
  Matrix6 G_;  // mobility at A
};

}  // namespace predictor
