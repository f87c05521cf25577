// Computes the kinematics and dynamics of one arm from its URDF.
//
// RobotModel is constant after loading, and RobotData is the writable workspace. After
// construction, only Load, Build, Frame, link_names and KinematicHessian allocate memory.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/messages.h"
#include "core/types.h"
#include "models/urdf.h"

namespace predictor {

// The robot to load. Paths are resolved by scenario/paths.h.
struct RobotSource {
  std::string model;                      // URI as in the scenario
  std::filesystem::path folder;           // the scenario's folder
  std::vector<std::string> remove_links;  // removed together with all their descendants
  Pose X_WB;                              // pose of the base in the world
  std::string key = {};  // the scenario's group that refers to the robot ("cobot"), for errors; may
                         // be empty
};

// A frame that moves with a robot: a link's origin or a point fixed to a link. A FrameId is a plain
// value that RobotModel::Frame makes. FrameIds may be made at any time, in any number.
struct FrameId {
  int body = -1;  // the movable joint that carries it, counted from 1; 0: the base
  Pose X_JF;      // pose in the frame of that joint; in W if fixed to the base
  bool valid() const { return body >= 0; }
};

class RobotModel {
 public:
  // Reads and checks a URDF (see models/urdf.h) and builds the model. The base is fixed. The model
  // has 1 to kMaxJoints revolute, continuous or prismatic joints. The joints are ordered
  // depth-first and, for each link, in the file's order. A mimic joint is treated as an independent
  // joint (see models/urdf.h). Throws InputError that names file, link or joint and the remedy.
  static std::shared_ptr<const RobotModel> Load(const RobotSource& source);
  // Builds the model from a URDF that has already been read.
  static std::shared_ptr<const RobotModel> Build(const UrdfModel& urdf, const Pose& X_WB);
  ~RobotModel();

  int dof() const;
  const std::string& joint_name(int j) const;
  bool is_prismatic(int j) const;
  const char* position_unit(int j) const { return is_prismatic(j) ? "m" : "rad"; }
  const char* effort_unit(int j) const { return is_prismatic(j) ? "N" : "N·m"; }
  const JointVector& position_lower() const;  // [rad] or [m]; −inf for continuous joints
  const JointVector& position_upper() const;  // [rad] or [m]; +inf for continuous joints
  const JointVector& velocity_limit() const;  // [rad/s] or [m/s]; +inf if the URDF sets none
  const JointVector& effort_limit() const;    // [N·m] or [N]; +inf if the URDF sets none
  double mass() const;                        // mass of all links, including the base [kg]
  std::vector<std::string> link_names() const;

  // Returns a frame fixed to a link at X_LF. Throws InputError that suggests similar link names.
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

  // Computes placements and joint Jacobians at (q, v) [rad], [rad/s]. The getters below refer to
  // this state until the next Update.
  void UpdateKinematics(const RobotModel& model, const JointVector& q, const JointVector& v);
  Pose FramePose(const RobotModel& model, const FrameId& frame) const;    // X_WF
  Twist FrameTwist(const RobotModel& model, const FrameId& frame) const;  // V_WF, axes of W
  // Returns pose, twist, and acceleration J a + dJ/dt v for joint accelerations a [rad/s²], [m/s²].
  FrameMotion MotionOf(const RobotModel& model, const FrameId& frame, const JointVector& a) const;
  // Writes the Jacobian J (6 × dof) with V_WF = J v, in the axes of W.
  void FrameJacobian(const RobotModel& model, const FrameId& frame, Jacobian* J) const;

  // Computes the mass matrix M [kg·m²], bias h = C v + g [N·m] and gravity torques g [N·m] at (q,
  // v). `gravity` [m/s²] acts along −z of W. Includes UpdateKinematics.
  void UpdateDynamics(const RobotModel& model, const JointVector& q, const JointVector& v,
                      double gravity);
  const JointMatrix& M() const;
  const JointVector& bias() const;
  const JointVector& gravity() const;

  // Computes the gradient of a frame's translational manipulability m = sqrt(det(J_v J_vᵀ)) with
  // respect to the joints. The gradient follows from the kinematic Hessian (Haviland & Corke 2021):
  // dm/dq_i = m tr((J_v J_vᵀ)^-1 H_i J_vᵀ). Also writes m. At a singularity (m < 1e-9), the
  // gradient is zero. The function uses the state of the last Update.
  void ManipulabilityGradient(const RobotModel& model, const FrameId& frame, double* m,
                              JointVector* gradient) const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

// Computes the kinematic Hessian H[i] = dJ/dq_i (6 × n each) from a frame's Jacobian in the axes of
// W.
void KinematicHessian(const Jacobian& J, std::vector<Jacobian>* H);

// Finds joint positions q within the limits that bring frame F to X_WF. The search uses damped
// least squares, first from `start` and then from `restarts` random starts, which are the same in
// each call. Returns whether the position error is below 1e-6 m and the rotation error below 1e-6
// rad. If an error is larger, q is the best solution that was found.
bool SolveInverseKinematics(const RobotModel& model, const FrameId& frame, const Pose& X_WF,
                            const JointVector& start, int restarts, JointVector* q);

}  // namespace predictor
