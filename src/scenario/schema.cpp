#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "scenario/extend.h"
#include "scenario/field_walk.h"
#include "scenario/field_writer.h"
#include "scenario/machine_fields.h"
#include "scenario/scenario_io.h"
#include "scenario/yaml_scalar.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

// `node` must come from Write, because its numbers are then valid in JSON.
Json ToJson(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kNull) return nullptr;
  if (node.kind == YamlNode::Kind::kScalar) {
    if (KindOf(node) == ScalarKind::kString) return node.text;
    return Json::parse(node.text);
  }
  Json json = node.kind == YamlNode::Kind::kList ? Json::array() : Json::object();
  for (const YamlNode& item : node.items) {
    if (json.is_array()) {
      json.push_back(ToJson(item));
    } else {
      json[item.key] = ToJson(item);
    }
  }
  return json;
}

Json NumberSchema(const Rule& rule, const char* type = "number") {
  Json schema = {{"type", type}};
  if (!rule.steps.empty()) return {{"enum", rule.steps}};
  schema[rule.range.excludes_low ? "exclusiveMinimum" : "minimum"] = rule.range.low;
  schema["maximum"] = rule.range.high;
  const bool takes_lengths = rule.unit == kAngleOrLength;
  if (rule.unit != "rad" && !takes_lengths) return schema;
  const std::string sign = rule.range.low < 0 ? "^[+-]?" : "^[+]?";
  const Json degrees = {{"type", "string"},
                        {"pattern", sign + R"(([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?)" +
                                        (takes_lengths ? " (deg|m)$" : " deg$")}};
  return {{"anyOf", Json::array({schema, degrees})}};
}

Json ListSchema(const Json& each, std::size_t least, std::size_t most) {
  return {{"type", "array"}, {"items", each}, {"minItems", least}, {"maxItems", most}};
}

Json WordSchema(const Rule& rule) {
  Json schema = {{"type", "string"}};
  if (!rule.choices.empty()) schema["enum"] = rule.choices;
  if (rule.required) schema["minLength"] = 1;
  return schema;
}

// Schemas of single values, by their type.
Json SchemaOf(const Rule& rule, const double&) { return NumberSchema(rule); }
Json SchemaOf(const Rule& rule, const int&) { return NumberSchema(rule, "integer"); }
Json SchemaOf(const Rule&, const std::uint64_t&) {
  return {{"type", "integer"}, {"minimum", 0}, {"maximum", UINT64_MAX}};
}
Json SchemaOf(const Rule&, const bool&) { return {{"type", "boolean"}}; }
Json SchemaOf(const Rule& rule, const std::string&) { return WordSchema(rule); }
Json SchemaOf(const Rule& rule, const Vector3&) { return ListSchema(NumberSchema(rule), 3, 3); }
template <std::size_t N>
Json SchemaOf(const Rule& rule, const std::array<double, N>&) {
  return ListSchema(NumberSchema(rule), N, N);
}
Json SchemaOf(const Rule& rule, const std::vector<double>&) {
  const Json list = ListSchema(NumberSchema(rule), rule.least, rule.most);
  return rule.one_for_all ? Json{{"anyOf", {NumberSchema(rule), list}}} : list;
}
Json SchemaOf(const Rule& rule, const std::vector<std::string>&) {
  return ListSchema(WordSchema(rule), rule.least, rule.most);
}
Json SchemaOf(const Rule& rule, const std::vector<std::array<std::string, 2>>&) {
  return ListSchema(ListSchema(WordSchema(rule), 2, 2), rule.least, rule.most);
}

void AddDefaults(const YamlNode& defaults, Json* schema);

// Describes the members of a struct as properties of an object.
class Describer {
 public:
  template <class T>
  void operator()(const char* key, T& member, const Rule& rule) {
    Json schema = SchemaOfMember(rule, member);
    schema["description"] = rule.unit.empty() ? rule.doc : "[" + rule.unit + "] " + rule.doc;
    Add(key, std::move(schema), rule.required);
  }

  template <class Walk>
  void Group(const char* key, const char* doc, Walk walk) {
    Describer group;
    walk(group);
    Json schema = group.Object();
    schema["description"] = doc;
    Add(key, std::move(schema), false);
  }

  // Writes one alternative per kind. Each alternative contains only the parameters of its kind.
  template <class Walk>
  void Own(const char* key, std::string& type, YamlNode&, const Rule& rule, ParameterKinds kinds,
           Walk common) {
    for (const ParameterKind* kind : kinds) {
      const std::unique_ptr<OwnParameters> parameters = kind->parameters();
      Describer one;
      AnyVisitor visitor(&one);
      one(key, type, Word(rule.doc, {kind->name}));
      common(one);
      parameters->Walk(visitor);
      const bool is_default = type == kind->name && !rule.required;
      if (!is_default) one.required_.push_back(key);
      Json schema = {{"title", kind->name}, {"description", kind->doc}};
      schema.update(one.Object());
      YamlNode defaults = WriteParameters(parameters.get());
      FieldWriter writer(&defaults);
      common(writer);
      AddDefaults(defaults, &schema);
      if (is_default) schema["properties"][key]["default"] = type;
      kinds_.push_back(std::move(schema));
    }
  }

  Json Object() const {
    if (!kinds_.empty()) return {{"anyOf", kinds_}};
    Json object = {
        {"type", "object"}, {"additionalProperties", false}, {"properties", properties_}};
    if (!required_.empty()) object["required"] = required_;
    return object;
  }

 private:
  template <class T>
  static Json SchemaOfMember(const Rule& rule, T& member) {
    if constexpr (IsStruct<T, Describer>) {
      return SchemaOfPart(member);
    } else if constexpr (IsOptional<T>) {
      typename T::value_type value{};
      const Json absent = rule.absent == "null" ? Json{{"type", "null"}}
                                                : Json{{"enum", Json::array({rule.absent})}};
      return {{"anyOf", Json::array({absent, SchemaOfEach(rule, value)})}};
    } else if constexpr (IsStructList<T, Describer>) {
      typename T::value_type value{};
      return ListSchema(SchemaOfEach(rule, value), rule.least, rule.most);
    } else if constexpr (std::is_enum_v<T>) {
      return WordSchema(WordRule<T>(rule));
    } else {
      return SchemaOf(rule, member);
    }
  }

  template <class T>
  static Json SchemaOfPart(T& member) {
    Describer part;
    Fields(part, member);
    return part.Object();
  }

  // Schema of a value that is absent by default or may occur any number of times. Its parts have
  // defaults.
  template <class T>
  static Json SchemaOfEach(const Rule& rule, T& value) {
    Json schema = SchemaOfMember(rule, value);
    if constexpr (IsStruct<T, Describer>) AddDefaults(WriteStruct(value), &schema);
    return schema;
  }

  // A group is also required if one of its members is required.
  void Add(const char* key, Json schema, bool required) {
    if (required || schema.contains("required")) required_.push_back(key);
    properties_[key] = std::move(schema);
  }

  Json properties_ = Json::object();
  Json required_ = Json::array();
  Json kinds_ = Json::array();  // alternatives to this object
};

// Adds the default to every property that has one. `defaults` is the tree of a default struct.
void AddDefaults(const YamlNode& defaults, Json* schema) {
  if (!schema->contains("properties")) return;  // each kind has its own defaults
  for (auto& [key, property] : (*schema)["properties"].items()) {
    const YamlNode* value = defaults.Find(key);
    if (value == nullptr) continue;
    if (property.contains("properties")) {
      AddDefaults(*value, &property);
    } else if (property.contains("anyOf") && property["anyOf"][0].contains("properties")) {
      continue;  // each kind has its own defaults
    } else if (!schema->contains("required") ||
               !std::count((*schema)["required"].begin(), (*schema)["required"].end(), key)) {
      property["default"] = ToJson(*value);
    }
  }
}

// Removes the requirements from a schema and returns them as a separate schema. Entries of lists
// keep their requirements, because a list is always written completely.
Json TakeRequirements(Json* schema) {
  Json taken = Json::object();
  if (schema->contains("required")) {
    taken["required"] = (*schema)["required"];
    schema->erase("required");
  }
  if (schema->contains("properties")) {
    for (auto& [key, property] : (*schema)["properties"].items()) {
      Json inner = TakeRequirements(&property);
      if (!inner.empty()) taken["properties"][key] = std::move(inner);
    }
  }
  if (schema->contains("anyOf")) {
    Json choices = Json::array();
    bool any = false;
    for (Json& choice : (*schema)["anyOf"]) {
      Json inner = TakeRequirements(&choice);
      any |= !inner.empty();
      // Otherwise, the keys of an alternative with requirements would be accepted even if the
      // requirements are not met.
      if (inner.empty() && choice.contains("properties")) {
        for (const auto& item : choice["properties"].items())
          inner["properties"][item.key()] = Json::object();
        inner["additionalProperties"] = false;
      }
      if (choice.contains("title"))  // a kind: what it requires does not hold for the others
        inner["properties"]["type"]["enum"] = choice["properties"]["type"]["enum"];
      for (const char* kind : {"type", "enum"})
        if (choice.contains(kind)) inner[kind] = choice[kind];
      choices.push_back(std::move(inner));
    }
    if (any) taken["anyOf"] = std::move(choices);
  }
  return taken;
}

// Schema of a whole file, which is itself the default value. `name` identifies the schema.
template <class T>
Json SchemaOfFile(const std::string& name, const char* title, T file) {
  Describer describer;
  Fields(describer, file);
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"$id", "urn:predictor:schema:" + name},
                 {"title", title}};
  schema.update(describer.Object());
  AddDefaults(WriteStruct(file), &schema);
  return schema;
}

}  // namespace

std::string ScenarioSchema() {
  Json schema = SchemaOfFile("scenario", "Scenario of PREDICTOR", Scenario());
  // Requirements of the loader that a schema can express.
  schema["required"].push_back("object");
  schema["required"].push_back("handles");
  schema["properties"]["handles"]["minProperties"] = 1;
  Json whole = TakeRequirements(&schema);
  schema["properties"][kExtendsKey] = {
      {"type", "string"},
      {"minLength", 1},
      {"description",
       "scenario whose keys apply where this file gives none; in this folder or below"}};
  schema["anyOf"] = Json::array({{{"required", {kExtendsKey}}}, std::move(whole)});
  return schema.dump(2) + "\n";
}

std::string MachineSchema() {
  Json schema = SchemaOfFile("machine", "Machine file of PREDICTOR", Machine());
  schema["required"].push_back("arms");
  schema["properties"]["arms"]["minProperties"] = 1;
  return schema.dump(2) + "\n";
}

}  // namespace predictor
