// The attachment of an object that is a separate body. The attachment is a grip with limits. It
// holds, slips or is open, and it opens and closes on command.
#pragma once

#include "core/archive.h"
#include "core/types.h"
#include "scenario/scenario.h"
#include "simulation/disturbance.h"
#include "simulation/engine.h"

namespace predictor {

// Holds the object's attachment frame A at a place in the end-effector's frame E. In each step, the
// attachment determines the wrench λ of the object on E, about A. If its force and its torque can
// stay within the grip's limits, λ gives E and the object the same velocity at A after the step.
// Otherwise, the force or the torque is at its limit and opposes the sliding. In this case, λ
// minimises ½ λᵀ G λ + λᵀ V/dt within both limits (maximum dissipation, Moreau 1977; Stewart &
// Trinkle 1996), where G = J M⁻¹ Jᵀ and V is the relative velocity that would result without λ.
// After sliding, the grip holds the object at the new place.
//
// If the limits rise while the object slides, the grip tightens at kForceRate and kTorqueRate until
// the object no longer slides. A grip that held immediately would stop the object within one step.
//
// A spherical attachment transmits no torque except that of its damping, so only its mount slips.
class Attachment {
 public:
  // The rates at which a grip tightens [N/s], [N·m/s]. About 100 N within 0.1 s is a design choice.
  static constexpr double kForceRate = 1000, kTorqueRate = 100;

  // `engine` must have a free object (Holding::kFree) and must outlive this attachment. Throws
  // InputError if the engine's cobot has too many joints.
  Attachment(const AttachmentSpec& spec, Engine* engine);

  // Grips the object at its present place.
  void Grip() noexcept;
  // Sets the limits that the grip should reach.
  void SetLimits(const GripLimits& limits) noexcept { wanted_ = limits; }
  // Opens the grip, or closes it at the object's present place if the object is near enough. A
  // closing grip tightens at kForceRate and kTorqueRate. Uses the state of the last Prepare.
  void Command(const GripperCommands& commands) noexcept;
  AttachmentState state() const noexcept;
  // Whether the last command to grasp found the object too far away.
  bool missed() const noexcept { return missed_; }

  // Adds the attachment's forces to the engine's joint forces. All other forces must be complete.
  // Uses the state of the last Prepare. Returns false on an error of the engine. Does not use the
  // heap.
  bool Hold() noexcept;
  // Moves the place of the grip by the distance that the object has slid. Call this function after
  // the step.
  void Follow() noexcept;

  // Returns the wrench of the object on the end-effector in the last Hold, about E, in axes of W
  // [N, N·m].
  const Wrench& load() const noexcept { return load_; }

  void Archive(StateArchive& a) noexcept {
    a(grip_, first_, lost_, wrench_, limits_.force, limits_.torque, limits_.reach, slides_, turns_);
    a(released_, missed_, tried_);
  }

 private:
  static constexpr int kMaxDof = kMaxCobotJoints + 6;
  using DofVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDof, 1>;
  using DofMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDof, kMaxDof>;
  using DofJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor, 6, kMaxDof>;

  bool is_open() const noexcept {
    return released_ || lost_ || (limits_.force <= 0 && limits_.torque <= 0);
  }
  bool IsNear(const GripperCommands& commands) const noexcept;
  Pose PoseOf(SceneBody body) const noexcept { return engine_.PoseOf(body); }
  Pose Place() const noexcept;
  void Tighten() noexcept;
  void Prepare() noexcept;
  void UpdateMobility() noexcept;
  Wrench Solve() noexcept;
  Wrench WithinLimits(const Vector6& b, Wrench wrench) noexcept;

  Engine& engine_;
  Vector3 p_OA_;
  bool is_fixed_;
  double damping_;              // of a spherical joint [N·m·s/rad]
  GripLimits wanted_, limits_;  // requested, and at present
  Pose grip_;                   // X_EA where the grip holds; its rotation is that of O
  Vector3 first_;               // p_EA where it held first [m]
  Pose start_;                  // as grip_, at the start of the run
  bool lost_ = false;
  bool released_ = false, missed_ = false;  // by command; the last grasp found nothing
  double tried_ = HUGE_VAL;                 // how long ago that grasp was commanded [s]
  bool slides_ = false, turns_ = false;     // in the last Hold
  Wrench load_ = Wrench::Zero();
  Wrench wrench_ = Wrench::Zero();  // λ in the last Hold: on E, about A, in axes of W
  // The following members are temporary storage for one step.
  Vector3 p_WA_ = Vector3::Zero();
  DofJacobian J_, other_;           // V_WE − V_WO at A, by the velocities
  Vector6 bias_ = Vector6::Zero();  // J̇ v
  DofMatrix M_, holding_;           // without and with contacts and friction
  Eigen::LLT<DofMatrix> factor_, holding_factor_;
  Matrix6 G_;  // mobility at A
};

}  // namespace predictor
