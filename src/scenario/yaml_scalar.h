// What a YAML scalar is: YAML 1.2's core rules, narrowed to what older readers agree with.
#pragma once

#include <string>

#include "scenario/yaml_tree.h"

namespace predictor {

enum class ScalarKind { kString, kBool, kNumber };

// Kind of a scalar node. "inf" and "nan" in any spelling are numbers, so that they are refused by
// name.
ScalarKind KindOf(const YamlNode& scalar);

// The number that the whole text spells (decimal), may be infinite or NaN; false if it is none.
bool ReadNumber(const std::string& text, double* number);

// The number as YAML that every reader takes for a floating-point or whole number.
std::string WriteNumber(double number);

// The text as a double-quoted scalar.
std::string QuoteYaml(const std::string& text);

}  // namespace predictor
