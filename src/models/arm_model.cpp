#include "models/arm_model.h"

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

void CheckLink(const RobotModel& model, const std::string& link, const std::string& key) {
  try {
    (void)model.Frame(link);
  } catch (const InputError& error) {
    throw error.Within(key);
  }
}

}  // namespace

JointVector PostureOf(const std::vector<double>& posture, const RobotModel& model,
                      const std::string& key) {
  if (static_cast<int>(posture.size()) != model.dof())
    throw InputError::At(key, key + " has " + std::to_string(posture.size()) +
                                  " values; the arm has " + std::to_string(model.dof()) +
                                  " joints. Give one value per joint in rad.");
  const JointVector q = Eigen::Map<const Eigen::VectorXd>(posture.data(), model.dof());
  for (int j = 0; j < model.dof(); ++j) {
    const double lower = model.position_lower()[j], upper = model.position_upper()[j];
    if (q[j] >= lower && q[j] <= upper) continue;
    const std::string entry = key + "." + std::to_string(j);
    throw InputError::At(entry, entry + ": joint " + Quote(model.joint_name(j)) + " at " +
                                    FormatNumber(q[j]) + " rad is outside its limits, " +
                                    FormatNumber(lower) + " to " + FormatNumber(upper) +
                                    " rad. Give a value within the limits." +
                                    DegreesHint(q[j], lower, upper));
  }
  return q;
}

std::shared_ptr<const RobotModel> LoadArmModel(const ArmSpec& spec, const Pose& base,
                                               const std::filesystem::path& folder,
                                               const std::string& key) {
  auto model = RobotModel::Load({spec.model, folder, spec.remove_links, base, key});
  if (model->dof() > kMaxArmJoints)
    throw InputError::At(key + ".model", key + ".model has " + std::to_string(model->dof()) +
                                             " joints; at most " + std::to_string(kMaxArmJoints) +
                                             " are possible. Remove links or choose another arm.");
  CheckLink(*model, spec.end_effector, key + ".end_effector");
  if (!spec.elbow.empty()) CheckLink(*model, spec.elbow, key + ".elbow");
  if (!spec.posture.empty()) PostureOf(spec.posture, *model, key + ".posture");
  return model;
}

}  // namespace predictor
