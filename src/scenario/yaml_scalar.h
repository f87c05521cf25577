// YAML scalars according to the core schema of YAML 1.2, restricted to rules that older readers
// share.
#pragma once

#include <string>

#include "scenario/yaml_tree.h"

namespace predictor {

enum class ScalarKind { kString, kBool, kNumber };

// Kind of a scalar node. "inf" and "nan" in any spelling count as numbers, so errors name them.
ScalarKind KindOf(const YamlNode& scalar);

// The number that the whole text (decimal) represents; may be infinite or NaN. Returns false if the
// text is not a number.
bool ReadNumber(const std::string& text, double* number);

// The number as YAML that every reader interprets as a floating-point or whole number.
std::string WriteNumber(double number);

// The text as a double-quoted scalar.
std::string QuoteYaml(const std::string& text);

}  // namespace predictor
