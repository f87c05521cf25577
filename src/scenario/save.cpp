#include "scenario/field_writer.h"
#include "scenario/scenario_io.h"
#include "scenario/scenario_tree.h"

namespace predictor {

YamlNode ScenarioTree(const Scenario& scenario) { return WriteStruct(scenario); }

std::string SaveScenario(const Scenario& scenario) { return WriteYaml(ScenarioTree(scenario)); }

}  // namespace predictor
