// Makes the JSON Schema of a population study from an example of a study and the meaning of each
// key.
#include <nlohmann/json.hpp>

#include "analysis/population/population.h"
#include "core/json_schema.h"

namespace predictor::population {
namespace {

using Json = nlohmann::ordered_json;

const schema::Words kWords = {
    {{"operator", "simulated: all people were simulated"},
     {"people", "the simulated people, or the number of people counted"},
     {"number", "number of the person, from 1"},
     {"sex", "female or male"},
     {"height_m", "height of the body [m]"},
     {"mass_kg", "mass of the body [kg]"},
     {"strength",
      "as multiples of the mean for the person's sex: elbow flexion and extension, shoulder "
      "flexion and extension"},
     {"stiffness", "stiffness of the arm's joints, as a multiple of the published mean"},
     {"designs", "what the people performed"},
     {"name", "name of the design"},
     {"scenario", "file name without folder and extension"},
     {"handle_height_m",
      "height of the point midway between the handles, above the ground at the start [m]"},
     {"stopped", "people whose run the emulator stopped"},
     {"beyond_lifft",
      "people of whom a load exceeds 100 N·m, so that their damage by LiFFT is extrapolated"},
     {"quantities", "results over the people, by quantity"},
     {"unit", "SI unit"},
     {"origin", "simulated sensor, modelled or standard"},
     {"known_as_bounds",
      "people whose run was stopped, so that only a bound of their value is known"},
     {"median", "median of the people"},
     {"p5", "5th percentile of the people"},
     {"p95", "95th percentile of the people"},
     {"bounds",
      "which of median, p5 and p95 are bounds, separated by spaces; the true values are at least "
      "as "
      "bad"},
     {"limit", "a published limit; null: none"},
     {"beyond_limit", "people who exceed the limit; null: no limit"},
     {"count", "people"},
     {"of", "number of people of whom they are counted"},
     {"undecided", "people whose stopped run does not show whether they count"},
     {"interval_95", "95 % interval"},
     {"differences", "differences between two designs, for the same people"},
     {"design", "name of the design"},
     {"against", "name of the design that is subtracted"},
     {"quantity", "key of the quantity"},
     {"shift",
      "Hodges-Lehmann estimate of the difference; with stopped runs, the middle of its possible "
      "values"},
     {"p", "Wilcoxon's signed-rank test, two-sided"},
     {"p_holm", "p, adjusted for all differences of the study"},
     {"better", "people for whom the design is better"}},
    {"limit", "beyond_limit"}};

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
  Json study = schema::FromExample(Json::parse(PopulationJson(Example())), kWords);
  Json& quantities = study["properties"]["designs"]["items"]["properties"]["quantities"];
  for (const StudyQuantity& kind : StudyQuantities())
    quantities["properties"][kind.path]["description"] =
        WithUnit(kind.label, {kind.unit.si, kind.unit.si});
  study["description"] = "A population study of PREDICTOR";
  study["$schema"] = schema::kDraft;
  return study.dump(2) + "\n";
}

}  // namespace predictor::population
