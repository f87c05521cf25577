#include "scenario/own_parameters.h"

#include <algorithm>
#include <string_view>

#include "scenario/field_reader.h"
#include "scenario/field_writer.h"

namespace predictor {
namespace {

constinit ParameterKinds declared_controllers;
constinit ParameterKinds declared_hazards;
constinit ParameterKinds declared_rendering_parts;

bool Has(const ParameterKind& kind, const std::string& key) {
  return WriteParameters(kind.parameters().get()).Find(key) != nullptr;
}

}  // namespace

std::vector<std::string> NamesOf(ParameterKinds kinds) {
  std::vector<std::string> names;
  for (const ParameterKind* kind : kinds) names.emplace_back(kind->name);
  return names;
}

const ParameterKind* FindKind(ParameterKinds kinds, const std::string& name) noexcept {
  for (const ParameterKind* kind : kinds)
    if (name == std::string_view(kind->name)) return kind;
  return nullptr;
}

std::vector<std::string> OthersWith(const std::string& key, const ParameterKind& kind,
                                    ParameterKinds kinds) {
  std::vector<std::string> names;
  for (const ParameterKind* other : kinds)
    if (other != &kind && Has(*other, key)) names.emplace_back(other->name);
  return names;
}

std::unique_ptr<OwnParameters> ReadParameters(const ParameterKind& kind, const PathNode& at,
                                              Problems* problems) {
  std::unique_ptr<OwnParameters> parameters = kind.parameters();
  FieldReader(at, problems).ReadAll([&](FieldReader& reader) {
    AnyVisitor visitor(&reader);
    parameters->Walk(visitor);
  });
  return parameters;
}

YamlNode WriteParameters(OwnParameters* parameters) {
  YamlNode tree;
  FieldWriter writer(&tree);
  AnyVisitor visitor(&writer);
  parameters->Walk(visitor);
  return tree;
}

YamlNode CompleteParameters(ParameterKinds kinds, const std::string& type, const YamlNode& given) {
  const ParameterKind* kind = FindKind(kinds, type);
  if (kind == nullptr) return given;
  Problems problems;
  const auto parameters = ReadParameters(*kind, {given, ""}, &problems);
  return problems.empty() ? WriteParameters(parameters.get()) : given;
}

bool RemoveForeignParameters(const KindGroup& group) {
  const YamlNode* word = group.group->Find(group.key);
  const ParameterKind* kind = word ? FindKind(group.kinds, word->text) : nullptr;
  if (kind == nullptr) return false;
  return std::erase_if(group.group->items, [&](const YamlNode& item) {
           const bool is_in_file = item.key_place.line > 0;
           return is_in_file && !Has(*kind, item.key) &&
                  !OthersWith(item.key, *kind, group.kinds).empty();
         }) > 0;
}

std::unique_ptr<OwnParameters> ParametersOfPart(const ParameterKind& part, const YamlNode& all,
                                                const std::string& path, Problems* problems) {
  const YamlNode nothing;
  const YamlNode* group = all.Find(part.name);
  return ReadParameters(part, {group ? *group : nothing, path + "." + part.name}, problems);
}

void SetPart(const ParameterKind& part, OwnParameters* parameters, YamlNode* all) {
  all->kind = YamlNode::Kind::kMap;
  YamlNode* group = all->Find(part.name);
  if (group == nullptr) group = &all->items.emplace_back();
  *group = WriteParameters(parameters);
  group->key = part.name;
}

ParameterKinds Controllers() noexcept { return declared_controllers; }
void DeclareControllers(ParameterKinds kinds) noexcept { declared_controllers = kinds; }

ParameterKinds Hazards() noexcept { return declared_hazards; }
void DeclareHazards(ParameterKinds kinds) noexcept { declared_hazards = kinds; }

ParameterKinds RenderingParts() noexcept { return declared_rendering_parts; }
void DeclareRenderingParts(ParameterKinds parts) noexcept { declared_rendering_parts = parts; }

}  // namespace predictor
