// For several scenarios, controllers and hazards, the hazard study shows what simulated operators
// feel when a hazard occurs at a time unknown to them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/hazard_study/hazard_runs.h"
#include "scenario/scenario.h"

namespace predictor {

// A setting of the study: its name, and the overrides of the scenario that produce it.
struct StudyChoice {
  std::string name;
  std::vector<std::string> set;
};
// These functions return the controllers and the hazards of the study. The first controller is the
// scenario's own, and has no overrides.
std::vector<StudyChoice> StudiedControllers();
std::vector<StudyChoice> StudiedHazards();

// All runs of one scenario, controller and hazard.
struct HazardCell {
  std::string scenario, controller, hazard;
  std::string impossible;       // why a valid scenario has no such combination; "": it has it
  double speed_cap = 0;         // cap of the handles' commanded speed [m/s]
  double travel_budget = 0;     // travel allowed for a stop, as `check` computes it [m]
  std::vector<HazardRun> runs;  // by seed
};

struct HazardStudy {
  std::vector<HazardCell> cells;
  int kept = 0;  // runs that an earlier, interrupted study had finished
};

struct HazardStudyOptions {
  std::vector<std::filesystem::path> scenarios;
  std::filesystem::path folder;  // folder for the results; created if necessary
  int seeds = 50;
  double duration = 6;  // duration of a run from the saved state [s]
  int workers = 0;      // 0: the number of cores
  // Only the caller's thread calls this.
  std::function<void(double share)> progress = [](double) {};
};

// Returns the scenario of a cell's runs, which continue for `duration` [s] after the time at which
// the hazard can begin. Throws InputError if the controller and the hazard cannot be combined, for
// example because the hazard would have no effect.
Scenario StudiedScenario(const std::filesystem::path& file, const StudyChoice& controller,
                         const StudyChoice& hazard, double duration);

// Executes the runs that the folder's runs.csv does not contain yet. Each finished run is appended
// to runs.csv, with a hash of its scenario and of the program's behaviour. Writes hazards.csv and
// hazards.md. Throws InputError. If a scenario file is missing or has an error, throws before
// anything is written.
HazardStudy MakeHazardStudy(const HazardStudyOptions& options);

// Returns a table with one row per cell.
std::string HazardStudyCsv(const HazardStudy& study);
std::string HazardStudyJson(const HazardStudy& study);
// Returns a table of controllers and hazards for each scenario, in Markdown.
std::string HazardStudyTables(const HazardStudy& study);
// States whether all runs meet the requirements on the time of detection, the travel and the speed.
std::string HazardStudyWords(const HazardStudy& study);

}  // namespace predictor
