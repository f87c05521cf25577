// The form in which a population study stores its finished runs.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/population/population.h"

namespace predictor::population {

nlohmann::ordered_json JsonOf(const PopulationRun& run);
// Returns false if the run is damaged or from another version of the program. In this case, `run`
// is unchanged.
bool ReadRun(const nlohmann::ordered_json& json, PopulationRun* run);

}  // namespace predictor::population
