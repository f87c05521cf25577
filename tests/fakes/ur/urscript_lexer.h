// Splits URScript into tokens.
#pragma once

#include <string>
#include <vector>

namespace predictor::urscript {

struct Token {
  enum class Kind { kName, kKeyword, kNumber, kString, kSymbol, kNewline, kEnd } kind;
  std::string text;
  int line;
};

// The tokens end with a newline and kEnd. Throws Error.
std::vector<Token> Tokens(const std::string& text);

}  // namespace predictor::urscript
