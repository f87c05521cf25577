// Runs of the reproduction, and what is kept of them.
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

// A run: the scenario by its file's name, what is set of it, and how its page calls it.
struct ReproducedSetting {
  std::string scenario;
  std::vector<std::string> set;
  std::string name;
  std::vector<double> moments = {};  // whose records are kept, of run time, ascending [s]
};

struct ReproducedRun {
  RunData data;
  RunEnd end = RunEnd::kNotStarted;
  std::array<Statistics, kStages> timing;  // [µs]
  std::vector<TickRecord> moments;
  // Errors from when the script lets go until it has gripped again [m]; of the first hand that is
  // there, and of the distance of the handles.
  Statistics released_error, released_distance;
  std::string command;  // that repeats it
};

// Share of the experiment that is done, of one.
using ReproduceProgress = std::function<void(double share)>;

class ReproduceRuns {
 public:
  ReproduceRuns(const ReproduceOptions& options, const std::string& experiment, int runs);

  Scenario Load(const ReproducedSetting& setting) const;
  // Throws std::runtime_error unless it ends as `expected`.
  ReproducedRun Run(const ReproducedSetting& setting, RunEnd expected = RunEnd::kFinished);
  ReproducedRun Run(const ReproducedSetting& setting, const Scenario& scenario, RunEnd expected);
  // Tells of progress within the experiment when it is not by Run.
  void Tell(double share) const;
  const ReproduceOptions& options() const { return options_; }
  const std::string& experiment() const { return experiment_; }

 private:
  const ReproduceOptions& options_;
  std::string experiment_;
  int runs_, done_ = 0;
};

// `predictor simulate scenarios/NAME.yaml --set ...`.
std::string SimulateCommandOf(const ReproducedSetting& setting);

// A loop as the paper's: 10 ms of computing, no lead. Our monitor of oscillations, which the paper
// does not have, is off. The paper names no rate: we take that at which one computation ends as the
// next begins [Hz].
inline constexpr int kAssumedPaperRate = 100;
std::vector<std::string> PaperConditions(int rate = kAssumedPaperRate);

// ---- the experiments ---------------------------------------------------------------------------

using ReproduceFunction = ReproducedExperiment (*)(ReproduceRuns* runs);
ReproducedExperiment ReproduceBox9(ReproduceRuns* runs);
ReproducedExperiment ReproduceBox18(ReproduceRuns* runs);
ReproducedExperiment ReproduceSafety(ReproduceRuns* runs);
ReproducedExperiment ReproduceCircle(ReproduceRuns* runs);
ReproducedExperiment ReproduceRelativePose(ReproduceRuns* runs);
ReproducedExperiment ReproduceResponsiveness(ReproduceRuns* runs);
ReproducedExperiment ReproduceQuestionnaire(ReproduceRuns* runs);

// Pictures of the scene at the kept moments, as PNG. `prefix`: of their ids.
std::vector<ReproducedImage> ReproduceSnapshots(const ReproducedRun& run,
                                                const std::string& prefix);

// ---- words -------------------------------------------------------------------------------------

// "4.1 ± 3.8" with digits that suit the deviation.
std::string PlusMinus(double mean, double deviation);
// As the paper prints it.
std::string Printed(const PrintedValue& value);
// A row a quantity: the paper's figure, ours under each condition, "mean ± deviation (largest)",
// and each one's ratio to the paper's.
std::string NumbersTable(const std::vector<ReproducedNumber>& numbers);
// A table's head and rows as HTML for blocks.
ReproducedBlock HtmlBlock(std::string html);
ReproducedBlock ParagraphBlock(const std::string& text);
// The plot under another id, title and caption; what is empty stays.
ReproducedBlock FigureBlock(Plot plot, const std::string& id, const std::string& title,
                            const std::string& caption = "");

}  // namespace predictor
