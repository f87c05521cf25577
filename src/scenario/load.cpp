#include <memory>
#include <utility>

#include "core/error.h"
#include "scenario/checks.h"
#include "scenario/extend.h"
#include "scenario/field_reader.h"
#include "scenario/field_writer.h"
#include "scenario/formulation.h"
#include "scenario/kind_groups.h"
#include "scenario/scenario_io.h"
#include "scenario/trajectory_file.h"

namespace predictor {

namespace fs = std::filesystem;

Scenario ReadFields(const YamlNode& root, Problems* problems) {
  return ReadStruct<Scenario>(root, problems);
}

YamlNode ScenarioTree(const Scenario& scenario) { return WriteStruct(scenario); }

std::string SaveScenario(const Scenario& scenario) { return WriteYaml(ScenarioTree(scenario)); }

namespace {

YamlNode ParseRoot(const std::string& text, const std::string& name) {
  YamlNode root = ParseYaml(text, name);
  if (root.kind != YamlNode::Kind::kMap) {
    throw InputError(root.place.Text(), "a scenario must be a group of keys, but this is " +
                                            Describe(root) + ". Begin with \"predictor: 1\".");
  }
  return root;
}

// An override that selects another kind removes the parameters of the former kind. A file that
// selects another kind than the file that it extends does the same.
void ApplyToScenario(const std::string& assignment, YamlNode* root) {
  ApplyOverride(assignment, root);
  for (const KindGroup& group : KindGroups(root))
    if (assignment.starts_with(group.path + "." + group.key + "=")) RemoveForeignParameters(group);
}

Scenario FromTree(YamlNode root, const fs::path& folder,
                  const std::vector<std::string>& overrides) {
  for (const std::string& assignment : overrides) ApplyToScenario(assignment, &root);
  ExpandTrajectoryFile(folder, &root);
  Problems problems;
  Scenario scenario = ReadFields(root, &problems);
  problems.ThrowIfAny();  // contradictions are checked only between valid values
  CheckScenario(scenario, root, &problems);
  problems.ThrowIfAny();
  ApplyFormulation(&scenario);
  scenario.tree = std::make_shared<const YamlNode>(std::move(root));
  return scenario;
}

}  // namespace

Scenario ParseScenario(const std::string& text, const std::string& name, const fs::path& folder,
                       const std::vector<std::string>& overrides) {
  YamlNode root = ParseRoot(text, name);
  if (const YamlNode* extends = root.Find(kExtendsKey)) {
    throw InputError(extends->key_place.Text(),
                     "extends is supported in files only. This text must be a complete scenario.");
  }
  Scenario scenario = FromTree(std::move(root), folder, overrides);
  scenario.file = folder / fs::path(name).filename();
  return scenario;
}

Scenario LoadScenario(const fs::path& file, const std::vector<std::string>& overrides) {
  YamlNode root = ParseRoot(ReadYamlText(file, "a scenario"), file.string());
  ExtendTree(file, &root);
  Scenario scenario = FromTree(std::move(root), file.parent_path(), overrides);
  scenario.file = file;
  return scenario;
}

}  // namespace predictor
