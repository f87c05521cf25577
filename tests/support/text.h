// Helpers for tests of texts.
#pragma once

#include <string>

namespace predictor {

inline bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Returns a page without its script, because the script contains all words that any page may show.
inline std::string WithoutScript(const std::string& page) {
  return page.substr(0, page.rfind("<script>"));
}

}  // namespace predictor
