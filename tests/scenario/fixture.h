// Shared helpers of the scenario tests.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "scenario/scenario_io.h"

namespace predictor {

inline const std::filesystem::path kData =
    std::filesystem::path(PREDICTOR_SOURCE_DIR) / "tests/scenario/data";

inline std::string ReadFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline std::string FixtureText() { return ReadFile(kData / "box_9kg.yaml"); }

inline Scenario Fixture(const std::vector<std::string>& overrides = {}) {
  return ParseScenario(FixtureText(), "box.yaml", kData, overrides);
}

// Returns the error that a text causes, or "" if it causes none.
inline std::string ErrorOf(const std::string& text,
                           const std::vector<std::string>& overrides = {}) {
  try {
    ParseScenario(text, "box.yaml", kData, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline std::string ErrorOfOverride(const std::string& assignment) {
  return ErrorOf(FixtureText(), {assignment});
}

}  // namespace predictor
