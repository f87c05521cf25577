// Performs the runs of the reproduction and stores their results.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/reproduce/reproduce.h"
#include "core/record.h"
#include "emulator/run_loop.h"
#include "evaluation/statistics.h"
#include "report/run_data.h"
#include "scenario/scenario.h"

namespace predictor {

// A run: the scenario's file name, its overrides, and its name on the page.
struct ReproducedSetting {
  std::string scenario;
  std::vector<std::string> set;
  std::string name;
  std::vector<double> moments = {};  // run times whose records are kept, ascending [s]
};

struct ReproducedRun {
  RunData data;
  RunEnd end = RunEnd::kNotStarted;
  std::array<Statistics, kStages> timing;  // [µs]
  std::vector<TickRecord> moments;
  // The errors from the release until the script has gripped again [m]: the error of the left
  // handle, and the error of the distance between the handles.
  Statistics released_error, released_distance;
  std::string command;  // repeats the run
};

class ReproduceRuns {
 public:
  ReproduceRuns(const ReproduceOptions& options, const std::string& experiment, int runs);

  // Returns the setting with the changes that the options request.
  ReproducedSetting Changed(ReproducedSetting setting) const;
  Scenario Load(const ReproducedSetting& setting) const;
  // Performs a run. Throws std::runtime_error unless the run ends as `expected`.
  ReproducedRun Run(const ReproducedSetting& setting, RunEnd expected = RunEnd::kFinished);
  ReproducedRun Run(const ReproducedSetting& setting, const Scenario& scenario, RunEnd expected);
  // Runs a setting to the end of the script or to a safety stop. Use this function for settings in
  // which the end of the run is itself a result.
  ReproducedRun RunToEitherEnd(const ReproducedSetting& setting);
  // Reports the part of the experiment's progress that Run does not report.
  void ReportProgress(double share) const;
  const ReproduceOptions& options() const { return options_; }

 private:
  ReproducedRun RunToAnyEnd(const ReproducedSetting& setting, const Scenario& scenario);
  const ReproduceOptions& options_;
  std::string experiment_;
  int runs_, done_ = 0;
};

// Returns the command that repeats a run: `predictor simulate scenarios/NAME.yaml --set ...`.
std::string SimulateCommandOf(const ReproducedSetting& setting);

// These conditions resemble the paper's loop, with a computing time of 10 ms and no lead. The
// oscillation monitor, which the paper does not have, is off. The paper gives no rate, so we assume
// that each computation starts when the previous one ends [Hz].
inline constexpr int kAssumedPaperRate = 100;
std::vector<std::string> PaperConditions(int rate = kAssumedPaperRate);
// Returns the overrides of PaperConditions without the coupling of real and virtual handles,
// because the paper has no such coupling.
std::vector<std::string> PaperConditionsWithoutCoupling();

// The names of the conditions in tables and in the numbers file.
inline constexpr const char* kOurs = "our defaults";
inline constexpr const char* kPapers = "the paper's conditions, our coupling";
inline constexpr const char* kPapersUncoupled = "the paper's conditions, no coupling";

// ---- the experiments ---------------------------------------------------------------------------

using ReproduceFunction = ReproducedExperiment (*)(ReproduceRuns* runs);
ReproducedExperiment ReproduceBox9(ReproduceRuns* runs);
ReproducedExperiment ReproduceBox18(ReproduceRuns* runs);
ReproducedExperiment ReproduceBar(ReproduceRuns* runs);
ReproducedExperiment ReproduceSafety(ReproduceRuns* runs);
ReproducedExperiment ReproduceCircle(ReproduceRuns* runs);
ReproducedExperiment ReproduceRelativePose(ReproduceRuns* runs);
ReproducedExperiment ReproduceAblation(ReproduceRuns* runs);
ReproducedExperiment ReproduceRepairs(ReproduceRuns* runs);
ReproducedExperiment ReproduceTuning(ReproduceRuns* runs);
ReproducedExperiment ReproduceArms(ReproduceRuns* runs);
ReproducedExperiment ReproduceResponsiveness(ReproduceRuns* runs);
ReproducedExperiment ReproduceQuestionnaire(ReproduceRuns* runs);

// Draws pictures of the scene at the kept times and encodes the pictures as PNG. `prefix` is the
// beginning of the pictures' IDs.
std::vector<ReproducedImage> ReproduceSnapshots(const ReproducedRun& run,
                                                const std::string& prefix);

// ---- numbers -----------------------------------------------------------------------------------

// Returns a number that is labelled with the run's name. `scale` is the factor from SI to `unit`.
ReproducedNumber NumberOf(const ReproducedRun& run, const std::string& quantity,
                          const Statistics& values, double scale, const char* unit);
// Returns the statistics of a metric, which are found by their path in the summary. `quantity` is
// "" for the row's label.
ReproducedNumber NumberOfMetric(const ReproducedRun& run, const std::string& path,
                                const std::string& quantity = "");
ReproducedNumber NumberOf(const ReproducedRun& run, const std::string& quantity, double value,
                          const char* unit);
// Adds a number together with its place in the paper.
void Add(ReproducedNumber number, const char* place, std::vector<ReproducedNumber>* numbers);

// ---- words -------------------------------------------------------------------------------------

// Returns a text such as "4.1 ± 3.8", in which the number of digits suits the deviation.
std::string PlusMinus(double mean, double deviation);
// Returns the number as printed in the paper.
std::string Printed(const PrintedValue& value);
// Returns one row per quantity. A row contains the paper's number, our number for each condition as
// "mean ± deviation (largest)", and the ratio of each of our numbers to the paper's.
std::string NumbersTable(const std::vector<ReproducedNumber>& numbers);
}  // namespace predictor
