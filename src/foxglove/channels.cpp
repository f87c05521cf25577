// The topics for Foxglove. They use Foxglove's well-known schemas where such schemas exist. Topics
// of recorded quantities are derived from core/tick_fields.h. This file contains the topics that
// combine or compare quantities.
#include <cmath>
#include <utility>

#include "foxglove/json.h"
#include "models/robot.h"

namespace predictor {
namespace foxglove {

Json Time(std::uint64_t ns) { return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}}; }
Json Xyz(const Vector3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }
Json Xyz(const double* v) { return Xyz(Vector3(v[0], v[1], v[2])); }
Json PoseJson(const Pose& X) {
  return {{"position", Xyz(X.p)},
          {"orientation", {{"x", X.q.x()}, {"y", X.q.y()}, {"z", X.q.z()}, {"w", X.q.w()}}}};
}
Json Color(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

namespace {

double Live(const TickRecord& r, Parameter p) { return r.parameters[static_cast<std::size_t>(p)]; }

FoxgloveChannel JointStates(const Scenario& scenario) {
  const RobotSource source{scenario.cobot.model, scenario.file.parent_path(),
                           scenario.cobot.remove_links, scenario.cobot.base.ToPose()};
  const auto robot = RobotModel::Load(source);
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(robot->dof()));
  for (int j = 0; j < robot->dof(); ++j) names.push_back(robot->joint_name(j));
  return {"/joint_states", "foxglove.JointStates", JointStatesSchema(),
          [names](const TickRecord& r, std::uint64_t ns) {
            Json joints = Json::array();
            for (std::size_t j = 0; j < names.size(); ++j)
              joints.push_back({{"name", names[j]},
                                {"position", r.cobot_q[j]},
                                {"velocity", r.cobot_v[j]},
                                {"effort", r.cobot_torque[j]}});
            return Json{{"timestamp", Time(ns)}, {"joints", joints}};
          }};
}

// Publishes the wrench that the hand exerts on the handle in W [N], [N·m], and the active
// thresholds.
FoxgloveChannel WrenchOf(std::size_t h) {
  return {std::string("/wrench_") + kHandNames[h], "predictor.Wrench",
          Message("predictor.Wrench", {{"timestamp", TimeSchema()},
                                       {"frame_id", Text()},
                                       {"force", XyzSchema()},
                                       {"torque", XyzSchema()},
                                       {"force_norm", Number()},
                                       {"torque_norm", Number()},
                                       {"force_threshold", Number()},
                                       {"torque_threshold", Number()}}),
          [h](const TickRecord& r, std::uint64_t ns) {
            const double* w = r.hands[h].wrench.data();
            return Json{{"timestamp", Time(ns)},
                        {"frame_id", "world"},
                        {"force", Xyz(w)},
                        {"torque", Xyz(w + 3)},
                        {"force_norm", std::hypot(w[0], w[1], w[2])},
                        {"torque_norm", std::hypot(w[3], w[4], w[5])},
                        {"force_threshold", Live(r, Parameter::kForceThreshold)},
                        {"torque_threshold", Live(r, Parameter::kTorqueThreshold)}};
          }};
}

// Returns the errors of the real handles and the distance between the links of the nearest pair.
// Absent hands and pairs are omitted.
FoxgloveChannel Tracking(const Scenario& scenario) {
  const Json hand = Numbers({"translation_m", "rotation_rad"});
  const double threshold = scenario.safety.tracking;
  const double security_distance = scenario.rendering.security_distance;
  return {"/tracking", "predictor.Tracking",
          Message("predictor.Tracking",
                  {{"timestamp", TimeSchema()},
                   {"left", hand},
                   {"right", hand},
                   {"threshold_m", Number()},
                   {"link_distance_m", Number()},
                   {"security_distance_m", Number()}},
                  {"left", "right", "link_distance_m"}),
          [threshold, security_distance](const TickRecord& r, std::uint64_t ns) {
            Json message = {{"timestamp", Time(ns)}};
            for (std::size_t h = 0; h < kHands; ++h) {
              if (!r.hands[h].present) continue;
              const Vector6 error =
                  PoseError(FromRecord(r.hands[h].virtual_.pose), FromRecord(r.hands[h].real.pose));
              message[kHandNames[h]] = {{"translation_m", error.head<3>().norm()},
                                        {"rotation_rad", error.tail<3>().norm()}};
            }
            message["threshold_m"] = threshold;
            if (std::isfinite(r.link_distance)) message["link_distance_m"] = r.link_distance;
            message["security_distance_m"] = security_distance;
            return message;
          }};
}

}  // namespace
}  // namespace foxglove

std::vector<FoxgloveChannel> FoxgloveChannels(const Scenario& scenario,
                                              const Vector3& object_start) {
  std::vector<FoxgloveChannel> channels = {foxglove::TransformsChannel(scenario),
                                           foxglove::SceneChannel(scenario, object_start),
                                           foxglove::JointStates(scenario),
                                           foxglove::WrenchOf(0),
                                           foxglove::WrenchOf(1),
                                           foxglove::Tracking(scenario)};
  for (FoxgloveChannel& channel : foxglove::QuantityChannels())
    channels.push_back(std::move(channel));
  return channels;
}

std::vector<FoxgloveChannel> FoxgloveSceneChannels(const Scenario& scenario,
                                                   const Vector3& object_start) {
  return {foxglove::TransformsChannel(scenario), foxglove::SceneChannel(scenario, object_start)};
}

}  // namespace predictor
