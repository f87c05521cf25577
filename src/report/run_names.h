// Short names that distinguish the runs in one page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

struct NamedRun {
  std::filesystem::path file;
  std::string condition;  // the run's label "condition"; may be empty
};

// Returns a distinct name for each run. The name is the run's condition if the conditions are short
// and distinguish the runs. Otherwise, the name is the file name with as many of its folders as are
// needed to distinguish the runs. The part that all names have in common is omitted.
std::vector<std::string> ShortNames(const std::vector<NamedRun>& runs);

}  // namespace predictor
