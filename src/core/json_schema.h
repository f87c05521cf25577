// Builds parts of a JSON Schema (draft-07) and JSON numbers that may be null. Not for use in the
// tick.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace predictor {

// JSON has no infinity and no NaN. A number that is not finite therefore becomes null.
inline nlohmann::ordered_json NumberOrNull(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

namespace schema {

using Json = nlohmann::ordered_json;

inline constexpr const char* kDraft = "http://json-schema.org/draft-07/schema#";

// Returns a value of a type (or of one of several), with its meaning for the reader.
inline Json Value(Json type, const std::string& meaning) {
  return {{"type", std::move(type)}, {"description", meaning}};
}

inline Json ValueOrNull(const char* type, const std::string& meaning) {
  return Value({type, "null"}, meaning);
}

// Returns an object that has all these properties.
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

}  // namespace schema
}  // namespace predictor
