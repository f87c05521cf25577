// Builds parts of a JSON Schema (draft-07) and JSON numbers that may be null. These functions are
// not for use in the tick.
#pragma once

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

namespace predictor {

// JSON has no infinity and no NaN. Therefore, a number that is not finite becomes null.
inline nlohmann::ordered_json NumberOrNull(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

namespace schema {

using Json = nlohmann::ordered_json;

inline constexpr const char* kDraft = "http://json-schema.org/draft-07/schema#";

// Returns the schema of a value that has one or several permitted types. The schema contains the
// meaning of the value for the reader.
inline Json Value(Json type, const std::string& meaning) {
  return {{"type", std::move(type)}, {"description", meaning}};
}

inline Json ValueOrNull(const char* type, const std::string& meaning) {
  return Value({type, "null"}, meaning);
}

// Returns the schema of an object that has all these properties.
inline Json Object(Json properties, const std::string& meaning) {
  Json required = Json::array();
  for (const auto& [key, value] : properties.items()) required.push_back(key);
  return {{"type", "object"},
          {"description", meaning},
          {"required", std::move(required)},
          {"properties", std::move(properties)}};
}

inline Json Array(Json items, const std::string& meaning) {
  return {{"type", "array"}, {"description", meaning}, {"items", std::move(items)}};
}

// The meaning of each key, and the list of keys whose value can be null although the value is not a
// number.
struct Words {
  std::map<std::string, const char*> meanings;
  std::set<std::string> can_miss;
};

// Returns the schema of `example`, which has every member. Lists are not empty. Floating-point
// numbers, and the keys in `can_miss`, can be null. `key` is the key of the example.
inline Json FromExample(const Json& example, const Words& words, const std::string& key = "") {
  Json schema;
  const bool can_miss =
      example.is_number_float() || example.is_null() || words.can_miss.contains(key);
  const auto type = [&](const char* name) { return can_miss ? Json({name, "null"}) : Json(name); };
  if (example.is_object()) {
    schema["type"] = type("object");
    schema["required"] = Json::array();
    for (const auto& [name, value] : example.items()) {
      schema["required"].push_back(name);
      schema["properties"][name] = FromExample(value, words, name);
    }
  } else if (example.is_array()) {
    schema["type"] = type("array");
    schema["items"] = FromExample(example.front(), words);
  } else {
    schema["type"] = type(example.is_string()           ? "string"
                          : example.is_number_integer() ? "integer"
                          : example.is_boolean()        ? "boolean"
                                                        : "number");
  }
  if (const auto meaning = words.meanings.find(key); meaning != words.meanings.end())
    schema["description"] = meaning->second;
  return schema;
}

}  // namespace schema
}  // namespace predictor
