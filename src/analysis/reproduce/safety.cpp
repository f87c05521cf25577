// Reproduces the two safety experiments, section 4.1.2 and Fig. 9.
#include "analysis/reproduce/runs.h"
#include "core/text.h"
#include "report/report_words.h"
#include "report/run_plots.h"

namespace predictor {
namespace {

struct StopExperiment {
  const char* scenario;
  const char* title;
  const char* words;  // name in the paper
  StopCause expected;
};

constexpr StopExperiment kStopExperiments[] = {
    {"push", "Sudden push",
     "In the paper, the operator suddenly pushes with more than 30 N, and the system stops "
     "immediately.",
     StopCause::kForce},
    {"underdamped", "Underdamped",
     "According to the paper, a system with underdamped vertical motion tends to oscillate. The "
     "force then easily exceeds the threshold, and the system stops. Our oscillation monitor, "
     "which the paper does not have, stops the run before the force threshold does. A second run "
     "without the monitor stops at the threshold, as in the paper.",
     StopCause::kOscillation},
    {"underdamped", "Underdamped, no monitor", "", StopCause::kForce},
};

void AddStop(const ReproducedRun& run, std::vector<ReproducedNumber>* numbers) {
  const StopSummary& stop = run.data.stops.front().summary;
  const auto add = [&](const char* quantity, const char* unit, double value) {
    Add(NumberOf(run, quantity, value, unit), "Fig. 9", numbers);
  };
  add("time of the decision", "s", stop.time);
  if (stop.quantity == Quantity::kForce)
    add(stop.cause == StopCause::kOscillation ? "growing amplitude that caused the stop"
                                              : "force that caused the stop",
        "N", stop.value);
  if (stop.detection) add("true force over threshold to decision", "ms", 1e3 * *stop.detection);
  add("decision to rest", "ms", 1e3 * stop.duration);
  add("travel of the faster handle meanwhile", "mm", 1e3 * stop.distance);
}

ReproducedSetting SettingOf(const StopExperiment& experiment, bool monitored) {
  ReproducedSetting setting{experiment.scenario, {}, experiment.title};
  if (!monitored) setting.set.emplace_back("safety.oscillation.enabled=false");
  return setting;
}

// Adds space on the right side for the names of the limits next to the stop.
Plot WithRoom(Plot plot) {
  constexpr double kRoom = 0.16;  // as a share of the displayed time
  *plot.x.high += kRoom * (*plot.x.high - *plot.x.low);
  for (PlotSpan& span : plot.spans) span.label.clear();  // they would overlap a limit
  return plot;
}

void AddFigures(const ReproducedRun& run, const std::string& id, ReproducedExperiment* e) {
  const RunCurves curves(run.data);
  e->Add(StopWords(run.data, run.data.stops.front()));
  e->Add(WithRoom(ForcePlot({curves})), "fig9-" + id + "-forces", "Forces of the hands (Fig. 9)",
         "The plot also shows the torques and the distance of the elbows, with the thresholds. The "
         "grey areas are the times before the run and while the arms come to rest.");
  e->Add(WithRoom(JointPlot(curves)), "fig9-" + id + "-joints", "Joints (Fig. 9)", "");
}

}  // namespace

ReproducedExperiment ReproduceSafety(ReproduceRuns* runs) {
  ReproducedExperiment e;
  int k = 0;
  for (const StopExperiment& experiment : kStopExperiments) {
    const bool monitored = k != 2;
    const ReproducedRun run = runs->Run(SettingOf(experiment, monitored), RunEnd::kStopped);
    const StopCause cause = run.data.stops.front().summary.cause;
    e.Add("<h3>" + EscapeMarkup(experiment.title) + "</h3>\n");
    if (*experiment.words != '\0') e.AddParagraph(experiment.words);
    if (cause != experiment.expected)
      e.Add("<p class=\"warning\">The stop differs from the expected one: " +
            EscapeMarkup(Name(experiment.expected)) + ".</p>\n");
    AddStop(run, &e.numbers);
    AddFigures(run, std::string(experiment.scenario) + (monitored ? "" : "-force"), &e);
    ++k;
  }
  e.blocks.insert(e.blocks.begin(), {NumbersTable(e.numbers), {}});
  return e;
}

}  // namespace predictor
