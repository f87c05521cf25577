#include "models/rigid_body_engine.h"

#include <Eigen/Geometry>

#include "core/sincos.h"

namespace predictor {
namespace {

// Expresses the inertia of a body in another frame, in which its present frame is at (R, p). By
// Steiner's rule with the first moment h, the inertia is R I Rᵀ − [p][h] − [h][p] − m [p][p], where
// −[a][b] = (a·b) 1 − b aᵀ.
void Transform(const BodyInertia& body, const Matrix3& R, const Vector3& p, BodyInertia* out) {
  const Vector3 h = R * body.moment;
  out->mass = body.mass;
  out->moment = h + body.mass * p;
  out->inertia.noalias() = R * body.inertia * R.transpose();
  out->inertia -= h * p.transpose() + p * out->moment.transpose();
  out->inertia.diagonal().array() += p.dot(h + out->moment);
}

// Returns the momentum of a body with twist V, or the wrench that accelerates it from rest.
inline Spatial Times(const BodyInertia& body, const Spatial& V) {
  return {body.mass * V.linear + V.angular.cross(body.moment),
          body.inertia * V.angular + body.moment.cross(V.linear)};
}

// Returns the rate of change of a momentum that is constant in a body with twist V.
inline Spatial CrossForce(const Spatial& V, const Spatial& momentum) {
  return {V.angular.cross(momentum.linear),
          V.angular.cross(momentum.angular) + V.linear.cross(momentum.linear)};
}

EngineJoint MakeJoint(const UrdfJoint& joint, std::size_t parent, const Pose& X_PJ) {
  EngineJoint made;
  made.parent = parent;
  made.R_PJ = X_PJ.R();
  made.p_PJ = X_PJ.p;
  made.axis = joint.axis;
  made.own_axis = -1;
  for (int k = 0; k < 3; ++k)
    if (joint.axis == Vector3::Unit(k)) made.own_axis = k;
  made.prismatic = joint.type == UrdfJointType::kPrismatic;
  return made;
}

// Turns R about the joint's axis by the angle that has the given sine and cosine.
void Turn(const EngineJoint& joint, double sine, double cosine, Matrix3* R) {
  if (joint.own_axis < 0) {  // Rodrigues' formula
    const Matrix3 K = Skew(joint.axis);
    *R *= Matrix3::Identity() + sine * K + (1 - cosine) * K * K;
    return;
  }
  const int next = (joint.own_axis + 1) % 3, last = (joint.own_axis + 2) % 3;
  R->col(next) = (cosine * R->col(next) + sine * R->col(last)).eval();
  R->col(last) = R->col(joint.own_axis).cross(R->col(next));
}

// Computes the torques C v of Coriolis and centrifugal forces by recursive Newton–Euler without
// joint acceleration and gravity (table 5.1).
void ComputeCoriolis(const EngineModel& model, EngineState* state) {
  const JointVector& v = state->v;
  std::array<Spatial, kMaxJoints + 1> V, A, F;
  V[0] = A[0] = F[0] = Spatial::Zero();
  const std::size_t joints = model.joints.size();
  for (std::size_t j = 1; j <= joints; ++j) {
    const std::size_t parent = model.joints[j - 1].parent;
    const auto k = static_cast<Eigen::Index>(j) - 1;
    const Spatial of_joint = Axis(*state, k) * v[k];
    V[j] = V[parent] + of_joint;
    A[j] = A[parent] + CrossMotion(V[parent], of_joint);
    const BodyInertia& body = state->inertia[j];
    F[j] = Times(body, A[j]) + CrossForce(V[j], Times(body, V[j]));
  }
  for (std::size_t j = joints; j > 0; --j) {
    const auto k = static_cast<Eigen::Index>(j) - 1;
    state->bias[k] = Axis(*state, k).dot(F[j]);
    Spatial& on_parent = F[model.joints[j - 1].parent];
    on_parent = on_parent + F[j];
  }
}

// Computes the mass matrix with the algorithm of composite rigid bodies (table 6.2). The
// acceleration of a joint moves all bodies that the joint carries, and these bodies load all joints
// that carry them. The torques of gravity follow from the weight that each joint carries.
void ComputeComposite(const EngineModel& model, double gravity, EngineState* state) {
  state->composite = state->inertia;
  for (std::size_t j = model.joints.size(); j > 0; --j) {
    const BodyInertia& carried = state->composite[j];
    const auto k = static_cast<Eigen::Index>(j) - 1;
    const Spatial S = Axis(*state, k);
    const Spatial weight = {{0, 0, carried.mass}, carried.moment.cross(Vector3::UnitZ())};
    state->gravity[k] = gravity * S.dot(weight);
    const Spatial F = Times(carried, S);
    for (std::size_t i = j; i > 0; i = model.joints[i - 1].parent) {
      const auto r = static_cast<Eigen::Index>(i) - 1;
      state->M(r, k) = state->M(k, r) = Axis(*state, r).dot(F);
    }
    state->composite[model.joints[j - 1].parent] += carried;
  }
}

}  // namespace

BodyInertia InertiaAboutOrigin(double mass, const Vector3& com, const Matrix3& inertia) {
  return {mass, mass * com, inertia - mass * Skew(com) * Skew(com)};
}

EngineModel MakeEngineModel(const UrdfModel& urdf, const Pose& X_WB, std::vector<int>* body,
                            std::vector<Pose>* X_JL) {
  EngineModel model;
  body->assign(urdf.links.size(), 0);
  X_JL->assign(urdf.links.size(), X_WB);
  for (const UrdfJoint& joint : urdf.joints) {
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    const Pose X = (*X_JL)[parent] * joint.X_PJ;
    if (joint.type == UrdfJointType::kFixed) {
      (*body)[child] = (*body)[parent];
      (*X_JL)[child] = X;
    } else {
      model.joints.push_back(MakeJoint(joint, static_cast<std::size_t>((*body)[parent]), X));
      (*body)[child] = static_cast<int>(model.joints.size());
      (*X_JL)[child] = Pose::Identity();
    }
  }
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    if ((*body)[i] == 0) continue;
    const UrdfLink& link = urdf.links[i];
    EngineJoint& carrier = model.joints[static_cast<std::size_t>((*body)[i]) - 1];
    const BodyInertia inertia = InertiaAboutOrigin(link.mass, link.com, link.inertia);
    BodyInertia carried;
    Transform(inertia, (*X_JL)[i].R(), (*X_JL)[i].p, &carried);
    carrier.body += carried;
  }
  return model;
}

EngineState MakeEngineState(const EngineModel& model) {
  const auto n = static_cast<Eigen::Index>(model.joints.size());
  EngineState state;
  state.R_WJ.fill(Matrix3::Identity());
  state.p_WJ.fill(Vector3::Zero());
  state.v.setZero(n);
  state.J_W.setZero(6, n);
  state.M.setZero(n, n);
  state.bias.setZero(n);
  state.gravity.setZero(n);
  return state;
}

void ComputeKinematics(const EngineModel& model, const JointVector& q,
                       EngineState* state) noexcept {
  std::array<double, kMaxJoints> sine, cosine;
  SinesAndCosines(q.data(), static_cast<int>(model.joints.size()), sine.data(), cosine.data());
  for (std::size_t j = 1; j <= model.joints.size(); ++j) {
    const EngineJoint& joint = model.joints[j - 1];
    const auto k = static_cast<Eigen::Index>(j) - 1;
    Matrix3 R = joint.R_PJ;
    Vector3 p = joint.p_PJ;
    if (joint.prismatic)
      p += q[k] * (R * joint.axis);
    else
      Turn(joint, sine[j - 1], cosine[j - 1], &R);
    const Matrix3& R_WP = state->R_WJ[joint.parent];
    state->R_WJ[j].noalias() = R_WP * R;
    state->p_WJ[j] = state->p_WJ[joint.parent] + R_WP * p;
    const Vector3 axis = joint.own_axis < 0 ? Vector3(state->R_WJ[j] * joint.axis)
                                            : Vector3(state->R_WJ[j].col(joint.own_axis));
    if (joint.prismatic)
      state->J_W.col(k) << axis, Vector3::Zero();
    else
      state->J_W.col(k) << state->p_WJ[j].cross(axis), axis;
  }
}

void ComputeDynamics(const EngineModel& model, const JointVector& q, const JointVector& v,
                     double gravity, EngineState* state) noexcept {
  ComputeKinematics(model, q, state);
  for (std::size_t j = 1; j <= model.joints.size(); ++j)
    Transform(model.joints[j - 1].body, state->R_WJ[j], state->p_WJ[j], &state->inertia[j]);
  ComputeComposite(model, gravity, state);
  state->v = v;
  state->waits_for_bias = &model;
}

const JointVector& Bias(EngineState* state) noexcept {
  if (state->waits_for_bias != nullptr) {
    ComputeCoriolis(*state->waits_for_bias, state);
    state->bias += state->gravity;
    state->waits_for_bias = nullptr;
  }
  return state->bias;
}

}  // namespace predictor
