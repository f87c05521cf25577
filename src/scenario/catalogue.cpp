#include "scenario/catalogue.h"

#include <algorithm>

#include "core/error.h"
#include "scenario/scenario_io.h"

namespace predictor {

std::vector<ScenarioTitle> ScenariosIn(const std::filesystem::path& folder) {
  constexpr std::size_t kMaxFiles = 100;
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error))
    if (it->path().extension() == ".yaml") files.push_back(it->path());
  std::sort(files.begin(), files.end());
  files.resize(std::min(files.size(), kMaxFiles));
  std::vector<ScenarioTitle> titles;
  for (const std::filesystem::path& file : files) {
    try {
      titles.push_back({file.stem().string(), LoadScenario(file, {}).name});
    } catch (const InputError&) {
      continue;  // `predictor check` reports the reason
    }
  }
  return titles;
}

}  // namespace predictor
