#include "models/torque_regressor.h"

// The regressor's visitor has seven arguments, one more than Boost's default maximum.
#define BOOST_FUSION_INVOKE_MAX_ARITY 10

#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/multibody.hpp>

#include "models/robot_impl.h"

namespace predictor {
namespace {

namespace pin = pinocchio;

// Only the joint types in use are listed, because compiling Pinocchio's default collection of 25
// takes a minute.
template <typename S, int O>
struct ArmJoints {
  using Scalar = S;
  static constexpr int Options = O;
  using JointModelRevoluteUnaligned = pin::JointModelRevoluteUnalignedTpl<S, O>;
  using JointModelPrismaticUnaligned = pin::JointModelPrismaticUnalignedTpl<S, O>;
  using JointModelVariant =
      boost::variant<JointModelRevoluteUnaligned, JointModelPrismaticUnaligned>;
  using JointDataVariant = boost::variant<pin::JointDataRevoluteUnalignedTpl<S, O>,
                                          pin::JointDataPrismaticUnalignedTpl<S, O>>;
};

using Joints = ArmJoints<double, 0>;
using Model = pin::ModelTpl<double, 0, ArmJoints>;
using Data = pin::DataTpl<double, 0, ArmJoints>;

InertialParameters InertialParametersOf(const BodyInertia& body) {
  const Matrix3& I = body.inertia;
  InertialParameters parameters;
  parameters << body.mass, body.moment, I(0, 0), I(0, 1), I(1, 1), I(0, 2), I(1, 2), I(2, 2);
  return parameters;
}

// The model has no inertia, because a regressor does not depend on it.
Model PinocchioModel(const EngineModel& engine, double gravity) {
  Model model;
  for (const EngineJoint& joint : engine.joints) {
    const pin::SE3 X_PJ(joint.R_PJ, joint.p_PJ);
    const std::string name = "joint " + std::to_string(model.njoints);
    if (joint.prismatic)
      model.addJoint(joint.parent, Joints::JointModelPrismaticUnaligned(joint.axis), X_PJ, name);
    else
      model.addJoint(joint.parent, Joints::JointModelRevoluteUnaligned(joint.axis), X_PJ, name);
  }
  model.gravity.linear() = Vector3(0, 0, -gravity);
  return model;
}

}  // namespace

struct EngineRegressor {
  explicit EngineRegressor(const Model& of) : model(of), data(of) {}
  Model model;
  Data data;
};

TorqueRegressor::TorqueRegressor(const RobotModel& model, double gravity)
    : engine_(std::make_shared<EngineRegressor>(PinocchioModel(model.impl().engine, gravity))) {
  const std::vector<EngineJoint>& joints = model.impl().engine.joints;
  parameters_.resize(static_cast<Eigen::Index>(10 * joints.size()));
  for (std::size_t j = 0; j < joints.size(); ++j)
    parameters_.segment<10>(static_cast<Eigen::Index>(10 * j)) =
        InertialParametersOf(joints[j].body);
}

const Eigen::MatrixXd& TorqueRegressor::Compute(const JointVector& q, const JointVector& v,
                                                const JointVector& a) {
  return pin::computeJointTorqueRegressor(engine_->model, engine_->data, q, v, a);
}

InertialParameters InertialParametersOf(double mass, const Vector3& com, const Matrix3& inertia) {
  return InertialParametersOf(InertiaAboutOrigin(mass, com, inertia));
}

}  // namespace predictor
