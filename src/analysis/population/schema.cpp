// Makes the JSON Schema of a population study from an example of it and the meaning of each key.
#include <map>
#include <nlohmann/json.hpp>

#include "analysis/population/population.h"
#include "core/json_schema.h"

namespace predictor::population {
namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, const char*> kMeanings = {
    {"operator", "simulated: all people were simulated"},
    {"people", "the simulated people, or the number of people counted"},
    {"number", "number of the person, from 1"},
    {"sex", "female or male"},
    {"height_m", "height of the body [m]"},
    {"mass_kg", "mass of the body [kg]"},
    {"strength",
     "as multiples of the mean for the person's sex: elbow flexion and extension, shoulder flexion "
     "and extension"},
    {"stiffness", "stiffness of the arm's joints, as a multiple of the published mean"},
    {"designs", "what the people performed"},
    {"name", "name of the design"},
    {"scenario", "file name without folder and extension"},
    {"handle_height_m",
     "height of the point midway between the handles, above the ground at the start [m]"},
    {"stopped", "people whose run the emulator stopped; they are not compared"},
    {"quantities", "results over the people, by quantity"},
    {"unit", "SI unit"},
    {"origin", "measured, modelled or standard"},
    {"median", "median of the people"},
    {"p5", "5th percentile of the people"},
    {"p95", "95th percentile of the people"},
    {"limit", "a published limit; null: none"},
    {"beyond_limit", "people who exceed the limit; null: no limit"},
    {"count", "people"},
    {"of", "number of people of whom they are counted"},
    {"interval_95", "95 % interval"},
    {"differences", "differences between two designs, for the same people"},
    {"design", "name of the design"},
    {"against", "name of the design that is subtracted"},
    {"quantity", "key of the quantity"},
    {"shift", "Hodges-Lehmann estimate of the difference"},
    {"p", "Wilcoxon's signed-rank test, two-sided"},
    {"p_holm", "p, adjusted for all differences of the study"},
    {"better", "people for whom the design is better"}};

Json SchemaOf(const Json& example, const std::string& key) {
  Json schema;
  const bool can_miss = example.is_number_float() || key == "beyond_limit" || key == "limit";
  if (example.is_object()) {
    schema["type"] = can_miss ? Json({"object", "null"}) : Json("object");
    schema["required"] = Json::array();
    for (const auto& [name, value] : example.items()) {
      schema["required"].push_back(name);
      schema["properties"][name] = SchemaOf(value, name);
    }
  } else if (example.is_array()) {
    schema["type"] = "array";
    schema["items"] = SchemaOf(example.front(), "");
  } else if (example.is_number_integer()) {
    schema["type"] = "integer";
  } else if (example.is_string()) {
    schema["type"] = "string";
  } else {
    schema["type"] = {can_miss || example.is_null() ? "number" : "boolean", "null"};
  }
  if (const auto meaning = kMeanings.find(key); meaning != kMeanings.end())
    schema["description"] = meaning->second;
  return schema;
}

// Returns a study with one person and two designs.
PopulationStudy Example() {
  PopulationStudy study;
  study.people = SamplePopulation(1, 1);
  for (const char* name : {"a", "b"}) {
    PopulationDesign design = {name, name, 1.0, {}};
    PopulationRun run;
    run.person = 1;
    run.values.assign(StudyQuantities().size(), 0.5);
    design.runs = {run};
    study.designs.push_back(design);
  }
  Compare(&study);
  return study;
}

}  // namespace

std::string PopulationSchema() {
  Json schema = SchemaOf(Json::parse(PopulationJson(Example())), "");
  Json& quantities = schema["properties"]["designs"]["items"]["properties"]["quantities"];
  for (const StudyQuantity& kind : StudyQuantities())
    quantities["properties"][kind.path]["description"] =
        WithUnit(kind.label, {kind.unit.si, kind.unit.si});
  schema["description"] = "A population study of PREDICTOR";
  schema["$schema"] = schema::kDraft;
  return schema.dump(2) + "\n";
}

}  // namespace predictor::population
