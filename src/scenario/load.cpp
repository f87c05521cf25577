#include <memory>
#include <utility>

#include "core/error.h"
#include "scenario/checks.h"
#include "scenario/field_reader.h"
#include "scenario/scenario_io.h"
#include "scenario/scenario_tree.h"

namespace predictor {

namespace fs = std::filesystem;

Scenario ReadFields(const YamlNode& root, Problems* problems) {
  return ReadStruct<Scenario>(root, problems);
}

Scenario ParseScenario(const std::string& text, const std::string& name, const fs::path& folder,
                       const std::vector<std::string>& overrides) {
  YamlNode root = ParseYaml(text, name);
  if (root.kind != YamlNode::Kind::kMap) {
    throw InputError(root.place.Text(), "a scenario is a group of keys, and this is " +
                                            Describe(root) + ". Begin with \"predictor: 1\".");
  }
  for (const std::string& assignment : overrides) ApplyOverride(assignment, &root);
  Problems problems;
  Scenario scenario = ReadFields(root, &problems);
  problems.ThrowIfAny();  // contradictions are looked for between good values only
  CheckScenario(scenario, root, &problems);
  problems.ThrowIfAny();
  scenario.file = folder / fs::path(name).filename();
  scenario.tree = std::make_shared<const YamlNode>(std::move(root));
  return scenario;
}

Scenario LoadScenario(const fs::path& file, const std::vector<std::string>& overrides) {
  Scenario scenario =
      ParseScenario(ReadYamlText(file, "a scenario"), file.string(), file.parent_path(), overrides);
  scenario.file = file;
  return scenario;
}

}  // namespace predictor
