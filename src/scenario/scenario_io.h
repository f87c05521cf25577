// Scenario <-> YAML, JSON Schema, and overrides from the command line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// Reads and checks a scenario. `overrides` are "path.to.key=value" (value in YAML), applied before
// the checks. Throws InputError with file:line:column, the offending value, what is allowed and the
// nearest key. Reads at most 1 MiB; aliases and anchors are refused.
Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides = {});

// The same from text; `name` stands for the file in errors and `folder` is where relative model
// paths start.
Scenario ParseScenario(const std::string& text, const std::string& name,
                       const std::filesystem::path& folder,
                       const std::vector<std::string>& overrides = {});

// The whole scenario as YAML, every default written out. ParseScenario(SaveScenario(s)) equals s.
std::string SaveScenario(const Scenario& scenario);

// JSON Schema (draft-07) of scenarios, out of the same field tables that loading uses.
std::string ScenarioSchema();

}  // namespace predictor
