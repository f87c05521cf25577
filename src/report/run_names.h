// Short names by which runs are told apart in one page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace predictor {

struct NamedRun {
  std::filesystem::path file;
  std::string condition;  // its label of that name; empty: none
};

// One of each, all of them different: the condition if that is short and tells the runs apart, else
// the file's name without what is common to all, with as many of its folders as it takes.
std::vector<std::string> ShortNames(const std::vector<NamedRun>& runs);

}  // namespace predictor
