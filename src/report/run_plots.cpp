#include "report/run_plots.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/units.h"
#include "report/plot_parts.h"

namespace predictor {
namespace {

constexpr double kBeforeRun = 0.5;  // part of the run before RUN that the plots show [s]

std::string Lower(const char* word) {
  std::string lower = word;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return lower;
}

Plot TimePlot(const Runs& runs, const std::string& id, const std::string& title) {
  Plot plot;
  plot.id = id;
  plot.title = title;
  plot.group = "time";
  plot.x = Axis("Time since the run began", "s");
  double low = 1e300, high = -1e300;
  for (const RunCurves& curves : runs) {
    const RunData& run = curves.run();
    low = std::min(low, std::max(run.TimeOf(run.first), -kBeforeRun));
    high = std::max(high, run.TimeOf(run.last));
  }
  plot.x.low = low;
  plot.x.high = std::max(high, low + 0.01);
  if (!Single(runs)) return plot;
  const RunData& run = First(runs);
  for (const ReportedPart& part : run.parts)
    if (part.state != RunState::kRun)
      plot.spans.push_back({run.TimeOf(part.from), run.TimeOf(part.to), Lower(Name(part.state))});
  for (const ReportedStop& stop : run.stops)
    if (plot.notes.size() < kMaxNotes)
      plot.notes.push_back(
          {run.TimeOf(stop.tick), std::string("stop: ") + Name(stop.summary.cause)});
  for (const ReportedStop& stop : run.stops)
    if (stop.power_off != 0 && plot.notes.size() < kMaxNotes)
      plot.notes.push_back({run.TimeOf(stop.power_off),
                            std::string("power off: ") + Name(stop.summary.harder.cause)});
  for (const ReportedEvent& event : run.events)
    if (event.marker && plot.notes.size() < kMaxNotes)
      plot.notes.push_back({run.TimeOf(event.tick), event.text.substr(0, 40)});
  return plot;
}

// A quantity of both hands. For a single run, both hands are shown in one panel. For several runs,
// each hand has its own panel.
struct HandQuantity {
  HandChannel channel;
  std::string title;
  PlotAxis axis;
  double resolution;
};

void AddHandPanels(const Runs& runs, const HandQuantity& quantity,
                   const std::vector<PlotLimit>& limits, Plot* plot) {
  PlotPanel panel{.title = quantity.title, .y = quantity.axis, .limits = limits};
  for (int i = 0; i < kHands; ++i) {
    if (!Single(runs)) {
      panel.title = quantity.title + ", " + HandName(i);
      panel.series.clear();
    }
    for (std::size_t r = 0; r < runs.size(); ++r)
      if (runs[r].run().Present(i))
        panel.series.push_back(runs[r].Line(
            ChannelOf(i, quantity.channel), Single(runs) ? HandName(i) : LabelOf(runs, r),
            Single(runs) ? i : static_cast<int>(r), quantity.resolution));
    if (!Single(runs) && !panel.series.empty()) plot->panels.push_back(panel);
  }
  if (Single(runs)) plot->panels.push_back(std::move(panel));
}

PlotPanel RunPanel(const Runs& runs, const std::string& title, const PlotAxis& axis,
                   std::size_t channel, double resolution, std::vector<PlotLimit> limits = {}) {
  PlotPanel panel{.title = title, .y = axis, .limits = std::move(limits)};
  for (std::size_t r = 0; r < runs.size(); ++r)
    panel.series.push_back(runs[r].Line(channel, Single(runs) ? "" : LabelOf(runs, r),
                                        Single(runs) ? kPair : static_cast<int>(r), resolution));
  return panel;
}

// Adds a line that concerns both handles. For a single run, this line is in the same panel as the
// lines of the handles.
void AddPair(const Runs& runs, const std::string& title, const std::string& label,
             const PlotAxis& axis, RunChannel channel, double resolution, Plot* plot) {
  if (!First(runs).Present(0) || !First(runs).Present(1)) return;
  if (Single(runs))
    plot->panels.back().series.push_back(
        runs[0].Line(ChannelOf(channel), label, kPair, resolution));
  else
    plot->panels.push_back(RunPanel(runs, title, axis, ChannelOf(channel), resolution));
}

bool HasLinkPairs(const Runs& runs) {
  return std::any_of(runs.begin(), runs.end(), [](const RunCurves& curves) {
    return std::isfinite(curves.run().summary.Get<double>("link_distance_m.min"));
  });
}

}  // namespace

double ThresholdOf(const RunData& run, Parameter parameter) {
  if (run.has_parameters) return run.parameters[static_cast<std::size_t>(parameter)];
  return parameter == Parameter::kForceThreshold ? run.info.scenario.safety.force
                                                 : run.info.scenario.safety.torque;
}

PlotSeries RunCurves::Line(std::size_t channel, const std::string& label, int color,
                           double resolution) const {
  PlotSeries series{.label = label, .color = color, .resolution = resolution};
  series.x = times_;
  series.y = run_->trace.Values(channel);
  series.x_detail = detail_times_;
  series.y_detail = run_->trace.DetailValues(channel);
  return series;
}

Plot TrackingPlot(const Runs& runs) {
  Plot plot = TimePlot(runs, "tracking", "Distance between real and virtual handles");
  const SafetySpec& safety = First(runs).info.scenario.safety;
  const PlotAxis length = Axis("Translation", "mm", 0.05), angle = Axis("Rotation", "°", 0.01);
  AddHandPanels(runs, {HandChannel::kError, "Translation", length, 1e-4},
                {LimitAt(1e3 * safety.tracking, "stop above", "mm")}, &plot);
  AddPair(runs, "Distance between the handles", "their distance", length, RunChannel::kDistance,
          1e-4, &plot);
  AddHandPanels(runs, {HandChannel::kErrorRotation, "Rotation", angle, 1e-5},
                {LimitAt(safety.tracking_rotation * kDegrees, "stop above", "°")}, &plot);
  AddPair(runs, "Relative angle of the handles", "their relative angle", angle, RunChannel::kAngle,
          1e-5, &plot);
  plot.caption =
      "The plots show the errors of the real handles relative to the virtual ones, and the errors "
      "of the handles' distance and relative angle, while simulated time advances (the paper's "
      "Fig. 7).";
  return plot;
}

Plot ForcePlot(const Runs& runs) {
  Plot plot = TimePlot(runs, "forces", "Forces and torques of the hands, and the nearest links");
  const RunData& run = First(runs);
  AddHandPanels(runs, {HandChannel::kForce, "Force", Axis("Force", "N", 1), 0.005},
                {LimitAt(ThresholdOf(run, Parameter::kForceThreshold), "stop above", "N")}, &plot);
  AddHandPanels(runs, {HandChannel::kTorque, "Torque", Axis("Torque", "N·m", 0.1), 5e-4},
                {LimitAt(ThresholdOf(run, Parameter::kTorqueThreshold), "stop above", "N·m")},
                &plot);
  const RenderingSpec& rendering = run.info.scenario.rendering;
  if (HasLinkPairs(runs))
    plot.panels.push_back(RunPanel(runs, "Distance of the nearest link pair",
                                   Axis("Distance", "m", 0.25, false),
                                   ChannelOf(RunChannel::kLinkDistance), 1e-4,
                                   {LimitAt(rendering.influence_distance, "slowed below", "m"),
                                    LimitAt(rendering.security_distance, "stop below", "m")}));
  plot.caption = "The plots also show the thresholds at the end of the run (the paper's Fig. 8).";
  return plot;
}

Plot ForceAxesPlot(const Runs& runs) {
  Plot plot = TimePlot(runs, "force-axes", "Forces of the hands by axis of the world");
  constexpr HandChannel kAxes[] = {HandChannel::kForceX, HandChannel::kForceY,
                                   HandChannel::kForceZ};
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k)
    AddHandPanels(runs, {kAxes[k], kNames[k], Axis("Force", "N", 1), 0.005}, {}, &plot);
  plot.caption = "The plots show the force of the hand on the handle (the paper's Fig. 12).";
  return plot;
}

Plot JointPlot(const RunCurves& curves) {
  const RunData& run = curves.run();
  Plot plot = TimePlot({curves}, "joints", "Joints of the arms and of the virtual cobot");
  const auto add = [&](const char* title, const PlotAxis& axis, const std::vector<int>& joints,
                       const auto& channel) {
    if (joints.empty()) return;
    PlotPanel panel{.title = title, .y = axis, .height = 1.2};
    for (const int j : joints) {
      panel.series.push_back(curves.Line(channel(j), "q" + std::to_string(j + 1), j, 0.002));
      if (j >= kPlotColors) panel.series.back().style = LineStyle::kDashed;
    }
    plot.panels.push_back(std::move(panel));
  };
  const PlotAxis angle = Axis("Angle", "°", 1, false);
  for (int i = 0; i < kHands; ++i) {
    std::vector<int> joints(static_cast<std::size_t>(run.arm_dof[static_cast<std::size_t>(i)]));
    std::iota(joints.begin(), joints.end(), 0);
    add(i == 0 ? "Left arm" : "Right arm", angle, joints,
        [i](int j) { return ChannelOf(i, HandChannel::kJoint, j); });
  }
  std::vector<int> turning, sliding;
  for (int j = 0; j < run.cobot_dof; ++j) (run.IsPrismatic(j) ? sliding : turning).push_back(j);
  const auto of_cobot = [](int j) { return ChannelOf(RunChannel::kCobotJoint, j); };
  add("Virtual cobot", angle, turning, of_cobot);
  add("Virtual cobot, prismatic joints", Axis("Position", "mm", 1, false), sliding, of_cobot);
  plot.caption = "The plots show measured values (the paper's Fig. 9).";
  return plot;
}

Plot ObjectPlot(const Runs& runs) {
  Plot plot = TimePlot(runs, "object", "Position of the object");
  constexpr const char* kNames[] = {"x", "y", "z"};
  if (Single(runs)) {
    PlotPanel panel{.title = "Relative to its start, axes of the world",
                    .y = Axis("Position", "mm", 1)};
    for (int k = 0; k < 3; ++k)
      panel.series.push_back(runs[0].Line(ChannelOf(RunChannel::kObjectX, k), kNames[k], k, 0.01));
    plot.panels.push_back(std::move(panel));
  } else {
    for (int k = 0; k < 3; ++k)
      plot.panels.push_back(RunPanel(runs, std::string(kNames[k]) + ", relative to the start",
                                     Axis("Position", "mm", 1), ChannelOf(RunChannel::kObjectX, k),
                                     0.01));
  }
  if (!IsMissing(First(runs).summary.At("guidance.distance_m").value))
    plot.panels.push_back(RunPanel(runs, "Distance from the guidance", Axis("Distance", "mm", 1),
                                   ChannelOf(RunChannel::kGuidance), 0.01));
  return plot;
}

Plot CouplingPlot(const Runs& runs) {
  Plot plot =
      TimePlot(runs, "coupling", "Coupling wrench between the real and the virtual handles");
  const SafetySpec& safety = First(runs).info.scenario.safety;
  AddHandPanels(
      runs,
      {HandChannel::kCouplingForce, "Force on the virtual handle", Axis("Force", "N", 0.5), 0.005},
      {LimitAt(safety.coupling, "stop above", "N")}, &plot);
  AddHandPanels(runs, {HandChannel::kCouplingTorque, "Torque", Axis("Torque", "N·m", 0.05), 5e-4},
                {LimitAt(safety.coupling_torque, "stop above", "N·m")}, &plot);
  return plot;
}

Plot SlackPlot(const Runs& runs) {
  Plot plot = TimePlot(runs, "slack", "Slack of the rendering's QP");
  const SafetySpec& safety = First(runs).info.scenario.safety;
  plot.panels.push_back(
      RunPanel(runs, "Relative speed of the handles", Axis("Slack", "mm/s", 0.1),
               ChannelOf(RunChannel::kSlack), 1e-3,
               {LimitAt(1e3 * safety.relative_slack, "stop above, if it persists,", "mm/s")}));
  plot.panels.push_back(RunPanel(
      runs, "Relative rotation", Axis("Slack", "°/s", 0.01), ChannelOf(RunChannel::kSlackRotation),
      1e-4,
      {LimitAt(safety.relative_slack_rotation * kDegrees, "stop above, if it persists,", "°/s")}));
  if (HasLinkPairs(runs))
    plot.panels.push_back(RunPanel(runs, "Approach of the links", Axis("Slack", "mm/s", 0.1),
                                   ChannelOf(RunChannel::kLimitSlack), 1e-3));
  return plot;
}

Plot EnergyPlot(const RunCurves& curves) {
  const RunData& run = curves.run();
  Plot plot = TimePlot({curves}, "energy", "Energy through the ports");
  const auto add = [&](const std::string& title, HandChannel channel) {
    PlotPanel panel{.title = title, .y = Axis("Energy", "J", 0.02)};
    for (const int i : run.present)
      panel.series.push_back(curves.Line(ChannelOf(i, channel), HandName(i), i, 1e-4));
    plot.panels.push_back(std::move(panel));
  };
  add("From the hands, at the real handles", HandChannel::kEnergy);
  add("From the coupling, at the virtual handles", HandChannel::kEnergyCoupling);
  PlotPanel stored{.title = "Stored in the virtual world since the start",
                   .y = Axis("Energy", "J", 0.02)};
  stored.series.push_back(curves.Line(ChannelOf(RunChannel::kStored), "", kPair, 1e-4));
  plot.panels.push_back(std::move(stored));
  plot.caption =
      "The plots show integrals of force times velocity and torque times angular velocity. The "
      "stored energy is the kinetic energy, the potential energy of the object, and the energy of "
      "the controller's springs.";
  return plot;
}

Plot OscillationPlot(const Runs& runs) {
  Plot plot = TimePlot(runs, "oscillation", "Oscillation of the hands' forces");
  PlotPanel index{.title = "Index: share of 3 to 10 Hz in 0 to 10 Hz",
                  .y = Axis("Index", ""),
                  .limits = {LimitAt(OscillationIndex::kWarn, "check above", ""),
                             LimitAt(OscillationIndex::kStop, "bad above", "")}};
  index.y.low = 0;
  index.y.high = 1;
  PlotPanel rms{.title = "Force from 3 to 10 Hz", .y = Axis("rms", "N", 0.1)};
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (int i = 0; i < kHands; ++i) {
      const RunData& run = runs[r].run();
      if (!run.Present(i)) continue;
      const auto& windows = run.oscillation[static_cast<std::size_t>(i)];
      std::vector<double> t, force, steps, y;
      for (const auto& window : windows) {
        t.push_back(window.time);
        force.push_back(window.rms);
        // The bar extends on each side to half the distance to the middle of the next window, so
        // that a single window is also visible.
        const double half = window.IsMeaningful() ? OscillationIndex::kWindow / 4 : 0;
        for (const double at : {window.time - half, window.time + half}) {
          steps.push_back(at);
          y.push_back(window.IsMeaningful() ? window.index : NAN);
        }
      }
      PlotSeries series{.label = Single(runs) ? HandName(i) : LabelOf(runs, r) + ", " + HandName(i),
                        .color = Single(runs) ? i : static_cast<int>(r),
                        .style = !Single(runs) && i == 1 ? LineStyle::kDashed : LineStyle::kSolid};
      series.SetPoints(std::move(steps), std::move(y));
      index.series.push_back(series);
      series.SetPoints(std::move(t), std::move(force));
      rms.series.push_back(std::move(series));
    }
  }
  plot.panels = {std::move(index), std::move(rms)};
  plot.caption =
      "Each bar shows a window of 4 s at its centre. A window is bad if its index exceeds 0.5 and "
      "its force varies by more than 3 N about the mean. The index is omitted where the force "
      "varies by 1 N or less about its mean. The index does not include motion slower than 3 Hz.";
  return plot;
}

Plot TickPlot(const RunCurves& curves) {
  const Runs runs = {curves};
  Plot plot = TimePlot(runs, "tick", "Computing time of each tick");
  PlotAxis axis = Axis("Time", "µs", 0, false);
  axis.log = true;
  plot.panels.push_back(RunPanel(runs, "The whole tick", axis, ChannelOf(RunChannel::kTick), 0.05,
                                 {LimitAt(1e6 * curves.run().dt, "period", "µs")}));
  return plot;
}

Plot TickHistogram(const Runs& runs) {
  Plot plot;
  plot.id = "tick-histogram";
  plot.title = "Ticks by their computing time";
  plot.x = Axis("Computing time of the whole tick", "µs");
  plot.x.log = true;
  PlotPanel panel{.y = Axis("Ticks", "")};
  panel.y.log = true;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunData& run = runs[r].run();
    std::vector<double> x, y;
    for (std::size_t k = 0; k < run.tick_counts.size(); ++k) {
      if (run.tick_counts[k] == 0 && Single(runs)) continue;
      x.push_back(std::pow(10, (static_cast<double>(k) + 0.5) / RunData::kTickBins));
      y.push_back(run.tick_counts[k] == 0 ? NAN : static_cast<double>(run.tick_counts[k]));
    }
    PlotSeries series{.label = Single(runs) ? "" : LabelOf(runs, r),
                      .kind = Single(runs) ? SeriesKind::kBars : SeriesKind::kLine,
                      .color = Single(runs) ? 0 : static_cast<int>(r),
                      .bar_width = std::pow(10, 1.0 / RunData::kTickBins)};
    series.SetPoints(std::move(x), std::move(y));
    panel.series.push_back(std::move(series));
  }
  panel.y.low = 0.5;
  plot.panels.push_back(std::move(panel));
  plot.caption = "Both axes are logarithmic, so a single tick is as visible as a million.";
  return plot;
}

}  // namespace predictor
