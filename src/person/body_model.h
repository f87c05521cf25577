// Models the body as a tree of rigid segments, with its joints, kinematics and inverse dynamics.
//
// The body is described in S, the frame on the ground between the feet: x is the direction that the
// person faces, y points left, and z points up. S does not move. In the zero posture, the person
// stands upright with hanging arms and the thumbs forward, and the axes of all segments are those
// of S.
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/types.h"
#include "person/anthropometry.h"

namespace predictor::person {

// The joints, in the order of the chains. The first six joints move the pelvis in S. A joint moves
// all joints after it in its chain. Arms and neck begin at the torso.
enum Joint : int {
  kPelvisX,       // forward [m]
  kPelvisY,       // left [m]
  kPelvisZ,       // up; 0 with straight legs [m]
  kPelvisYaw,     // positive to the left [rad], like all joints below
  kPelvisTilt,    // positive forward
  kPelvisList,    // positive to the right
  kTorsoFlexion,  // at L5/S1, positive forward
  kTorsoLateral,  // positive to the right
  kTorsoTwist,    // positive to the left
  kNeckFlexion,   // at C7, positive forward
  kNeckLateral,   // positive to the right
  kNeckTwist,     // positive to the left
  kLeftArm,       // the first of the left arm's joints
};
inline constexpr int kArmJoints = 7;
inline constexpr int kRightArm = kLeftArm + kArmJoints;
inline constexpr int kBodyJoints = kRightArm + kArmJoints;

// The joints of an arm. Of() returns the index of one of these joints in the body. The shoulder is
// a sequence of flexion, abduction and rotation. This sequence is singular at an abduction of 90°,
// but not for a hanging upper arm.
enum class ArmJoint : int {
  kShoulderFlexion,    // positive forward
  kShoulderAbduction,  // positive away from the body
  kShoulderRotation,   // about the upper arm, positive inward
  kElbowFlexion,       // 0 straight
  kPronation,          // 0 with the thumb forward (up, if the elbow is bent), positive palm down
  kWristFlexion,       // positive towards the palm
  kWristDeviation,     // positive to the ulnar side (that of the little finger)
};
constexpr int Of(int hand, ArmJoint joint) {
  return (hand == 0 ? static_cast<int>(kLeftArm) : kRightArm) + static_cast<int>(joint);
}

// Returns "pelvis_x", ..., "left_shoulder_flexion", ...
const char* JointName(int joint);
// The pelvis's position is in [m], and all other joints are angles [rad].
constexpr bool IsPrismatic(int joint) { return joint <= kPelvisZ; }

using BodyVector = Eigen::Matrix<double, kBodyJoints, 1>;
using BodyJacobian = Eigen::Matrix<double, 6, kBodyJoints>;

// A joint and the segment that it moves. If several joints are at the same place, only the last of
// these joints carries mass.
struct BodyJoint {
  int parent = -1;                   // parent joint; -1: S
  Vector3 offset = Vector3::Zero();  // position of this joint in the parent's frame [m]
  Vector3 axis = Vector3::Zero();
  double lower = 0, upper = 0;        // [rad] or [m]
  double mass = 0;                    // [kg]
  Vector3 com = Vector3::Zero();      // in this joint's frame [m]
  Vector3 inertia = Vector3::Zero();  // about the axes x, y, z through the centre of mass [kg·m²]
};

// Returns the grip frame G in the axes of the hand: x along the bar towards the thumb, z from the
// knuckles to the wrist. The origin of G is the centre of the bar. In a power grip, the centre of
// the bar is at 0.9 of the hand's length from the wrist, and 0.025 m from the hand on the palm's
// side. In a hook grip, these values are 1.2 of the hand's length and 0.02 m (D).
Pose GripInHand(const Anthropometry& a, int hand, GripKind kind);

class BodyModel {
 public:
  explicit BodyModel(const Anthropometry& anthropometry);
  explicit BodyModel(const BodySpec& spec) : BodyModel(AnthropometryOf(spec)) {}

  const Anthropometry& anthropometry() const { return anthropometry_; }
  const BodyJoint& joint(int i) const { return joints_[static_cast<std::size_t>(i)]; }
  BodyVector lower() const;
  BodyVector upper() const;

 private:
  void AddTrunk();
  void AddArm(int hand);
  void Set(int joint, int parent, const Vector3& offset, const Vector3& axis, double lower,
           double upper);
  void Carry(int joint, const Segment& segment, const Vector3& com);

  Anthropometry anthropometry_;
  std::array<BodyJoint, kBodyJoints> joints_;
};

// The frames of all joints in S at one posture.
struct Placement {
  std::array<Matrix3, kBodyJoints> R;     // R_SJ
  std::array<Vector3, kBodyJoints> p;     // p_SJ [m]
  std::array<Vector3, kBodyJoints> axis;  // in S

  Pose FrameOf(int joint) const;
};
Placement Place(const BodyModel& model, const BodyVector& q);

// Returns J with V_S = J v. V_S is the twist, in the axes of S, of the frame at p [m, in S] that
// moves with `joint`.
BodyJacobian JacobianAt(const BodyModel& model, const Placement& at, int joint, const Vector3& p);

// An external wrench on the body, about the point p, in S.
struct ExternalWrench {
  int joint = 0;  // joint that moves with the segment on which the wrench acts
  Vector3 p = Vector3::Zero();
  Wrench F = Wrench::Zero();
};

struct JointLoads {
  // The generalised forces that the muscles must produce at the joints [N·m]. The forces of the
  // pelvis's translations are in [N]. Each force is positive in the direction of its joint. The
  // first six forces are those that the legs exert on the pelvis.
  BodyVector torque;
  // The force [N] and moment [N·m] that the inner segment exerts on the outer segment at the origin
  // of each joint, in the axes of S.
  std::array<Vector3, kBodyJoints> force, moment;
};

// Computes inverse dynamics, τ = M a + h - Σ Jᵀ F, by the recursive Newton-Euler algorithm (Luh,
// Walker & Paul 1980), in the axes of S. `gravity` [m/s²] acts along -z.
JointLoads InverseDynamics(const BodyModel& model, const BodyVector& q, const BodyVector& v,
                           const BodyVector& a, std::span<const ExternalWrench> wrenches,
                           double gravity = kStandardGravity);

// A part of the body that moves as one rigid body. The joints first ... last are at one place, and
// the last of these joints carries the part's mass.
struct BodyPart {
  const char* name;  // "pelvis", "left_hand"
  int first, last;
};
std::span<const BodyPart> BodyParts();

// Returns the body as an OpenSim model (4.x) with the same joints, names, limits and masses,
// without legs and muscles. The forces and torques at the pelvis in this model are those that the
// legs exert on it. As is usual in OpenSim, x points forward, y up and z to the right.
std::string OpenSimModelOf(const BodyModel& model);
// Converts a vector of S to OpenSim's axes.
inline Vector3 InOpenSim(const Vector3& v) { return {v.x(), v.z(), -v.y()}; }

}  // namespace predictor::person
