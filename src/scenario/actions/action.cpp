#include "scenario/actions/action.h"

#include "core/error.h"
#include "core/messages.h"
#include "core/text.h"

namespace predictor {

const ActionKind* FindAction(const std::string& name) noexcept {
  return static_cast<const ActionKind*>(FindKind(Actions(), name));
}

std::unique_ptr<Action> MakeAction(const ActionSpec& spec, int index) {
  const std::string place = "operator.script." + std::to_string(index);
  const ActionKind* kind = FindAction(spec.action);
  if (!kind)
    throw InputError::At(place, place + ": There is no action " + Quote(spec.action) + ". " +
                                    Suggestion(spec.action, NamesOf(Actions())));
  Problems problems;
  const auto parameters = ReadParameters(*kind, {spec.parameters, place}, &problems);
  problems.ThrowIfAny();
  try {
    return kind->make(*parameters);
  } catch (const InputError& error) {
    throw error.Within(place);
  }
}

std::unique_ptr<OwnParameters> ParametersIn(const ActionSpec& spec, const ActionKind& kind) {
  Problems ignored;
  return ReadParameters(kind, {spec.parameters, ""}, &ignored);
}

std::string Instruction(const ActionSpec& spec, double facing) {
  const ActionKind* kind = FindAction(spec.action);
  return kind ? kind->sentence(*ParametersIn(spec, *kind), facing) : std::string();
}

Vector3 NotZero(const char* key, const Vector3& value) {
  if (value.isZero(0))
    throw InputError::At(
        key, std::string(key) + " is zero, so the action would do nothing. Give a value.");
  return value;
}

bool Concerns(const std::string& which, std::size_t hand) {
  return which == "both" || which == kHandNames[hand];
}

}  // namespace predictor
