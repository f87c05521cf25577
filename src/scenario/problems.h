// Collects the problems of a scenario, so that the user sees several errors at once.
#pragma once

#include <string>
#include <vector>

#include "scenario/yaml_tree.h"

namespace predictor {

class Problems {
 public:
  static constexpr std::size_t kMaxReported = 10;  // maximum number of reported problems

  void Add(const Place& place, const std::string& sentence);
  bool IsFull() const {
    return found_.size() == kMaxReported;
  }  // further problems are only counted
  bool empty() const { return found_.empty(); }
  // Throws InputError with one line per problem, in the order of the file. Does nothing if there
  // are no problems.
  void ThrowIfAny();

 private:
  struct Problem {
    Place place;
    std::string sentence;
  };
  std::vector<Problem> found_;
  std::size_t count_ = 0;
};

}  // namespace predictor
