#include "scenario/differences.h"

#include <algorithm>
#include <utility>

#include "scenario/scenario_io.h"

namespace predictor {
namespace {

using KeyValues = std::vector<std::pair<std::string, std::string>>;  // key, value

// Returns the value in one line.
std::string InOneLine(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kNull) return "null";
  if (node.kind == YamlNode::Kind::kScalar) return node.text;
  const bool map = node.kind == YamlNode::Kind::kMap;
  std::string text;
  for (const YamlNode& item : node.items) {
    if (!text.empty()) text += ", ";
    text += (map ? item.key + ": " : "") + InOneLine(item);
  }
  return map ? "{" + text + "}" : "[" + text + "]";
}

// Appends the values of the tree. A list is one value.
void AppendValues(const YamlNode& node, const std::string& key, KeyValues* values) {
  if (node.kind != YamlNode::Kind::kMap) {
    values->emplace_back(key, InOneLine(node));
    return;
  }
  for (const YamlNode& item : node.items)
    AppendValues(item, key.empty() ? item.key : key + "." + item.key, values);
}

KeyValues ValuesIn(const Scenario& scenario) {
  KeyValues values;
  AppendValues(ScenarioTree(scenario), "", &values);
  std::erase_if(values, [](const auto& value) { return value.first == "name"; });
  return values;
}

const std::string* Find(const KeyValues& values, const std::string& key) {
  const auto found = std::ranges::find(values, key, &KeyValues::value_type::first);
  return found == values.end() ? nullptr : &found->second;
}

}  // namespace

std::vector<KeyDifference> DifferentKeys(const Scenario& a, const Scenario& b) {
  const KeyValues of_a = ValuesIn(a), of_b = ValuesIn(b);
  std::vector<KeyDifference> different;
  for (const auto& [key, value] : of_a) {
    const std::string* other = Find(of_b, key);
    if (!other || *other != value) different.push_back({key, value, other ? *other : ""});
  }
  for (const auto& [key, value] : of_b)
    if (!Find(of_a, key)) different.push_back({key, "", value});
  return different;
}

}  // namespace predictor
