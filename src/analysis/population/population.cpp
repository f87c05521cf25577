#include "analysis/population/population.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string_view>

#include "analysis/json_line_store.h"
#include "analysis/parallel.h"
#include "analysis/population/run_json.h"
#include "assessment/design_differences.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "evaluation/summary.h"
#include "models/object_model.h"
#include "scenario/scenario_io.h"

namespace predictor::population {
namespace {

constexpr double kShortRun = 0.05;  // long enough for one sample of the person [s]

// A design and the data that its runs need.
struct Prepared {
  PopulationDesign design;
  Scenario scenario;
  double object_mass = 0;
  std::string key;
  PopulationRun first;  // of person 1
};

// Returns the height of the point midway between the handles at the start of a run, in W [m].
double StartHeight(const Scenario& scenario) {
  assessment::SampleCollector samples(scenario);
  Emulator emulator(scenario);
  Simulate(&emulator, kShortRun, [&](const TickRecord& record) { samples.Add(record); });
  double sum = 0;
  for (const int hand : scenario.hands())
    sum += samples.first().hands[static_cast<std::size_t>(hand)].real.pose.p[2];
  return sum / scenario.hands().count();
}

PopulationRun Perform(Scenario scenario, double object_mass, const SampledPerson& person) {
  WritePerson(person, &scenario);
  SummaryBuilder summary(scenario);
  assessment::SampleCollector samples(scenario);
  Emulator emulator(scenario);
  Simulate(&emulator, scenario.duration, [&](const TickRecord& record) {
    summary.Add(record);
    samples.Add(record);
  });
  assessment::AssessOptions how;
  how.intervals = false;
  PopulationRun run;
  run.person = person.number;
  const Summary result = summary.summary();
  if (!result.stops.empty()) run.cause = result.stops.front().cause;
  assessment::Assessment a;
  try {
    a = Assess(scenario, object_mass, samples, how);
  } catch (const assessment::OutOfReach&) {
    // The only known value of such a person is that the body reaches the handles for no time.
    for (const StudyQuantity& quantity : StudyQuantities())
      run.values.push_back(std::string_view(quantity.path) == "reached_share"
                               ? 0
                               : std::numeric_limits<double>::quiet_NaN());
    return run;
  }
  run.held = a.held;
  // The time for which a stopped run exceeded a value is a lower bound of the time for which the
  // whole run would have exceeded it.
  const double tail =
      run.cause == StopCause::kNone ? kTailShare : kTailShare * scenario.duration / a.held;
  for (const StudyQuantity& quantity : StudyQuantities())
    run.values.push_back(quantity.of(a, tail));
  for (const assessment::WorksheetResult& w : a.worksheets)
    if (std::string(w.kind->name) == "RULA")
      std::copy_n(w.share.begin(), kRulaScores, run.rula_share.begin());
  run.beyond_lifft = std::ranges::any_of(a.damage, [](const assessment::DamageResult& d) {
    return d.tool == ergonomics::kLiftTool.name && d.outside();
  });
  return run;
}

// Prepares a scenario whose operator has a body, for one height of the handles.
Prepared PreparedDesign(const std::filesystem::path& file, const Scenario& scenario,
                        double start_height, std::optional<double> height,
                        const SampledPerson& first) {
  Prepared prepared;
  prepared.scenario = scenario;
  prepared.design.scenario = prepared.design.name = file.stem().string();
  Vector3& ground = prepared.scenario.operator_.stance->ground;
  if (height) {
    prepared.design.name += Formatted(", %g m", *height);
    ground.z() = start_height - *height;
  }
  prepared.design.height = start_height - ground.z();
  prepared.object_mass = LoadObject(scenario.object, scenario.folder()).mass;
  // The first run reveals the program's behaviour, so that no outdated run is reused.
  prepared.first = Perform(prepared.scenario, prepared.object_mass, first);
  prepared.key = HexHash(SaveScenario(prepared.scenario) + JsonOf(prepared.first).dump());
  return prepared;
}

Scenario LoadDesign(const std::filesystem::path& file, const std::vector<std::string>& set) {
  const Scenario scenario = LoadScenario(file, set);
  if (!scenario.operator_.stance)
    throw InputError("operator.stance",
                     file.string() +
                         ": the place where the operator stands is not known. Add "
                         "operator.stance: {ground, facing} to the scenario.");
  if (scenario.operator_.type != "virtual")
    throw InputError("operator.type", file.string() +
                                          ": only simulated operators can form a population. Set " +
                                          "operator.type: virtual.");
  return scenario;
}

std::vector<Prepared> PrepareDesigns(const PopulationOptions& options, const SampledPerson& first) {
  std::vector<Prepared> designs;
  for (const std::filesystem::path& file : options.scenarios) {
    const Scenario scenario = LoadDesign(file, options.set);
    const double start = StartHeight(scenario);
    if (options.heights.empty())
      designs.push_back(PreparedDesign(file, scenario, start, std::nullopt, first));
    for (const double height : options.heights)
      designs.push_back(PreparedDesign(file, scenario, start, height, first));
  }
  return designs;
}

assessment::ComparedDesign ComparedOf(const Prepared& prepared) {
  return {.name = prepared.design.name,
          .scenario = prepared.scenario,
          .object_mass = prepared.object_mass,
          .handle_height = prepared.design.height.value_or(0)};
}

// States what each design differs in from the first. Different heights of one scenario were
// requested, so they give no warning.
void DescribeDesigns(const std::vector<Prepared>& designs, PopulationStudy* study) {
  const assessment::ComparedDesign first = ComparedOf(designs.front());
  for (const Prepared& prepared : designs) {
    const assessment::ComparedDesign other = ComparedOf(prepared);
    for (const std::string& line : DesignDifferences(first, other)) {
      // Another height of the handles moves the ground, which is no further difference.
      const bool by_height = prepared.design.height && line.starts_with("operator.stance.ground");
      if (!by_height) study->differences_of_designs.push_back(line);
    }
    if (prepared.design.scenario == designs.front().design.scenario) continue;
    if (const std::string warning = HandleHeightWarning(first, other); !warning.empty())
      study->warnings.push_back(warning);
  }
}

void WriteResults(const PopulationStudy& study, const PopulationOptions& options) {
  const std::filesystem::path& folder = options.folder;
  WriteWholeFile(folder / "persons.csv", PersonsCsv(study));
  WriteWholeFile(folder / "designs.csv", DesignsCsv(study));
  WriteWholeFile(folder / "differences.csv", DifferencesCsv(study));
  WriteWholeFile(folder / "population.html", PopulationPage(study, options.program_version));
}

}  // namespace

PopulationStudy MakePopulationStudy(const PopulationOptions& options) {
  std::filesystem::create_directories(options.folder);
  JsonLineStore store(options.folder / "runs.jsonl");
  PopulationStudy study;
  study.people = SamplePopulation(options.persons, options.seed);
  std::vector<Prepared> designs = PrepareDesigns(options, study.people.front());
  for (Prepared& prepared : designs) prepared.design.runs.resize(study.people.size());

  const std::size_t count = designs.size() * study.people.size();
  std::atomic<std::size_t> done = 0;
  std::atomic<int> kept = 0;
  DoInParallel(
      count, options.workers,
      [&](std::size_t i) {
        Prepared& prepared = designs[i % designs.size()];
        const SampledPerson& person = study.people[i / designs.size()];
        PopulationRun& run = prepared.design.runs[i / designs.size()];
        const std::string key =
            prepared.key + Formatted("/bounds/%llu/%d", options.seed * 1ULL, person.number);
        if (const auto* stored = store.Find(key); stored && ReadRun(*stored, &run)) {
          ++kept;
        } else {
          run = person.number == 1 ? prepared.first
                                   : Perform(prepared.scenario, prepared.object_mass, person);
          store.Add(key, JsonOf(run));
        }
        ++done;
      },
      [&] { options.progress(static_cast<double>(done) / static_cast<double>(count)); });
  study.kept = kept;
  DescribeDesigns(designs, &study);
  for (Prepared& prepared : designs) study.designs.push_back(std::move(prepared.design));
  Compare(&study);
  WriteResults(study, options);
  return study;
}

}  // namespace predictor::population
