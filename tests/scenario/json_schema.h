// A validator for the part of JSON Schema (draft-07) that the scenario schema uses. The validator
// is written from the specification, independently of the code under test. An unknown keyword is an
// error.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>

namespace predictor {

using Json = nlohmann::ordered_json;

inline bool HasType(const std::string& type, const Json& value) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  throw std::logic_error("unknown type " + type);
}

inline bool Validates(const Json& schema, const Json& value);

inline bool MeetsKeyword(const std::string& keyword, const Json& is, const Json& schema,
                         const Json& value) {
  const auto any = [&](auto good) { return std::any_of(is.begin(), is.end(), good); };
  if (keyword == "type") {
    return is.is_array() ? any([&](const Json& each) { return HasType(each, value); })
                         : HasType(is, value);
  }
  if (keyword == "enum") return any([&](const Json& each) { return each == value; });
  if (keyword == "anyOf") return any([&](const Json& each) { return Validates(each, value); });
  if (keyword == "minimum") return !value.is_number() || value >= is;
  if (keyword == "maximum") return !value.is_number() || value <= is;
  if (keyword == "exclusiveMinimum") return !value.is_number() || value > is;
  if (keyword == "minLength") return !value.is_string() || value.get<std::string>().size() >= is;
  if (keyword == "pattern")
    return !value.is_string() ||
           std::regex_search(value.get<std::string>(), std::regex(is.get<std::string>()));
  if (keyword == "minItems") return !value.is_array() || value.size() >= is;
  if (keyword == "maxItems") return !value.is_array() || value.size() <= is;
  if (keyword == "minProperties") return !value.is_object() || value.size() >= is;
  if (keyword == "items") {
    return !value.is_array() || std::all_of(value.begin(), value.end(),
                                            [&](const Json& each) { return Validates(is, each); });
  }
  if (keyword == "required") {
    return !value.is_object() || std::all_of(is.begin(), is.end(), [&](const Json& key) {
      return value.contains(key.get<std::string>());
    });
  }
  if (keyword == "properties") {
    if (!value.is_object()) return true;
    for (const auto& [key, property] : is.items()) {
      if (value.contains(key) && !Validates(property, value[key])) return false;
    }
    return true;
  }
  if (keyword == "additionalProperties") {
    if (is != false) throw std::logic_error("additionalProperties is not false");
    if (!value.is_object()) return true;
    for (const auto& [key, each] : value.items()) {
      if (!schema.at("properties").contains(key)) return false;
    }
    return true;
  }
  for (const char* comment : {"description", "default", "title", "$schema", "$id"}) {
    if (keyword == comment) return true;
  }
  throw std::logic_error("unknown keyword " + keyword);
}

inline bool Validates(const Json& schema, const Json& value) {
  for (const auto& [keyword, is] : schema.items()) {
    if (!MeetsKeyword(keyword, is, schema, value)) return false;
  }
  return true;
}

}  // namespace predictor
