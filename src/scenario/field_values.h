// Reads the value of a field from a node, and writes it to a node. If a value is invalid, each Read
// reports this to `problems` and leaves the member unchanged.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "scenario/field_rules.h"
#include "scenario/problems.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// A node together with its full key path ("cobot.base.xyz").
struct PathNode {
  const YamlNode& node;
  std::string path;
};

// ---- sentences
// -----------------------------------------------------------------------------------

// Returns, for example, "above 0 and at most 500 N".
std::string Allowed(const Rule& rule);
// Describes the content of a node for a message, such as 5, "word", a list of 2, a group, or
// nothing.
std::string Describe(const YamlNode& node);
// Reports a text of the form "safety.force is -3 N; it must be <must>.<hint>".
void Complain(const PathNode& at, const Rule& rule, const std::string& must, Problems* problems,
              const std::string& hint = "");

// ---- one value
// -----------------------------------------------------------------------------------

void Read(const PathNode& at, const Rule& rule, Problems* problems, double* value);
void Read(const PathNode& at, const Rule& rule, Problems* problems, int* value);
void Read(const PathNode& at, const Rule& rule, Problems* problems, std::uint64_t* value);
void Read(const PathNode& at, const Rule& rule, Problems* problems, bool* value);
void Read(const PathNode& at, const Rule& rule, Problems* problems, std::string* value);
// Reads exactly `count` numbers.
void ReadNumbers(const PathNode& at, const Rule& rule, std::size_t count, Problems* problems,
                 double* values);
void Read(const PathNode& at, const Rule& rule, Problems* problems, std::vector<double>* values);
void Read(const PathNode& at, const Rule& rule, Problems* problems,
          std::vector<std::string>* values);
void Read(const PathNode& at, const Rule& rule, Problems* problems,
          std::vector<std::array<std::string, 2>>* values);

inline void Read(const PathNode& at, const Rule& rule, Problems* problems, Vector3* value) {
  ReadNumbers(at, rule, 3, problems, value->data());
}
template <std::size_t N>
void Read(const PathNode& at, const Rule& rule, Problems* problems, std::array<double, N>* value) {
  ReadNumbers(at, rule, N, problems, value->data());
}

// Returns the entries of the list, or null after reporting that the node is not a list with a
// permitted number of entries.
const std::vector<YamlNode>* Entries(const PathNode& at, const Rule& rule, Problems* problems);

YamlNode Write(const Rule& rule, double value);
YamlNode Write(const Rule& rule, int value);
YamlNode Write(const Rule& rule, std::uint64_t value);
YamlNode Write(const Rule& rule, bool value);
YamlNode Write(const Rule& rule, const std::string& value);
YamlNode WriteNumbers(const double* values, std::size_t count);
YamlNode Write(const Rule& rule, const std::vector<double>& values);
YamlNode Write(const Rule& rule, const std::vector<std::string>& values);
YamlNode Write(const Rule& rule, const std::vector<std::array<std::string, 2>>& values);
inline YamlNode Write(const Rule&, const Vector3& value) { return WriteNumbers(value.data(), 3); }
template <std::size_t N>
YamlNode Write(const Rule&, const std::array<double, N>& value) {
  return WriteNumbers(value.data(), N);
}

}  // namespace predictor
