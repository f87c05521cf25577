// Scenario <-> YAML, JSON Schema, and overrides from the command line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenario/problems.h"
#include "scenario/scenario.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// Reads and checks a scenario. `overrides` are "path.to.key=value" (value in YAML) and are applied
// before the checks. Throws InputError with file:line:column, the invalid value, the permitted
// values and the most similar key. The file may have at most 1 MiB. Aliases and anchors are
// refused. A file may extend another one by `extends` (extend.h).
Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides = {});

// Loads a scenario from text, which cannot extend a file. `name` replaces the file name in errors;
// relative model paths start at `folder`.
Scenario ParseScenario(const std::string& text, const std::string& name,
                       const std::filesystem::path& folder,
                       const std::vector<std::string>& overrides = {});

// Returns the whole scenario as YAML, with all defaults. ParseScenario(SaveScenario(s)) equals s.
std::string SaveScenario(const Scenario& scenario);

// Reads every field of a group of keys and reports invalid values. A member with a missing or
// invalid value keeps its default.
Scenario ReadFields(const YamlNode& root, Problems* problems);
// Returns the tree to be saved, with all defaults and a comment for each key.
YamlNode ScenarioTree(const Scenario& scenario);

// Returns the JSON Schema (draft-07) of scenarios, from the field tables that loading uses.
std::string ScenarioSchema();

}  // namespace predictor
