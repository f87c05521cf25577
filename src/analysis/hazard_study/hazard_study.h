// For several scenarios, controllers and hazards, the hazard study shows what simulated operators
// feel when a hazard occurs at a time unknown to them.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/status.h"
#include "scenario/scenario.h"

namespace predictor {

// A setting of the study: its name, and the overrides of the scenario that produce it.
struct StudyChoice {
  std::string name;
  std::vector<std::string> set;
};
// These functions return the controllers and the hazards of the study.
std::vector<StudyChoice> StudiedControllers();
std::vector<StudyChoice> StudiedHazards();

// One run of the study, which has its own seed.
struct HazardRun {
  std::uint64_t seed = 0;
  double begin = -1;             // run time at which the hazard began [s]; −1: it did not begin
  double before = 0, after = 0;  // largest force of a hand before and after the hazard began [N]
  double torque = 0, speed = 0;  // largest values after the hazard began [N·m], [m/s]
  double until_stop = -1;  // from the beginning of the hazard to the emulator's stop [s]; −1:
                           // no stop
  StopCause cause = StopCause::kNone;
  double detection = -1;  // from the time at which the true force crosses its threshold to the stop
                          // [s]
  double excess = -1;     // of the true force over its threshold at that stop [N]
  // Time from the moment at which the true force clearly exceeds its threshold (ClearCrossing) to
  // the stop [s]; −1 if the force did not clearly exceed the threshold.
  double clear_detection = -1;
  // The largest commanded speed of a handle, as a share of its cap (CommandedSpeeds).
  double commanded = 0;
  double travel = -1;  // travel of the faster handle during the stop [m]
  CobotStop cobot_stop = CobotStop::kNone;
};

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
  double duration = 6;  // duration of a run [s]
  int workers = 0;      // 0: the number of cores
  // Only the caller's thread calls this.
  std::function<void(double share)> progress = [](double) {};
};

// Returns the scenario of a cell's runs. Throws InputError if the controller and the hazard cannot
// be combined, for example because the hazard would have no effect.
Scenario StudiedScenario(const std::filesystem::path& file, const StudyChoice& controller,
                         const StudyChoice& hazard, double duration);
// Simulates one run with the operator that belongs to `seed`. The first event of the scenario is
// the hazard.
HazardRun RunWithHazard(Scenario scenario, std::uint64_t seed);

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
