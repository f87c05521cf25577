#include "models/rigid_body_engine.h"

// The regressor's visitor has seven arguments, one more than Boost's default maximum.
#define BOOST_FUSION_INVOKE_MAX_ARITY 10

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/multibody.hpp>

namespace predictor {
namespace {

namespace pin = pinocchio;

// Only the joint types in use: compiling Pinocchio's default collection of 25 takes a minute.
template <typename S, int O>
struct ArmJoints {
  using Scalar = S;
  static constexpr int Options = O;
  using JointModelRevoluteUnaligned = pin::JointModelRevoluteUnalignedTpl<S, O>;
  using JointModelPrismaticUnaligned = pin::JointModelPrismaticUnalignedTpl<S, O>;
  using JointModelRX = pin::JointModelRevoluteTpl<S, O, 0>;
  using JointModelRY = pin::JointModelRevoluteTpl<S, O, 1>;
  using JointModelRZ = pin::JointModelRevoluteTpl<S, O, 2>;
  using JointModelVariant =
      boost::variant<JointModelRZ, JointModelRY, JointModelRX, JointModelRevoluteUnaligned,
                     JointModelPrismaticUnaligned>;
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
  // Motion of each body, in W, about W's origin.
  std::array<pin::Motion, kMaxJoints + 1> twist, bias_acceleration;
  std::array<pin::Force, kMaxJoints + 1> force;
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

pin::Motion Axis(const Data& data, std::size_t joint) {
  return pin::Motion(data.J.col(static_cast<int>(joint) - 1));
}

// Torques of gravity for 1 m/s², after crba: the weight carried by each joint, about its axis.
void ComputeGravity(const Data& data, JointVector* gravity) {
  const pin::Motion upwards(Vector3::UnitZ(), Vector3::Zero());
  for (std::size_t j = 1; j <= static_cast<std::size_t>(gravity->size()); ++j) {
    (*gravity)(static_cast<int>(j) - 1) = Axis(data, j).dot(data.oYcrb[j] * upwards);
  }
}

// Torques C v of Coriolis and centrifugal forces, after crba: recursive Newton–Euler without joint
// acceleration and gravity, in W (Featherstone 2008, table 5.1). It costs half as much as the
// engine's own algorithm because the axes and poses in W are already available.
void ComputeCoriolis(const Model& model, const JointVector& v, EngineData* data,
                     JointVector* torque) {
  const Data& d = data->data;
  data->twist[0].setZero();
  data->bias_acceleration[0].setZero();
  const auto joints = static_cast<std::size_t>(v.size());
  for (std::size_t j = 1; j <= joints; ++j) {
    const std::size_t parent = model.parents[j];
    const pin::Motion of_joint = Axis(d, j) * v(static_cast<int>(j) - 1);
    const pin::Motion& V = data->twist[j] = data->twist[parent] + of_joint;
    const pin::Motion& A = data->bias_acceleration[j] =
        data->bias_acceleration[parent] + V.cross(of_joint);
    const pin::Inertia inertia = d.oMi[j].act(model.inertias[j]);
    data->force[j] = inertia * A + V.cross(inertia * V);
  }
  for (std::size_t j = joints; j > 0; --j) {
    (*torque)(static_cast<int>(j) - 1) = Axis(d, j).dot(data->force[j]);
    data->force[model.parents[j]] += data->force[j];
  }
}

}  // namespace

std::shared_ptr<const EngineModel> MakeEngineModel(const UrdfModel& urdf, const Pose& X_WB,
                                                   std::vector<int>* body,
                                                   std::vector<Pose>* X_JL) {
  auto engine = std::make_shared<EngineModel>();
  Model& model = engine->model;
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
  pin::crba(model.model, data->data, q, pin::Convention::WORLD);
  CopyKinematics(data->data, state);
  state->M = data->data.M.selfadjointView<Eigen::Upper>();
  ComputeGravity(data->data, &state->gravity);
  ComputeCoriolis(model.model, v, data, &state->bias);
  state->gravity *= gravity;
  state->bias += state->gravity;
}

// Has a separate model because gravity is part of a model.
struct EngineRegressor {
  EngineRegressor(const Model& of, double gravity) : model(of), data(of) {
    model.gravity.linear() = Vector3(0, 0, -gravity);
  }
  Model model;
  Data data;
};

Eigen::VectorXd InertialParametersOf(const EngineModel& model) {
  const auto joints = static_cast<Eigen::Index>(model.model.njoints) - 1;
  Eigen::VectorXd parameters(kInertialParameters * joints);
  for (Eigen::Index j = 0; j < joints; ++j) {
    parameters.segment<kInertialParameters>(kInertialParameters * j) =
        model.model.inertias[static_cast<std::size_t>(j) + 1].toDynamicParameters();
  }
  return parameters;
}

std::shared_ptr<EngineRegressor> MakeEngineRegressor(const EngineModel& model, double gravity) {
  return std::make_shared<EngineRegressor>(model.model, gravity);
}

const Eigen::MatrixXd& ComputeTorqueRegressor(const JointVector& q, const JointVector& v,
                                              const JointVector& a, EngineRegressor* regressor) {
  return pin::computeJointTorqueRegressor(regressor->model, regressor->data, q, v, a);
}

}  // namespace predictor
