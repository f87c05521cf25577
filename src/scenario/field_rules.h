// The rules for the value of a scenario's key, which state its unit, meaning and permitted values.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace predictor {

// An interval of numbers. The range may exclude its lower end.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool excludes_low = false;

  bool Contains(double x) const {  // false for NaN
    return (excludes_low ? x > low : x >= low) && x <= high;
  }
};

inline Range From(double low, double high) { return {low, high, false}; }
inline Range Above(double low, double high) { return {low, high, true}; }
inline Range Within(double most) { return {-most, most, false}; }

// The unit of the position of a joint that may turn or slide.
inline constexpr const char* kAngleOrLength = "rad or m";

inline constexpr double kFullTurn = 6.2832;  // [rad], rounded up

// The following functions make rules. The type of the field determines which members apply.
struct Rule {
  std::string unit = {};  // "" for pure numbers and words
  std::string doc = {};
  Range range = {};                       // range of a number, or of each number of a list
  std::vector<double> steps = {};         // the only permitted numbers; empty: the whole range
  std::vector<std::string> choices = {};  // the only permitted words; empty: all
  std::size_t least = 0, most = 64;       // entries of a list
  bool one_for_all = false;     // a single number stands for a list of one; otherwise the list has
                                // `most` entries
  bool required = false;        // has no default
  std::string absent = "null";  // text that represents a missing optional value
};

inline Rule Number(std::string unit, std::string doc, Range range) {
  return {.unit = std::move(unit), .doc = std::move(doc), .range = range};
}
inline Rule Word(std::string doc, std::vector<std::string> choices = {}) {
  return {.doc = std::move(doc), .choices = std::move(choices)};
}
inline Rule Flag(std::string doc) { return {.doc = std::move(doc)}; }
inline Rule Part(std::string doc) { return {.doc = std::move(doc)}; }
inline Rule List(Rule each, std::size_t least, std::size_t most) {
  each.least = least;
  each.most = most;
  return each;
}
// Accepts a single number for all entries, or a list of numbers.
inline Rule OneOrList(Rule each, std::size_t least, std::size_t most) {
  each = List(std::move(each), least, most);
  each.one_for_all = true;
  return each;
}
inline Rule Required(Rule rule) {
  rule.required = true;
  return rule;
}
inline Rule AbsentAs(std::string word, Rule rule) {
  rule.absent = std::move(word);
  return rule;
}

}  // namespace predictor
