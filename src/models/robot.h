// Kinematics and dynamics of one arm, out of its URDF. Pinocchio stays behind this interface.
//
// RobotModel is constant after loading; RobotData is the workspace that is written. Nothing here
// allocates after construction.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/messages.h"
#include "core/types.h"

namespace predictor {

// What to load. Paths are resolved by scenario/paths.h.
struct RobotSource {
  std::string model;                      // URI as in the scenario
  std::filesystem::path folder;           // the scenario's folder
  std::vector<std::string> remove_links;  // cut off with all that hangs on them
  Pose X_WB;                              // base in the world
};

// A frame of a robot: a link's origin, or a point fixed to a link.
struct FrameId {
  int index = -1;
  bool valid() const { return index >= 0; }
};

class RobotModel {
 public:
  // Reads, checks (see models/urdf.h) and builds. Fixed base, revolute/continuous/prismatic joints,
  // at most kMaxJoints. Throws InputError naming file, link or joint, and what to change.
  static std::shared_ptr<const RobotModel> Load(const RobotSource& source);
  ~RobotModel();

  int dof() const;
  const std::string& joint_name(int j) const;
  const JointVector& position_lower() const;    // [rad]; −inf for continuous joints
  const JointVector& position_upper() const;    // [rad]
  const JointVector& velocity_limit() const;    // [rad/s]
  const JointVector& effort_limit() const;      // [N·m]
  double mass() const;                          // of all links [kg]
  std::vector<std::string> link_names() const;

  // Frame of a link's origin. Throws InputError that suggests the nearest link names.
  FrameId Frame(const std::string& link) const;
  // Frame fixed to a link at X_LF. To be called before any RobotData is made of this model.
  static FrameId AddFrame(std::shared_ptr<const RobotModel>* model, const std::string& link,
                          const Pose& X_LF);

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  RobotModel();
  std::unique_ptr<Impl> impl_;
};

class RobotData {
 public:
  explicit RobotData(const RobotModel& model);
  ~RobotData();
  RobotData(RobotData&&) noexcept;
  RobotData& operator=(RobotData&&) noexcept;

  // Placements, velocities, joint Jacobians at (q, v) [rad], [rad/s]. The getters below up to the
  // next Update refer to this state.
  void UpdateKinematics(const RobotModel& model, const JointVector& q, const JointVector& v);
  Pose FramePose(const RobotModel& model, FrameId frame) const;    // X_WF
  Twist FrameTwist(const RobotModel& model, FrameId frame) const;  // V_WF, axes of W
  // Twist's derivative for zero joint acceleration (dJ/dt · v), classical, axes of W.
  Vector6 FrameBiasAcceleration(const RobotModel& model, FrameId frame) const;
  // J with V_WF = J v, axes of W.
  void FrameJacobian(const RobotModel& model, FrameId frame, Jacobian* J) const;

  // Mass matrix M [kg·m²], bias h = C v + g [N·m] and gravity g [N·m] at (q, v), W's gravity
  // −gravity·z. Includes UpdateKinematics.
  void UpdateDynamics(const RobotModel& model, const JointVector& q, const JointVector& v,
                      double gravity);
  const JointMatrix& M() const;
  const JointVector& bias() const;
  const JointVector& gravity() const;

  // Gradient by the joints of the translational manipulability m = sqrt(det(J_v J_vᵀ)) of a frame,
  // by the kinematic Hessian (Haviland & Corke 2021): dm/dq_i = m tr((J_v J_vᵀ)^-1 (H_i J_vᵀ + ...)/2).
  // Writes m. At a singularity (m < 1e-9) the gradient is zero. Refers to UpdateKinematics.
  void ManipulabilityGradient(const RobotModel& model, FrameId frame, double* m,
                              JointVector* gradient) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

// Kinematic Hessian: H[i] = dJ/dq_i (6 × n each), for tests and gradients (J, axes of W).
void KinematicHessian(const Jacobian& J, std::vector<Jacobian>* H);

// Joints q within limits that bring frame F to X_WF (damped least squares from `start`, then from
// `restarts` seeded random starts). Returns whether position error < 1e-6 m and rotation < 1e-6 rad.
bool SolveInverseKinematics(const RobotModel& model, FrameId frame, const Pose& X_WF,
                            const JointVector& start, int restarts, JointVector* q);

}  // namespace predictor
