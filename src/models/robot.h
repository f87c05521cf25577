// Kinematics and dynamics of one arm, out of its URDF. Pinocchio stays behind this interface.
//
// RobotModel is constant after loading; RobotData is the workspace that is written. Nothing here
// allocates after construction, but for Load, Build, Frame, link_names and KinematicHessian.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/messages.h"
#include "core/types.h"
#include "models/urdf.h"

namespace predictor {

// What to load. Paths are resolved by scenario/paths.h.
struct RobotSource {
  std::string model;                      // URI as in the scenario
  std::filesystem::path folder;           // the scenario's folder
  std::vector<std::string> remove_links;  // cut off with all that hangs on them
  Pose X_WB;                              // base in the world
  std::string key = {};  // the scenario's group that asks for it ("cobot"), for errors; or none
};

// A frame that moves with a robot: a link's origin, or a point fixed to a link. Plain value, made
// by RobotModel::Frame; as many as wanted, at any time.
struct FrameId {
  int body = -1;  // the movable joint that carries it, counted from 1; 0: the base
  Pose X_JF;      // in the frame of that joint; for the base: in W
  bool valid() const { return body >= 0; }
};

class RobotModel {
 public:
  // Reads, checks (see models/urdf.h) and builds. Fixed base, revolute/continuous/prismatic joints,
  // 1 to kMaxJoints of them, ordered depth-first in the file's order. A mimic joint is a joint of
  // its own (models/urdf.h says why). Throws InputError naming file, link or joint, and what to
  // change.
  static std::shared_ptr<const RobotModel> Load(const RobotSource& source);
  // The same out of a URDF that was read already.
  static std::shared_ptr<const RobotModel> Build(const UrdfModel& urdf, const Pose& X_WB);
  ~RobotModel();

  int dof() const;
  const std::string& joint_name(int j) const;
  const JointVector& position_lower() const;  // [rad] or [m]; −inf for continuous joints
  const JointVector& position_upper() const;  // [rad] or [m]; +inf for continuous joints
  const JointVector& velocity_limit() const;  // [rad/s] or [m/s]; +inf if the URDF sets none
  const JointVector& effort_limit() const;    // [N·m] or [N]; +inf if the URDF sets none
  double mass() const;                        // of all links, the base too [kg]
  std::vector<std::string> link_names() const;

  // Frame fixed to a link at X_LF. Throws InputError that suggests the nearest link names.
  FrameId Frame(const std::string& link, const Pose& X_LF = {}) const;

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

  // Placements and joint Jacobians at (q, v) [rad], [rad/s]. The getters below up to the next
  // Update refer to this state.
  void UpdateKinematics(const RobotModel& model, const JointVector& q, const JointVector& v);
  Pose FramePose(const RobotModel& model, const FrameId& frame) const;    // X_WF
  Twist FrameTwist(const RobotModel& model, const FrameId& frame) const;  // V_WF, axes of W
  // Twist's derivative for zero joint acceleration (dJ/dt · v), classical, axes of W.
  Vector6 FrameBiasAcceleration(const RobotModel& model, const FrameId& frame) const;
  // J with V_WF = J v, axes of W; 6 × dof.
  void FrameJacobian(const RobotModel& model, const FrameId& frame, Jacobian* J) const;

  // Mass matrix M [kg·m²], bias h = C v + g [N·m] and gravity g [N·m] at (q, v), W's gravity
  // −gravity·z [m/s²]. Includes UpdateKinematics.
  void UpdateDynamics(const RobotModel& model, const JointVector& q, const JointVector& v,
                      double gravity);
  const JointMatrix& M() const;
  const JointVector& bias() const;
  const JointVector& gravity() const;

  // Gradient by the joints of the translational manipulability m = sqrt(det(J_v J_vᵀ)) of a frame,
  // by the kinematic Hessian (Haviland & Corke 2021): dm/dq_i = m tr((J_v J_vᵀ)^-1 H_i J_vᵀ).
  // Writes m. At a singularity (m < 1e-9) the gradient is zero. Refers to the last Update.
  void ManipulabilityGradient(const RobotModel& model, const FrameId& frame, double* m,
                              JointVector* gradient) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

// Kinematic Hessian: H[i] = dJ/dq_i (6 × n each), out of a frame's Jacobian with axes of W.
void KinematicHessian(const Jacobian& J, std::vector<Jacobian>* H);

// Joints q within limits that bring frame F to X_WF (damped least squares from `start`, then from
// `restarts` random starts, the same ones each time). Returns whether position error < 1e-6 m and
// rotation error < 1e-6 rad; if not, q is the best that was found.
bool SolveInverseKinematics(const RobotModel& model, const FrameId& frame, const Pose& X_WF,
                            const JointVector& start, int restarts, JointVector* q);

}  // namespace predictor
