#include "models/robot.h"

#include "core/error.h"
#include "core/text.h"
#include "models/robot_impl.h"
#include "scenario/paths.h"

namespace predictor {
namespace {

// Reads limits and names of the movable joints, and which joints move each body.
void ReadJoints(const UrdfModel& urdf, const std::vector<int>& body, RobotModel::Impl* impl) {
  const auto append = [](JointVector* x, double value) {
    x->conservativeResize(x->size() + 1);
    (*x)(x->size() - 1) = value;
  };
  for (const UrdfJoint& joint : urdf.joints) {
    if (joint.type == UrdfJointType::kFixed) continue;
    const auto parent = static_cast<std::size_t>(body[static_cast<std::size_t>(joint.parent)]);
    const auto child = static_cast<std::size_t>(body[static_cast<std::size_t>(joint.child)]);
    impl->support[child] = impl->support[parent] | (1u << (child - 1));
    impl->joint_names.push_back(joint.name);
    impl->prismatic.push_back(joint.type == UrdfJointType::kPrismatic);
    append(&impl->lower, joint.lower);
    append(&impl->upper, joint.upper);
    append(&impl->velocity, joint.velocity);
    append(&impl->effort, joint.effort);
  }
}

void CheckJointCount(const UrdfModel& urdf) {
  std::vector<std::string> names;
  for (const UrdfJoint& joint : urdf.joints) {
    if (joint.type != UrdfJointType::kFixed) names.push_back(joint.name);
  }
  if (names.empty()) {
    throw InputError(urdf.file.string(), "The robot " + Quote(urdf.name) +
                                             " has no moving joint. Give the model of an arm.");
  }
  if (names.size() > kMaxJoints) {
    throw InputError(
        urdf.file.string(),
        "The robot " + Quote(urdf.name) + " has " + std::to_string(names.size()) +
            " moving joints, but at most " + std::to_string(kMaxJoints) +
            " are possible. Remove unneeded parts with remove_links. Joints: " + Join(names) + ".");
  }
}

// Jacobian about the point p of W, which only the joints in `support` move.
struct PointJacobian {
  const EngineState& state;
  std::uint32_t support;
  Vector3 p;  // p_WF [m]

  bool Moves(int k) const { return (support >> k) & 1u; }
  Vector6 Column(int k) const {
    Vector6 c = state.J_W.col(k);
    c.head<3>() += c.tail<3>().cross(p);
    return c;
  }
};

PointJacobian At(const RobotModel& model, const EngineState& state, const FrameId& frame) {
  const auto body = static_cast<std::size_t>(frame.body);
  return {state, model.impl().support[body], state.R_WJ[body] * frame.X_JF.p + state.p_WJ[body]};
}

}  // namespace

RobotModel::RobotModel() : impl_(std::make_unique<Impl>()) {}
RobotModel::~RobotModel() = default;

std::shared_ptr<const RobotModel> RobotModel::Load(const RobotSource& source) {
  try {
    const std::filesystem::path folder = source.folder.empty() ? "." : source.folder;
    const std::filesystem::path file = ResolveModelPath(source.model, folder);
    return Build(ReadUrdf(file, source.remove_links, folder), source.X_WB);
  } catch (const InputError& error) {
    if (source.key.empty()) throw;
    // remove_links is the only key that the model's reader knows. Every other error concerns the
    // file.
    throw error.Within(error.key().empty() ? source.key + ".model" : source.key);
  }
}

std::shared_ptr<const RobotModel> RobotModel::Build(const UrdfModel& urdf, const Pose& X_WB) {
  CheckJointCount(urdf);
  std::shared_ptr<RobotModel> robot(new RobotModel);
  Impl& impl = *robot->impl_;
  std::vector<int> body;
  std::vector<Pose> X_JL;
  impl.engine = MakeEngineModel(urdf, X_WB, &body, &X_JL);
  impl.X_WB = X_WB;
  impl.name = urdf.name;
  impl.mass = urdf.Mass();
  impl.link_names = urdf.LinkNames();
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    impl.links[urdf.links[i].name] = {body[i], X_JL[i]};
  }
  ReadJoints(urdf, body, &impl);
  return robot;
}

int RobotModel::dof() const { return static_cast<int>(impl_->joint_names.size()); }
const std::string& RobotModel::joint_name(int j) const {
  return impl_->joint_names[static_cast<std::size_t>(j)];
}
bool RobotModel::is_prismatic(int j) const { return impl_->prismatic[static_cast<std::size_t>(j)]; }
const JointVector& RobotModel::position_lower() const { return impl_->lower; }
const JointVector& RobotModel::position_upper() const { return impl_->upper; }
const JointVector& RobotModel::velocity_limit() const { return impl_->velocity; }
const JointVector& RobotModel::effort_limit() const { return impl_->effort; }
double RobotModel::mass() const { return impl_->mass; }
std::vector<std::string> RobotModel::link_names() const { return impl_->link_names; }

FrameId RobotModel::Frame(const std::string& link, const Pose& X_LF) const {
  const auto found = impl_->links.find(link);
  if (found == impl_->links.end()) {
    throw InputError(Quote(link) + " is not a link of the robot " + Quote(impl_->name) + ". " +
                     Suggestion(link, impl_->link_names));
  }
  return {found->second.body, found->second.X_JF * X_LF};
}

RobotData::RobotData(const RobotModel& model) : impl_(std::make_unique<Impl>()) {
  impl_->engine = MakeEngineData(*model.impl().engine);
  EngineState& state = impl_->state;
  const int n = model.dof();
  state.R_WJ.fill(Matrix3::Identity());
  state.p_WJ.fill(Vector3::Zero());
  state.v.setZero(n);
  state.J_W.setZero(6, n);
  state.M.setZero(n, n);
  state.bias.setZero(n);
  state.gravity.setZero(n);
}
RobotData::~RobotData() = default;
RobotData::RobotData(RobotData&&) noexcept = default;
RobotData& RobotData::operator=(RobotData&&) noexcept = default;

void RobotData::UpdateKinematics(const RobotModel& model, const JointVector& q,
                                 const JointVector& v) {
  ComputeKinematics(*model.impl().engine, q, impl_->engine.get(), &impl_->state);
  impl_->state.v = v;
}

void RobotData::UpdateDynamics(const RobotModel& model, const JointVector& q, const JointVector& v,
                               double gravity) {
  ComputeDynamics(*model.impl().engine, q, v, gravity, impl_->engine.get(), &impl_->state);
  impl_->state.v = v;
}

Pose RobotData::FramePose(const RobotModel&, const FrameId& frame) const {
  const auto body = static_cast<std::size_t>(frame.body);
  const EngineState& state = impl_->state;
  return Pose{state.p_WJ[body], Quaternion(state.R_WJ[body])} * frame.X_JF;
}

Twist RobotData::FrameTwist(const RobotModel& model, const FrameId& frame) const {
  const PointJacobian J = At(model, impl_->state, frame);
  Twist V = Twist::Zero();
  for (int k = 0; k < impl_->state.v.size(); ++k) {
    if (J.Moves(k)) V += impl_->state.v(k) * J.Column(k);
  }
  return V;
}

Vector6 RobotData::FrameBiasAcceleration(const RobotModel& model, const FrameId& frame) const {
  // Sums along the chain with the columns S_k of J_W, in W. Each column is moved by the preceding
  // joints, so the spatial acceleration gains V × S_k v_k (Featherstone 2008, (2.47)). The result
  // is then converted to the classical acceleration.
  const PointJacobian J = At(model, impl_->state, frame);
  Vector6 V = Vector6::Zero();
  Vector6 A = Vector6::Zero();
  for (int k = 0; k < impl_->state.v.size(); ++k) {
    if (!J.Moves(k)) continue;
    const Vector6 S = impl_->state.v(k) * impl_->state.J_W.col(k);
    A.head<3>() += V.tail<3>().cross(S.head<3>()) + V.head<3>().cross(S.tail<3>());
    A.tail<3>() += V.tail<3>().cross(S.tail<3>());
    V += S;
  }
  const Vector3 p_dot = V.head<3>() + V.tail<3>().cross(J.p);
  A.head<3>() += A.tail<3>().cross(J.p) + V.tail<3>().cross(p_dot);
  return A;
}

void RobotData::FrameJacobian(const RobotModel& model, const FrameId& frame, Jacobian* J) const {
  const PointJacobian at = At(model, impl_->state, frame);
  J->resize(6, impl_->state.v.size());
  for (int k = 0; k < impl_->state.v.size(); ++k) {
    if (at.Moves(k)) {
      J->col(k) = at.Column(k);
    } else {
      J->col(k).setZero();
    }
  }
}

const JointMatrix& RobotData::M() const { return impl_->state.M; }
const JointVector& RobotData::bias() const { return impl_->state.bias; }
const JointVector& RobotData::gravity() const { return impl_->state.gravity; }

}  // namespace predictor
