// Collects what is wrong with a scenario, so that a person sees several errors at once.
#pragma once

#include <string>
#include <vector>

#include "scenario/yaml_tree.h"

namespace predictor {

class Problems {
 public:
  static constexpr std::size_t kMost = 10;  // that are told

  void Add(const Place& place, const std::string& sentence);
  bool IsFull() const { return found_.size() == kMost; }  // more are counted only
  bool empty() const { return found_.empty(); }
  // Throws InputError with one line a problem, in the file's order; returns if there is none.
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
