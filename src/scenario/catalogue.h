// The scenarios of a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

struct ScenarioTitle {
  std::string name;   // of the file, without .yaml
  std::string title;  // what the scenario calls itself
};

// Those in `folder` that can be loaded, by name; at most a hundred.
std::vector<ScenarioTitle> ScenariosIn(const std::filesystem::path& folder);

}  // namespace predictor
