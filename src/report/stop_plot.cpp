// Plots every tick before and after a stop.
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "report/plot_parts.h"
#include "report/run_plots.h"

namespace predictor {

Plot StopPlot(const RunCurves& curves, const ReportedStop& stop, std::size_t number) {
  const RunData& run = curves.run();
  Plot plot;
  plot.id = "stop-" + std::to_string(number);
  plot.title = "The ten seconds before the stop at " + Round(stop.summary.time, 5) + " s";
  plot.x = Axis("Time from the decision", "s");
  const auto before = static_cast<std::uint64_t>(Trace::kBefore / run.dt);
  const auto after = static_cast<std::uint64_t>(1 / run.dt);
  const std::uint64_t from = std::max(run.first, stop.tick - std::min(stop.tick, before));
  const std::uint64_t to = std::min(run.last, stop.tick + after);
  const auto line = [&](std::size_t channel, const std::string& label, int color,
                        double resolution) {
    std::vector<double> t, y;
    run.trace.Part(from, to, stop.tick, channel, &t, &y);
    PlotSeries series{.label = label, .color = color, .resolution = resolution};
    series.SetPoints(std::move(t), std::move(y));
    return series;
  };
  const auto panel = [&](const std::string& title, const PlotAxis& axis, HandChannel channel,
                         double resolution, std::vector<PlotLimit> limits) {
    PlotPanel p{.title = title, .y = axis, .limits = std::move(limits)};
    for (const int i : run.present)
      p.series.push_back(line(ChannelOf(i, channel), HandName(i), i, resolution));
    plot.panels.push_back(std::move(p));
  };
  const SafetySpec& safety = run.info.scenario.safety;
  panel("Force of the hands", Axis("Force", "N", 1), HandChannel::kForce, 0.005,
        {LimitAt(ThresholdOf(run, Parameter::kForceThreshold), "stop above", "N")});
  panel("Torque of the hands", Axis("Torque", "N·m", 0.1), HandChannel::kTorque, 5e-4,
        {LimitAt(ThresholdOf(run, Parameter::kTorqueThreshold), "stop above", "N·m")});
  panel("Speed of the real handles", Axis("Speed", "mm/s", 1), HandChannel::kSpeed, 0.02,
        {LimitAt(1e3 * safety.handle_speed, "cap", "mm/s")});
  panel("Distance of real and virtual handle", Axis("Distance", "mm", 0.05), HandChannel::kError,
        1e-4, {LimitAt(1e3 * safety.tracking, "stop above", "mm")});
  if (stop.summary.cause == StopCause::kCoupling)
    panel("Force of the coupling", Axis("Force", "N", 1), HandChannel::kCouplingForce, 0.005,
          {LimitAt(safety.coupling, "stop above", "N")});
  if (stop.summary.cause == StopCause::kLinkDistance)
    plot.panels.push_back(
        {.title = "Distance of the nearest link pair",
         .y = Axis("Distance", "m", 0.25, false),
         .series = {line(ChannelOf(RunChannel::kLinkDistance), "", kPair, 1e-4)},
         .limits = {LimitAt(run.info.scenario.rendering.security_distance, "stop below", "m")}});
  plot.notes.push_back({0, std::string("decided: ") + Name(stop.summary.cause)});
  if (!DidNotRest(stop.summary)) plot.notes.push_back({stop.summary.duration, "at rest"});
  for (const ReportedEvent& event : run.events)
    if (event.tick >= from && event.tick < stop.tick && plot.notes.size() < kMaxNotes &&
        event.text.rfind("state ", 0) != 0)
      plot.notes.push_back(
          {(static_cast<double>(event.tick) - static_cast<double>(stop.tick)) * run.dt,
           event.text.substr(0, 40)});
  plot.caption = "Every tick.";
  return plot;
}

}  // namespace predictor
