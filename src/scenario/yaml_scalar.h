// YAML scalars according to the core schema of YAML 1.2, restricted to rules that older readers
// share.
#pragma once

#include <string>

#include "scenario/yaml_tree.h"

namespace predictor {

enum class ScalarKind { kString, kBool, kNumber };

// Returns a scalar's kind. "inf" and "nan" in any spelling count as numbers, so that error messages
// can name them.
ScalarKind KindOf(const YamlNode& scalar);

// Reads the number that the whole text (decimal) represents, which may be infinite or NaN. Returns
// false if the text is not a number.
bool ReadNumber(const std::string& text, double* number);

// Returns the number as YAML that every reader interprets as a number of the same type
// (floating-point or whole).
std::string WriteNumber(double number);

// Returns the text as a double-quoted scalar.
std::string QuoteYaml(const std::string& text);

}  // namespace predictor
