#include "simulation/controller.h"

#include "core/error.h"
#include "core/text.h"
#include "simulation/controllers/controllers.h"
#include "simulation/taped_controller.h"

namespace predictor {
namespace {

#define PREDICTOR_ENTRY(kind) &controllers::kind,
constexpr const ParameterKind* kControllerKinds[] = {PREDICTOR_CONTROLLERS(PREDICTOR_ENTRY)};
#undef PREDICTOR_ENTRY

// The controllers are declared when the program starts, so that every scenario is read with their
// parameters.
[[maybe_unused]] const bool kDeclared = (DeclareControllers(kControllerKinds), true);

}  // namespace

std::unique_ptr<Controller> MakeController(const ControllerContext& context) {
  const ControllerSpec& spec = context.spec;
  const ParameterKind* kind = FindKind(kControllerKinds, spec.type);
  if (kind == nullptr)
    throw InputError("cobot.controller.type: there is no controller " + Quote(spec.type) + ". " +
                     Suggestion(spec.type, ControllerNames()));
  const bool is_outside = kind->place != ControllerPlace::kProgram;
  const int dof = context.model.dof();
  if (is_outside && context.tape) return std::make_unique<TapedController>(*context.tape, dof);
  Problems problems;
  const auto parameters = ReadParameters(*kind, {spec.parameters, "cobot.controller"}, &problems);
  problems.ThrowIfAny();
  auto controller = static_cast<const ControllerKind*>(kind)->make(context, *parameters);
  if (!is_outside) return controller;
  return std::make_unique<TapedController>(std::move(controller), dof);
}

std::vector<std::string> ControllerNames() { return NamesOf(kControllerKinds); }

JointVector PerJoint(const ControllerContext& context, const std::string& key,
                     const std::vector<double>& values) {
  const int size = static_cast<int>(values.size()), dof = context.model.dof();
  if (size != 1 && size != dof) {
    const std::string path = "cobot.controller." + key;
    throw InputError::At(path, path + " has " + std::to_string(size) +
                                   " values. Give one for all, or " + std::to_string(dof) + ".");
  }
  JointVector all(dof);
  for (int j = 0; j < dof; ++j) all[j] = OneOrEach(values, j);
  return all;
}

}  // namespace predictor
