#include "models/rigid_body_engine.h"

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

namespace predictor {
namespace {

namespace pin = pinocchio;

// The joints that we need; Pinocchio's default collection of 25 takes a minute to compile.
template <typename S, int O>
struct ArmJoints {
  using Scalar = S;
  static constexpr int Options = O;
  using JointModelRevoluteUnaligned = pin::JointModelRevoluteUnalignedTpl<S, O>;
  using JointModelPrismaticUnaligned = pin::JointModelPrismaticUnalignedTpl<S, O>;
  using JointModelRX = pin::JointModelRevoluteTpl<S, O, 0>;
  using JointModelRY = pin::JointModelRevoluteTpl<S, O, 1>;
  using JointModelRZ = pin::JointModelRevoluteTpl<S, O, 2>;
  using JointModelVariant = boost::variant<JointModelRZ, JointModelRY, JointModelRX,
                                           JointModelRevoluteUnaligned, JointModelPrismaticUnaligned>;
  using JointDataVariant =
      boost::variant<pin::JointDataRevoluteTpl<S, O, 2>, pin::JointDataRevoluteTpl<S, O, 1>,
                     pin::JointDataRevoluteTpl<S, O, 0>, pin::JointDataRevoluteUnalignedTpl<S, O>,
                     pin::JointDataPrismaticUnalignedTpl<S, O>>;
};

using Joints = ArmJoints<double, 0>;
using Model = pin::ModelTpl<double, 0, ArmJoints>;
using Data = pin::DataTpl<double, 0, ArmJoints>;

pin::SE3 ToSE3(const Pose& X) { return {X.R(), X.p}; }

pin::JointIndex AddJoint(const UrdfJoint& joint, pin::JointIndex parent, const pin::SE3& X,
                         Model* model) {
  if (joint.type == UrdfJointType::kPrismatic) {
    return model->addJoint(parent, Joints::JointModelPrismaticUnaligned(joint.axis), X, joint.name);
  }
  if (joint.axis == Vector3::UnitX()) {
    return model->addJoint(parent, Joints::JointModelRX(), X, joint.name);
  }
  if (joint.axis == Vector3::UnitY()) {
    return model->addJoint(parent, Joints::JointModelRY(), X, joint.name);
  }
  if (joint.axis == Vector3::UnitZ()) {
    return model->addJoint(parent, Joints::JointModelRZ(), X, joint.name);
  }
  return model->addJoint(parent, Joints::JointModelRevoluteUnaligned(joint.axis), X, joint.name);
}

}  // namespace

struct EngineModel {
  Model model;
};

struct EngineData {
  explicit EngineData(const Model& model) : data(model) {}
  Data data;
};

namespace {

void CopyKinematics(const Data& data, EngineState* state) {
  const auto joints = static_cast<std::size_t>(state->J_W.cols());
  for (std::size_t j = 1; j <= joints; ++j) {
    state->R_WJ[j] = data.oMi[j].rotation();
    state->p_WJ[j] = data.oMi[j].translation();
  }
  state->J_W = data.J;
}

}  // namespace

std::shared_ptr<const EngineModel> MakeEngineModel(const UrdfModel& urdf, const Pose& X_WB,
                                                   std::vector<int>* body,
                                                   std::vector<Pose>* X_JL) {
  auto engine = std::make_shared<EngineModel>();
  Model& model = engine->model;
  model.gravity.linear() = Vector3(0, 0, -1);  // scaled when asked for: all is linear in it
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
      const auto carrier = static_cast<pin::JointIndex>((*body)[parent]);
      (*body)[child] = static_cast<int>(AddJoint(joint, carrier, ToSE3(X), &model));
      (*X_JL)[child] = Pose::Identity();
    }
  }
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    const UrdfLink& link = urdf.links[i];
    model.appendBodyToJoint(static_cast<pin::JointIndex>((*body)[i]),
                            pin::Inertia(link.mass, link.com, link.inertia), ToSE3((*X_JL)[i]));
  }
  return engine;
}

std::shared_ptr<EngineData> MakeEngineData(const EngineModel& model) {
  return std::make_shared<EngineData>(model.model);
}

void ComputeKinematics(const EngineModel& model, const JointVector& q, EngineData* data,
                       EngineState* state) {
  pin::computeJointJacobians(model.model, data->data, q);
  CopyKinematics(data->data, state);
}

void ComputeDynamics(const EngineModel& model, const JointVector& q, const JointVector& v,
                     double gravity, EngineData* data, EngineState* state) {
  Data& d = data->data;
  pin::crba(model.model, d, q, pin::Convention::WORLD);
  CopyKinematics(d, state);
  state->M = d.M.selfadjointView<Eigen::Upper>();
  pin::nonLinearEffects(model.model, d, q, v);
  pin::computeGeneralizedGravity(model.model, d, q);
  state->gravity = gravity * d.g;
  state->bias = d.nle + (gravity - 1) * d.g;
}

}  // namespace predictor
