#include "simulation/controller.h"

#include "core/error.h"
#include "core/text.h"
#include "simulation/controllers/controllers.h"

namespace predictor {
namespace {

void CheckCount(const std::string& key, const std::vector<double>& values, int count) {
  const int size = static_cast<int>(values.size());
  if (size == 1 || size == count) return;
  throw InputError("cobot.controller." + key + " has " + std::to_string(size) +
                   " values. Give one for all, or " + std::to_string(count) + ".");
}

}  // namespace

std::unique_ptr<Controller> MakeController(const ControllerContext& context) {
  const ControllerSpec& spec = context.spec;
  CheckCount("damping_ratio", spec.damping_ratio, 6);
  CheckCount("joint_stiffness", spec.joint_stiffness, context.model.dof());
  CheckCount("joint_damping_ratio", spec.joint_damping_ratio, context.model.dof());
  for (const RegisteredController& controller : kControllers) {
    if (spec.type == controller.name) return controller.make(context);
  }
  throw InputError("cobot.controller.type: there is no controller " + Quote(spec.type) + ". " +
                   Suggestion(spec.type, ControllerNames()));
}

std::vector<std::string> ControllerNames() {
  std::vector<std::string> names;
  for (const RegisteredController& controller : kControllers) names.emplace_back(controller.name);
  return names;
}

}  // namespace predictor
