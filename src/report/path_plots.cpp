// Plots the paths of the object and the handles.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "report/plot_parts.h"
#include "report/run_plots.h"

namespace predictor {
namespace {

// `a` and `b` are the indices of the coordinates in W that the path's horizontal and vertical axes
// on the page show.
Plot PathPlot(const Runs& runs, const char* id, const char* title, std::size_t a, std::size_t b) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  Plot plot;
  plot.id = id;
  plot.title = title;
  plot.equal_axes = true;
  plot.x = Axis(kAxes[a], "m", 0.02, false);
  PlotPanel panel{.y = Axis(kAxes[b], "m", 0.02, false)};
  const auto add = [&](const std::array<std::vector<float>, 3>& path, const std::string& label,
                       int color, LineStyle style) {
    PlotSeries series{.label = label, .kind = SeriesKind::kPath, .color = color, .style = style};
    series.SetPoints({path[a].begin(), path[a].end()}, {path[b].begin(), path[b].end()});
    series.resolution = 1e-4;
    panel.series.push_back(std::move(series));
  };
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const RunData& run = runs[r].run();
    add(run.object_path, Single(runs) ? "object" : LabelOf(runs, r),
        Single(runs) ? kPair : static_cast<int>(r), LineStyle::kSolid);
    if (!Single(runs)) continue;
    for (int i = 0; i < kHands; ++i)
      if (run.Present(i))
        add(run.handle_paths[static_cast<std::size_t>(i)], std::string(HandName(i)) + " handle", i,
            LineStyle::kSolid);
  }
  const RunData& run = First(runs);
  const GuidanceSpec& guidance = run.info.scenario.guidance;
  if (guidance.type == "circle") {
    std::array<std::vector<float>, 3> circle;
    for (int k = 0; k <= 180; ++k) {
      const double angle = 2 * std::numbers::pi * k / 180;
      const double offset[] = {guidance.radius * std::cos(angle), guidance.radius * std::sin(angle),
                               0};
      for (std::size_t c = 0; c < 3; ++c)
        circle[c].push_back(static_cast<float>(
            run.object_start[c] + guidance.center[static_cast<Eigen::Index>(c)] + offset[c]));
    }
    add(circle, "guidance", 6, LineStyle::kDashed);
  }
  plot.panels.push_back(std::move(panel));
  return plot;
}

}  // namespace

std::vector<Plot> PathPlots(const Runs& runs) {
  std::vector<Plot> plots;
  plots.push_back(PathPlot(runs, "path-top", "The path from above", 0, 1));
  plots.push_back(PathPlot(runs, "path-side", "The path from the side", 0, 2));
  plots.back().caption =
      "The paths are in the world frame, with one point every 50 ms. The positions of the object "
      "are those of its origin, and the positions of the handles are measured. Both axes have the "
      "same scale.";
  return plots;
}

}  // namespace predictor
