// Vectors, poses, twists and wrenches that all modules share.
//
// The names of quantities use monogram notation. X_AB is the pose of frame B in frame A. V_WB is
// the twist of B in W (linear, then angular). F_B_W is the wrench that acts at B's origin, in the
// axes of W (force, then torque). The frames are: W world, R rig (frame of the arms' bases), H real
// handle, D virtual handle, E end-effector, B base, O object, S sensor.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace predictor {

inline constexpr int kHands = 2;                  // left and right
inline constexpr double kStandardGravity = 9.81;  // gravity at a real rig [m/s²]
inline constexpr int kMaxEvents = 16;             // entries of a scenario's `events`
inline constexpr int kMaxArmJoints = 10;          // of one arm of the device
inline constexpr int kMaxCobotJoints = 16;        // of the virtual cobot
inline constexpr int kMaxJoints = 16;             // of any robot
inline constexpr int kMaxMovables = 8;            // entries of a scenario's `environment.objects`

enum class Hand : int { kLeft = 0, kRight = 1 };
inline constexpr std::array<const char*, kHands> kHandNames = {"left", "right"};
constexpr const char* HandName(int hand) { return kHandNames[static_cast<std::size_t>(hand)]; }

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Quaternion = Eigen::Quaterniond;
using Twist = Vector6;   // linear [m/s], angular [rad/s]
using Wrench = Vector6;  // force [N], torque [N·m]

// One number per joint. The storage is inside the object, so resizing never allocates.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxJoints>;

// Pose X_AB of a frame B in a frame A.
struct Pose {
  Vector3 p = Vector3::Zero();            // p_AB [m]
  Quaternion q = Quaternion::Identity();  // R_AB, unit

  static Pose Identity() { return {}; }
  Matrix3 R() const { return q.toRotationMatrix(); }
  Pose Inverse() const { return {-(q.conjugate() * p), q.conjugate()}; }
  // Poses are multiplied as X_AC = X_AB * X_BC.
  Pose operator*(const Pose& X_BC) const { return {p + q * X_BC.p, (q * X_BC.q).normalized()}; }
  // p_A = X_AB * p_B.
  Vector3 operator*(const Vector3& p_B) const { return p + q * p_B; }
};

// Converts a position [m] and roll, pitch and yaw [rad] about the fixed axes x, y and z (as in
// URDF) to a pose.
Pose PoseFromXyzRpy(const Vector3& xyz, const Vector3& rpy);

// Returns roll, pitch and yaw [rad] of a rotation, in the convention of PoseFromXyzRpy. Roll is 0
// if the pitch is ±90°.
Vector3 RpyOf(const Quaternion& q);

// Returns the rotation vector [rad] in A that rotates `from` to `to` on the shortest path.
Vector3 RotationError(const Quaternion& to, const Quaternion& from);

// Returns the quaternion of a rotation vector [rad].
Quaternion RotationFromVector(const Vector3& w);

// Returns the difference between set-point and pose in W, as in impedance control: position [m],
// then rotation vector [rad].
Vector6 PoseError(const Pose& X_Wset, const Pose& X_W);

// Returns the matrix S(a) for which S(a) b = a × b.
Matrix3 Skew(const Vector3& a);

// Computes the twist of frame C, which is fixed to frame B, from the twist of B. r_BC_W is the
// lever arm from B to C in W [m].
Twist ShiftTwist(const Twist& V_WB, const Vector3& r_BC_W);

// Computes the wrench about B's origin from the wrench about C's origin. The lever arm in W is
// r_BC_W = p_C − p_B [m].
Wrench ShiftWrench(const Wrench& F_C_W, const Vector3& r_BC_W);

bool IsFinite(const Pose& X);

}  // namespace predictor
