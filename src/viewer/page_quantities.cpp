// Writes the table of quantities as TypeScript.
#include <cctype>
#include <string>

#include "core/tick_fields.h"
#include "viewer/frame.h"

namespace predictor::viewer {
namespace {

// Converts "cause_hand" to "causeHand".
std::string CamelCase(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (!text.empty() && text.back() == '_')
      text.back() = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    else
      text += c;
  }
  return text;
}

struct TypeOf {
  const char *kind, *type;
};
TypeOf TypeScriptOf(FrameKind kind) {
  switch (kind) {
    case FrameKind::kNumber:
      return {"number", "number"};
    case FrameKind::kNumbers:
      return {"numbers", "number[]"};
    case FrameKind::kFlag:
      return {"flag", "boolean"};
    case FrameKind::kPose:
      return {"pose", "Pose"};
    case FrameKind::kPoses:
      return {"poses", "Pose[]"};
    case FrameKind::kState:
      return {"state", "RunState"};
    case FrameKind::kCause:
      return {"cause", "StopCause"};
    case FrameKind::kQuantity:
      return {"quantity", "Quantity"};
  }
  return {};
}

// Writes export const `list` = [...] and the union of its words as `type`.
template <class Name>
std::string Words(const char* list, const char* type, int count, Name&& name) {
  std::string text = std::string("export const ") + list + " = [";
  for (int k = 0; k < count; ++k)
    text += std::string(k % 6 == 0 ? "\n  " : " ") + "'" + name(k) + "',";
  text += "\n] as const;\n";
  if (*type) text += std::string("export type ") + type + " = (typeof " + list + ")[number];\n";
  return text + "\n";
}

// Returns the fields whose names begin with `prefix` as a TypeScript interface, together with their
// kinds.
std::string Fields(const char* name, const char* kinds, const std::string& prefix) {
  std::string types = std::string("export interface ") + name + " {\n";
  std::string table = std::string("export const ") + kinds + " = {\n";
  for (const FrameField& field : FrameFields()) {
    const bool of_hand = field.name.starts_with("left_") || field.name.starts_with("right_");
    if (prefix.empty() ? of_hand : !field.name.starts_with(prefix)) continue;
    const std::string rest = field.name.substr(prefix.size());
    const TypeOf type = TypeScriptOf(field.kind);
    types += "  " + CamelCase(rest) + ": " + type.type + ";" +
             (field.comment.empty() ? "" : "  // " + field.comment) + "\n";
    table += "  " + rest + ": ['" + CamelCase(rest) + "', '" + type.kind + "', '" + field.type +
             "', " + std::to_string(field.count) + "],\n";
  }
  return types + "}\n\n" + table + "} as const;\n";
}

}  // namespace

std::string PageQuantities() {
  const auto words = [](const char* const* names) { return [names](int k) { return names[k]; }; };
  return "// Generated from src/core/tick_fields.h: build/release/bin/page_quantities writes this "
         "file.\n\nimport type {Pose} from './pose';\n\n" +
         Words("kRunStates", "RunState", kRunStates,
               [](int k) { return Name(static_cast<RunState>(k)); }) +
         Words("kStopCauses", "StopCause", kStopCauses,
               [](int k) { return Name(static_cast<StopCause>(k)); }) +
         Words("kQuantities", "Quantity", kQuantities, words(kQuantityNames.data())) +
         Words("kStages", "", kStages, words(kStageNames.data())) +
         Words("kParameters", "ParameterName", kParameters,
               [](int k) { return Name(static_cast<Parameter>(k)); }) +
         Fields("RunQuantities", "kRunFields", "") + "\n" +
         Fields("HandQuantities", "kHandFields", "left_");
}

}  // namespace predictor::viewer
