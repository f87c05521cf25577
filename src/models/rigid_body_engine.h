// Computes kinematics and dynamics of a tree of joints. All quantities are in W, because in W the
// results are plain sums along the tree (Featherstone 2008, "Rigid body dynamics algorithms").
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/types.h"
#include "models/urdf.h"

namespace predictor {

// The inertia of a body about the origin of a frame, in its axes. Inertias about the same origin
// can be added.
struct BodyInertia {
  double mass = 0;                    // [kg]
  Vector3 moment = Vector3::Zero();   // mass times centre of mass [kg·m]
  Matrix3 inertia = Matrix3::Zero();  // [kg·m²]

  BodyInertia& operator+=(const BodyInertia& other) noexcept {
    mass += other.mass;
    moment += other.moment;
    inertia += other.inertia;
    return *this;
  }
};

// Converts from the inertia of a body about its centre of mass, in the same axes.
BodyInertia InertiaAboutOrigin(double mass, const Vector3& com, const Matrix3& inertia);

// A movable joint J with the body that it carries. Joints are counted from 1, and 0 is the base.
struct EngineJoint {
  std::size_t parent = 0;  // joint that carries it, before it in the list
  Matrix3 R_PJ = Matrix3::Identity();
  Vector3 p_PJ = Vector3::Zero();   // at position 0 [m]; in W if the base carries it
  Vector3 axis = Vector3::UnitX();  // unit, in J
  int own_axis = 0;                 // 0, 1, 2: `axis` is x, y or z of J; −1: none of them
  bool prismatic = false;
  BodyInertia body;  // in J
};

struct EngineModel {
  std::vector<EngineJoint> joints;
};

// The results of the computation, and memory for intermediate results.
struct EngineState {
  JointVector v;  // [rad/s]
  std::array<Matrix3, kMaxJoints + 1> R_WJ;
  std::array<Vector3, kMaxJoints + 1> p_WJ;  // [m]
  Jacobian J_W;         // column k: twist of W's origin caused by joint k alone, axes of W
  JointMatrix M;        // [kg·m²]
  JointVector gravity;  // [N·m]
  std::array<BodyInertia, kMaxJoints + 1> inertia;    // inertia of each body, in W
  std::array<BodyInertia, kMaxJoints + 1> composite;  // what each joint carries, in W
  JointVector bias;                                   // [N·m]; see Bias
  const EngineModel* waits_for_bias = nullptr;        // model to compute `bias` with; null: done
};

// Builds the model. `body` and `X_JL` state, for each link, the joint that carries the link and the
// link's pose in the frame of this joint.
EngineModel MakeEngineModel(const UrdfModel& urdf, const Pose& X_WB, std::vector<int>* body,
                            std::vector<Pose>* X_JL);

// Returns the state of `model`, with the base in place and all other results zero.
EngineState MakeEngineState(const EngineModel& model);

// Computes R_WJ, p_WJ and J_W at q without allocation.
void ComputeKinematics(const EngineModel& model, const JointVector& q, EngineState* state) noexcept;
// Computes the results of ComputeKinematics, and also M and the gravity torques at q, without
// allocation. `gravity` [m/s²] acts along −z of W. The model must outlive the next call of Bias.
void ComputeDynamics(const EngineModel& model, const JointVector& q, const JointVector& v,
                     double gravity, EngineState* state) noexcept;
// Returns the bias torques at (q, v) of the last ComputeDynamics [N·m]. The bias torques are
// computed only when a caller requests them, because most controllers do not need them. Does not
// allocate.
const JointVector& Bias(EngineState* state) noexcept;

// A twist [m/s, rad/s] or a wrench [N, N·m] at W's origin. The linear and the angular half are
// stored separately, because this is faster than composing a Vector6 before each operation.
struct Spatial {
  Vector3 linear, angular;

  static Spatial Zero() noexcept { return {Vector3::Zero(), Vector3::Zero()}; }
  explicit operator Vector6() const noexcept { return (Vector6() << linear, angular).finished(); }
  Spatial operator+(const Spatial& other) const noexcept {
    return {linear + other.linear, angular + other.angular};
  }
  Spatial operator*(double x) const noexcept { return {linear * x, angular * x}; }
  // Returns the power of a twist and a wrench.
  double dot(const Spatial& other) const noexcept {
    return linear.dot(other.linear) + angular.dot(other.angular);
  }
};

// Returns V × S, the rate of change of the twist S of an axis that moves with the twist V.
inline Spatial CrossMotion(const Spatial& V, const Spatial& S) noexcept {
  return {V.angular.cross(S.linear) + V.linear.cross(S.angular), V.angular.cross(S.angular)};
}

// Returns the twist of W's origin caused by joint k, counted from 0, at a velocity of 1.
inline Spatial Axis(const EngineState& state, Eigen::Index k) noexcept {
  return {state.J_W.col(k).head<3>(), state.J_W.col(k).tail<3>()};
}

}  // namespace predictor
