// Loads the repository's scenarios.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenario/scenario_io.h"

namespace predictor {

inline const std::filesystem::path kScenarios =
    std::filesystem::path(PREDICTOR_SOURCE_DIR) / "scenarios";

// `name` is the name of the scenario's file.
inline Scenario Load(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return LoadScenario(kScenarios / name, overrides);
}

}  // namespace predictor
