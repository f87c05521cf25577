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

// A point of a body. Only the joints in `support` move this point.
struct LinkPoint {
  std::uint32_t support;
  Vector3 p;  // p_WF [m]

  bool IsMovedBy(int k) const { return (support >> k) & 1u; }
};

LinkPoint At(const RobotModel& model, const EngineState& state, const FrameId& frame) {
  const auto body = static_cast<std::size_t>(frame.body);
  return {model.impl().support[body], state.R_WJ[body] * frame.X_JF.p + state.p_WJ[body]};
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
    // Errors from the model's reader have the key remove_links or no key. Errors without a key
    // refer to the file.
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

RobotData::RobotData(const RobotModel& model)
    : impl_(std::make_unique<Impl>(Impl{MakeEngineState(model.impl().engine)})) {}
RobotData::~RobotData() = default;
RobotData::RobotData(RobotData&&) noexcept = default;
RobotData& RobotData::operator=(RobotData&&) noexcept = default;

void RobotData::UpdateKinematics(const RobotModel& model, const JointVector& q,
                                 const JointVector& v) {
  ComputeKinematics(model.impl().engine, q, &impl_->state);
  impl_->state.v = v;
  impl_->state.waits_for_bias = nullptr;
}

void RobotData::UpdateDynamics(const RobotModel& model, const JointVector& q, const JointVector& v,
                               double gravity) {
  ComputeDynamics(model.impl().engine, q, v, gravity, &impl_->state);
}

Pose RobotData::FramePose(const RobotModel&, const FrameId& frame) const {
  const auto body = static_cast<std::size_t>(frame.body);
  const EngineState& state = impl_->state;
  return Pose{state.p_WJ[body], Quaternion(state.R_WJ[body])} * frame.X_JF;
}

Twist RobotData::FrameTwist(const RobotModel& model, const FrameId& frame) const {
  const LinkPoint point = At(model, impl_->state, frame);
  Twist V = Twist::Zero();
  for (int k = 0; k < impl_->state.v.size(); ++k)
    if (point.IsMovedBy(k)) V += impl_->state.v(k) * impl_->state.J_W.col(k);
  return ShiftTwist(V, point.p);
}

FrameMotion RobotData::MotionOf(const RobotModel& model, const FrameId& frame,
                                const JointVector& a) const {
  // The loop sums along the chain with the columns S_k of J_W, in W. Each column is moved by the
  // preceding joints, so the spatial acceleration gains V × S_k v_k (Featherstone 2008, (2.47)).
  // The sum is then converted to the classical acceleration.
  const LinkPoint point = At(model, impl_->state, frame);
  const JointVector& v = impl_->state.v;
  Spatial V = Spatial::Zero(), A = V;
  for (int k = 0; k < v.size(); ++k) {
    if (!point.IsMovedBy(k)) continue;
    const Spatial S = Axis(impl_->state, k);
    A = A + S * a(k) + CrossMotion(V, S * v(k));
    V = V + S * v(k);
  }
  FrameMotion motion;
  motion.X_W = FramePose(model, frame);
  const Vector3 p_dot = V.linear + V.angular.cross(point.p);
  motion.V_W << p_dot, V.angular;
  motion.A_W << A.linear + A.angular.cross(point.p) + V.angular.cross(p_dot), A.angular;
  return motion;
}

void RobotData::FrameJacobian(const RobotModel& model, const FrameId& frame, Jacobian* J) const {
  const LinkPoint point = At(model, impl_->state, frame);
  J->resize(6, impl_->state.v.size());
  for (int k = 0; k < impl_->state.v.size(); ++k) {
    if (!point.IsMovedBy(k)) {
      J->col(k).setZero();
      continue;
    }
    const Spatial S = Axis(impl_->state, k);
    J->col(k) << S.linear + S.angular.cross(point.p), S.angular;
  }
}

const JointMatrix& RobotData::M() const { return impl_->state.M; }
const JointVector& RobotData::bias() const { return Bias(&impl_->state); }
const JointVector& RobotData::gravity() const { return impl_->state.gravity; }

}  // namespace predictor
