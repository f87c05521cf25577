#include "ros_tcp/topics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/format.h"

namespace predictor::ros_tcp {
namespace {

constexpr double kForceScale = 0.01;  // scale of an arrow's length [m/N]
constexpr double kTorqueScale = 0.1;  // [m/(N·m)]
constexpr double kShaft = 0.012;      // shaft diameter of an arrow [m]
constexpr double kLine = 0.006;       // line width of the guidance path [m]
constexpr int kCirclePoints = 64;

Vector3 Part(const std::array<double, 6>& w, int from) {
  const auto i = static_cast<std::size_t>(from);
  return {w[i], w[i + 1], w[i + 2]};
}

std::string CauseText(StopCause cause, int hand, double value, double limit) {
  return Formatted(" %s %s %.4g %.4g", Name(cause), hand < 0 ? "-" : HandName(hand), value, limit);
}

std::string StateText(const TickRecord& r) {
  if (r.cause == StopCause::kNone) return Name(r.state);
  std::string text = Name(r.state) + CauseText(r.cause, r.cause_hand, r.cause_value, r.cause_limit);
  const StatusRecord& harder = r.harder;
  if (harder.cause != StopCause::kNone)
    text += CauseText(harder.cause, harder.hand, harder.value, harder.limit);
  return text;
}

}  // namespace

std::array<float, 4> WarningColor(double share) {
  if (!(share <= 0.8)) return {0.84F, 0.15F, 0.16F, 1};
  if (share > 0.5) return {0.95F, 0.55F, 0.05F, 1};
  return {0.18F, 0.63F, 0.22F, 1};
}

RosTopics::RosTopics(const Scenario& scenario, std::vector<std::string> joints,
                     const Vector3& object_start)
    : joints_(std::move(joints)), guidance_(scenario.guidance), object_start_(object_start) {
  const auto add = [this](const std::string& name, const char* type) {
    list_.push_back({"/predictor/" + name, type});
  };
  add("joint_states", RosJointState::kType);
  add("object/pose", RosPoseStamped::kType);
  for (const int i : scenario.hands()) {
    const std::string handle = std::string(HandName(i)) + "_handle/";
    add(handle + "pose", RosPoseStamped::kType);
    add(handle + "real_pose", RosPoseStamped::kType);
    add(handle + "wrench", RosWrenchStamped::kType);
  }
  add("markers", RosMarker::kType);
  add("state", RosString::kType);
  add("tracking", RosFloat64MultiArray::kType);
}

std::size_t RosTopics::Index(const std::string& name) const {
  std::size_t i = 0;
  while (list_[i].name != "/predictor/" + name) ++i;
  return i;
}

// Draws an arrow that starts at the handle and points along the force or the torque's axis. Its
// colour depends on the ratio of the force or torque to its threshold.
RosMarker RosTopics::Arrow(const TickRecord& r, std::size_t hand, bool torque) const {
  const HandRecord& h = r.hands[hand];
  const Vector3 value = Part(h.wrench, torque ? 3 : 0);
  const Parameter threshold = torque ? Parameter::kTorqueThreshold : Parameter::kForceThreshold;
  const Vector3 start = FromRecord(h.virtual_.pose).p;
  RosMarker m;
  m.ns = torque ? "torque" : "force";
  m.id = static_cast<std::int32_t>(hand);
  m.scale = {kShaft, 2 * kShaft, 0};
  m.color = WarningColor(value.norm() / r.parameters[static_cast<std::size_t>(threshold)]);
  m.points = {start, start + (torque ? kTorqueScale : kForceScale) * value};
  return m;
}

RosMarker RosTopics::Guidance() const {
  RosMarker m;
  m.ns = "guidance";
  m.type = RosMarker::kLineStrip;
  m.scale.x() = kLine;
  m.color = {0.2F, 0.4F, 0.9F, 1};
  for (int k = 0; k <= kCirclePoints; ++k) {
    const double angle = 2 * std::numbers::pi * k / kCirclePoints;
    m.points.push_back(object_start_ + guidance_.center +
                       guidance_.radius * Vector3(std::cos(angle), std::sin(angle), 0));
  }
  return m;
}

std::vector<RosPublication> RosTopics::Publish(const TickRecord& r, RosDialect dialect,
                                               std::uint32_t sec, std::uint32_t nanosec) const {
  std::vector<RosPublication> out;
  const RosHeader header{static_cast<std::uint32_t>(r.tick), sec, nanosec, "world"};
  const auto add = [&](const std::string& name, auto&& message) {
    if constexpr (requires { message.header; }) message.header = header;
    out.push_back({Index(name), Serialise(message, dialect)});
  };
  const std::size_t dof = std::min<std::size_t>(r.cobot_dof, joints_.size());
  RosJointState joints;
  joints.name.assign(joints_.begin(), joints_.begin() + static_cast<std::ptrdiff_t>(dof));
  joints.position.assign(r.cobot_q.begin(), r.cobot_q.begin() + static_cast<std::ptrdiff_t>(dof));
  joints.velocity.assign(r.cobot_v.begin(), r.cobot_v.begin() + static_cast<std::ptrdiff_t>(dof));
  joints.effort.assign(r.cobot_torque.begin(),
                       r.cobot_torque.begin() + static_cast<std::ptrdiff_t>(dof));
  add("joint_states", joints);
  add("object/pose", RosPoseStamped{header, FromRecord(r.object.pose)});
  RosFloat64MultiArray tracking{"left, right", {0, 0}};
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& h = r.hands[i];
    if (!h.present) continue;
    const std::string handle = std::string(kHandNames[i]) + "_handle/";
    const Pose wanted = FromRecord(h.virtual_.pose), real = FromRecord(h.real.pose);
    add(handle + "pose", RosPoseStamped{header, wanted});
    add(handle + "real_pose", RosPoseStamped{header, real});
    add(handle + "wrench", RosWrenchStamped{header, Eigen::Map<const Vector6>(h.wrench.data())});
    add("markers", Arrow(r, i, false));
    add("markers", Arrow(r, i, true));
    tracking.data[i] = (real.p - wanted.p).norm();
  }
  if (guidance_.type == "circle") add("markers", Guidance());
  add("state", RosString{StateText(r)});
  add("tracking", tracking);
  return out;
}

}  // namespace predictor::ros_tcp
