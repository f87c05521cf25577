#include "scenario/actions/action.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "core/messages.h"
#include "core/text.h"

namespace predictor {

bool ActionKind::Uses(const std::string& key) const {
  return std::any_of(uses.begin(), uses.end(),
                     [&](const ActionParameter& p) { return p.key && key == p.key; });
}

std::vector<std::string> ActionNames() {
  std::vector<std::string> names;
  for (const ActionKind* kind : Actions()) names.emplace_back(kind->name);
  return names;
}

const ActionKind* FindAction(const std::string& name) noexcept {
  for (const ActionKind* kind : Actions())
    if (name == std::string_view(kind->name)) return kind;
  return nullptr;
}

std::unique_ptr<Action> MakeAction(const ActionSpec& spec, int index) {
  const std::string place = "operator.script[" + std::to_string(index) + "]";
  const ActionKind* kind = FindAction(spec.action);
  if (!kind)
    throw InputError(place, "There is no action " + Quote(spec.action) + ". " +
                                Suggestion(spec.action, ActionNames()));
  if (spec.hand != "both" && spec.hand != "left" && spec.hand != "right")
    throw InputError(place, "The hand must be left, right or both.");
  if (!(spec.duration > 0 && std::isfinite(spec.duration)))
    throw InputError(place, "The duration must be a positive number of seconds.");
  try {
    return kind->make(spec);
  } catch (const InputError& error) {
    throw InputError(place, error.what());
  }
}

std::string Instruction(const ActionSpec& action, int facing) {
  const ActionKind* kind = FindAction(action.action);
  return kind ? kind->sentence(action, facing) : std::string();
}

bool Concerns(const ActionSpec& spec, std::size_t hand) {
  return spec.hand == "both" || spec.hand == kHandNames[hand];
}

}  // namespace predictor
