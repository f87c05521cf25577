// Makes the plots of a report. For one run, both hands are shown in one panel. For several runs,
// there is one panel per hand and one colour per run.
#pragma once

#include <vector>

#include "report/run_data.h"

namespace predictor {

// The curves of a run that are used in several of the run's plots.
class RunCurves {
 public:
  explicit RunCurves(const RunData& run)
      : run_(&run),
        times_(run.trace.Times(run.origin)),
        detail_times_(run.trace.DetailTimes(run.origin)) {}
  const RunData& run() const { return *run_; }
  PlotSeries Line(std::size_t channel, const std::string& label, int color,
                  double resolution) const;

 private:
  const RunData* run_;
  Samples times_, detail_times_;
};

using Runs = std::vector<RunCurves>;

Plot TrackingPlot(const Runs& runs);   // Fig. 7
Plot ForcePlot(const Runs& runs);      // Fig. 8
Plot ForceAxesPlot(const Runs& runs);  // Fig. 12
Plot TickHistogram(const Runs& runs);
// Plots the paths of the object and the handles from above and from the side, with the guidance
// path.
std::vector<Plot> PathPlots(const Runs& runs);
Plot ObjectPlot(const Runs& runs);
Plot CouplingPlot(const Runs& runs);
Plot SlackPlot(const Runs& runs);
Plot OscillationPlot(const Runs& runs);

// The following plots show a single run.
Plot JointPlot(const RunCurves& curves);  // Fig. 9
Plot EnergyPlot(const RunCurves& curves);
Plot TickPlot(const RunCurves& curves);
Plot StopPlot(const RunCurves& curves, const ReportedStop& stop, std::size_t number);

// Returns a threshold as set at the end of the run.
double ThresholdOf(const RunData& run, Parameter parameter);

}  // namespace predictor
