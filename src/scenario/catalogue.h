// Lists the scenarios of a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

struct ScenarioTitle {
  std::string name;   // file name without .yaml
  std::string title;  // the name in the scenario
};

// Returns the loadable scenarios in `folder`, sorted by name, but at most a hundred.
std::vector<ScenarioTitle> ScenariosIn(const std::filesystem::path& folder);

}  // namespace predictor
