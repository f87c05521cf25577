// Readable names for parameterised tests.
#pragma once

#include <cctype>
#include <string>

namespace predictor::test {

// Returns `text` with each group of characters that GoogleTest does not allow in names replaced by
// an underscore.
inline std::string TestName(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

}  // namespace predictor::test
