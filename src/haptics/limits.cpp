#include "haptics/limits.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

constexpr double kLinkBraking = 2.0;  // with which a link pair can be braked [m/s²]
// Of a joint's velocity bound: the rest is left to a stop, which keeps the handles on their way by
// making single joints a little faster.
constexpr double kShareOfVelocity = 0.98;

}  // namespace

double ApproachSpeed(double distance, double gain, double acceleration) noexcept {
  if (distance <= 0) return 0;
  // On the line v = gain·d the deceleration is gain·v; it reaches `acceleration` at this distance,
  // from where a parabola of that deceleration goes on with the same slope.
  const double joint = acceleration / (gain * gain);
  if (distance <= joint) return gain * distance;
  return std::sqrt(2 * acceleration * (distance - joint / 2));
}

void JointLimits::AddTo(const RenderState& state, int, Qp* qp) noexcept {
  const double gain = spec_.joint_gain / (spec_.joint_influence - spec_.joint_security);
  for (int i = 0; i < kHands; ++i) {
    if (!state.arms[i].present) continue;
    const ArmLimits& arm = arms_[static_cast<std::size_t>(i)];
    const JointVector& q = *state.arms[i].q;
    for (int j = 0; j < q.size(); ++j) {
      const int k = state.offset[i] + j;
      const double a = arm.acceleration[j];
      const double to_upper = arm.upper[j] - q[j] - spec_.joint_security;
      const double to_lower = q[j] - arm.lower[j] - spec_.joint_security;
      const double fastest = kShareOfVelocity * arm.velocity[j];
      const double highest = std::min(fastest, ApproachSpeed(to_upper, gain, a));
      const double lowest = -std::min(fastest, ApproachSpeed(to_lower, gain, a));
      // One tick's acceleration about the last command, moved into what position allows.
      qp->upper()[k] = std::clamp(state.last[i][j] + a * state.dt, lowest, highest);
      qp->lower()[k] = std::clamp(state.last[i][j] - a * state.dt, lowest, highest);
    }
  }
}

void LinkDistance::AddTo(const RenderState& state, int row, Qp* qp) noexcept {
  const double gain = spec_.collision_gain / (spec_.influence_distance - spec_.security_distance);
  nearest_ = std::numeric_limits<double>::infinity();
  for (const Pair& pair : pairs_) {
    const RenderArm& a = state.arms[pair.arm_a];
    const RenderArm& b = state.arms[pair.arm_b];
    const Vector3 between =
        a.data->FramePose(*a.model, pair.a).p - b.data->FramePose(*b.model, pair.b).p;
    const double distance = between.norm();
    nearest_ = std::min(nearest_, distance);
    const Vector3 n = distance > 1e-9 ? Vector3(between / distance) : Vector3::UnitY();
    Jacobian J;
    a.data->FrameJacobian(*a.model, pair.a, &J);
    for (int j = 0; j < J.cols(); ++j)
      qp->A()(row, state.offset[pair.arm_a] + j) += n.dot(J.col(j).head<3>());
    b.data->FrameJacobian(*b.model, pair.b, &J);
    for (int j = 0; j < J.cols(); ++j)
      qp->A()(row, state.offset[pair.arm_b] + j) -= n.dot(J.col(j).head<3>());
    qp->b()[row] = -ApproachSpeed(distance - spec_.security_distance, gain, acceleration_);
    ++row;
  }
}

namespace {

struct NamedLink {
  int arm;
  std::string link;
};

// "left:link", "right:link", or a link alone on the side that its place in the pair stands for.
NamedLink ParseLink(const std::string& name, int side) {
  for (int arm = 0; arm < kHands; ++arm) {
    const std::string prefix = std::string(kHandNames[static_cast<std::size_t>(arm)]) + ":";
    if (name.rfind(prefix, 0) == 0) return {arm, name.substr(prefix.size())};
  }
  return {side, name};
}

// `key`: of the pair.
FrameId FrameOf(const NamedLink& link,
                const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
                const std::string& key) {
  const std::string arm = kHandNames[static_cast<std::size_t>(link.arm)];
  if (!models[link.arm])
    throw InputError::At(key, key + " keeps " + Quote(link.link) + " of the " + arm +
                                  " arm apart, but there is no such arm. Remove the pair, or write "
                                  "left:LINK or right:LINK for links of the arm that there is.");
  try {
    return models[link.arm]->Frame(link.link);
  } catch (const InputError& error) {
    throw InputError::At(key, key + " (" + arm + " arm): " + error.what());
  }
}

}  // namespace

std::vector<LinkDistance::Pair> LinkPairs(
    const Scenario& s, const std::array<std::shared_ptr<const RobotModel>, kHands>& models) {
  std::vector<std::array<std::string, 2>> names = s.rendering.link_pairs;
  // Real arms' elbows keep their distance whatever else does: that is no scenario's to leave out.
  const bool elbows = names.empty() || s.HasRealArms();
  if (elbows && models[0] && models[1] && !s.arm(0).elbow.empty() && !s.arm(1).elbow.empty())
    names.push_back({s.arm(0).elbow, s.arm(1).elbow});
  if (names.size() > kMaxLinkPairs)
    throw InputError::At("rendering.link_pairs",
                         "rendering.link_pairs has " + std::to_string(names.size()) +
                             " pairs; at most " + std::to_string(kMaxLinkPairs) +
                             " fit. Remove some.");
  std::vector<LinkDistance::Pair> pairs;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string key = "rendering.link_pairs." + std::to_string(i);
    const NamedLink a = ParseLink(names[i][0], 0);
    const NamedLink b = ParseLink(names[i][1], 1);
    if (a.arm == b.arm && a.link == b.link)
      throw InputError::At(key,
                           key + " keeps " + Quote(a.link) + " apart from itself. Name two links.");
    pairs.push_back({a.arm, b.arm, FrameOf(a, models, key), FrameOf(b, models, key)});
  }
  return pairs;
}

ArmLimits LimitsOf(const ArmSpec& spec, const RobotModel& model) {
  const auto check = [&](const char* key, std::size_t size, bool one_is_enough) {
    if (size == static_cast<std::size_t>(model.dof()) || (one_is_enough && size == 1)) return;
    throw InputError::At(key, std::string(key) + " has " + std::to_string(size) +
                                  " values; the arm has " + std::to_string(model.dof()) +
                                  " joints. Give " +
                                  (one_is_enough ? "one value for all, or " : "") + "one a joint.");
  };
  if (!spec.velocity_limit.empty()) check("velocity_limit", spec.velocity_limit.size(), false);
  check("acceleration_limit", spec.acceleration_limit.size(), true);
  constexpr double kShareOfVendor = 0.8;
  ArmLimits l;
  l.lower = model.position_lower();
  l.upper = model.position_upper();
  l.velocity = kShareOfVendor * model.velocity_limit();
  l.acceleration.resize(model.dof());
  for (int j = 0; j < model.dof(); ++j) {
    if (!spec.velocity_limit.empty())
      l.velocity[j] = std::min(l.velocity[j], spec.velocity_limit[static_cast<std::size_t>(j)]);
    l.acceleration[j] = OneOrEach(spec.acceleration_limit, j);
  }
  return l;
}

Limits MakeLimits(const Scenario& s,
                  const std::array<std::shared_ptr<const RobotModel>, kHands>& models) {
  std::array<ArmLimits, kHands> arms;
  for (int i = 0; i < kHands; ++i)
    if (models[i]) arms[i] = LimitsOf(s.arm(i), *models[i]);
  auto joints = std::make_unique<JointLimits>(s.rendering, std::move(arms));
  auto links = std::make_unique<LinkDistance>(s.rendering, kLinkBraking, LinkPairs(s, models));
  Limits limits;
  limits.joints = joints.get();
  limits.links = links.get();
  limits.all.push_back(std::move(joints));
  limits.all.push_back(std::move(links));
  // A further limit is one line here.
  return limits;
}

}  // namespace predictor
