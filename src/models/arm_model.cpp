#include "models/arm_model.h"

#include "core/error.h"
#include "core/text.h"
#include "scenario/field_rules.h"

namespace predictor {
namespace {

void CheckLink(const RobotModel& model, const std::string& link, const std::string& key) {
  try {
    (void)model.Frame(link);
  } catch (const InputError& error) {
    throw error.Within(key);
  }
}

// Returns the units of the joints' positions: "rad", or "rad or m".
std::string UnitsOf(const RobotModel& model) {
  for (int j = 0; j < model.dof(); ++j)
    if (model.is_prismatic(j)) return kAngleOrLength;
  return "rad";
}

}  // namespace

JointVector PostureOf(const std::vector<double>& posture, const RobotModel& model,
                      const std::string& key) {
  if (static_cast<int>(posture.size()) != model.dof())
    throw InputError::At(key, key + " has " + std::to_string(posture.size()) +
                                  " values; the arm has " + std::to_string(model.dof()) +
                                  " joints. Give one value per joint in " + UnitsOf(model) + ".");
  const JointVector q = Eigen::Map<const Eigen::VectorXd>(posture.data(), model.dof());
  for (int j = 0; j < model.dof(); ++j) {
    const double lower = model.position_lower()[j], upper = model.position_upper()[j];
    if (q[j] >= lower && q[j] <= upper) continue;
    const std::string entry = key + "." + std::to_string(j);
    const std::string unit = std::string(" ") + model.position_unit(j);
    std::string sentence = entry + ": joint " + Quote(model.joint_name(j)) + " at ";
    sentence.append(FormatNumber(q[j])).append(unit).append(" is outside its limits, ");
    sentence.append(FormatNumber(lower)).append(" to ").append(FormatNumber(upper)).append(unit);
    sentence += ". Give a value within the limits.";
    if (!model.is_prismatic(j)) sentence += DegreesHint(q[j], lower, upper);
    throw InputError::At(entry, sentence);
  }
  return q;
}

std::shared_ptr<const RobotModel> LoadCobotModel(const Scenario& scenario) {
  const CobotSpec& cobot = scenario.cobot;
  return RobotModel::Load(
      {cobot.model, scenario.folder(), cobot.remove_links, cobot.base.ToPose(), "cobot"});
}

JointVector EffortLimit(const CobotSpec& spec, const RobotModel& robot) {
  if (spec.effort_limit.empty()) return robot.effort_limit();
  const int size = static_cast<int>(spec.effort_limit.size());
  if (size != 1 && size != robot.dof()) {
    throw InputError::At("cobot.effort_limit",
                         "cobot.effort_limit has " + std::to_string(size) +
                             " values. Give none to use the model's, one for all joints, or " +
                             std::to_string(robot.dof()) + ".");
  }
  JointVector limit(robot.dof());
  for (int j = 0; j < robot.dof(); ++j) limit[j] = OneOrEach(spec.effort_limit, j);
  return limit;
}

std::vector<bool> PrismaticJoints(const Scenario& scenario) {
  const auto model = LoadCobotModel(scenario);
  std::vector<bool> prismatic;
  for (int j = 0; j < model->dof(); ++j) prismatic.push_back(model->is_prismatic(j));
  return prismatic;
}

void CheckPostureUnits(const YamlNode& tree, const RobotModel& model, const std::string& key) {
  for (int j = 0; j < model.dof(); ++j) {
    const std::string entry = key + "." + std::to_string(j);
    const YamlNode* node = NodeAt(entry, tree);
    if (node == nullptr) return;
    const bool is_prismatic = model.is_prismatic(j);
    if (!node->text.ends_with(is_prismatic ? " deg" : " m")) continue;
    throw InputError::At(entry, entry + " is " + Quote(node->text) + ", but joint " +
                                    Quote(model.joint_name(j)) +
                                    (is_prismatic ? " slides. Give its position in m."
                                                  : " turns. Give its angle in rad or deg."));
  }
}

std::shared_ptr<const RobotModel> LoadArmModel(const ArmSpec& spec, const Pose& base,
                                               const std::filesystem::path& folder,
                                               const std::string& key) {
  auto model = RobotModel::Load({spec.model, folder, spec.remove_links, base, key});
  if (model->dof() > kMaxArmJoints)
    throw InputError::At(key + ".model", key + ".model has " + std::to_string(model->dof()) +
                                             " joints; at most " + std::to_string(kMaxArmJoints) +
                                             " are possible. Remove links or choose another arm.");
  for (int j = 0; j < model->dof(); ++j)
    if (model->is_prismatic(j))
      throw InputError::At(key + ".model",
                           key + ".model: joint " + Quote(model->joint_name(j)) +
                               " is prismatic, but the joints of a haptic arm must be revolute, "
                               "because their limits and errors are angles. Make the joint fixed "
                               "in the URDF, or remove its link with remove_links.");
  CheckLink(*model, spec.end_effector, key + ".end_effector");
  if (!spec.elbow.empty()) CheckLink(*model, spec.elbow, key + ".elbow");
  if (!spec.posture.empty()) PostureOf(spec.posture, *model, key + ".posture");
  return model;
}

}  // namespace predictor
