// Writes a continuation as a page with plots.
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/continuation/continuation.h"
#include "core/format.h"
#include "core/text.h"
#include "report/page.h"

namespace predictor {
namespace {

constexpr double kBarWidth = 5;  // of the histogram [N]

// Returns the forces in one interval of kCurveStep for all runs that last that long.
std::vector<double> ForcesAt(const Continuation& c, std::size_t piece) {
  std::vector<double> forces;
  for (const ContinuedRun& run : c.runs)
    if (piece < run.force.size()) forces.push_back(run.force[piece]);
  return forces;
}

PlotSeries FanOf(const std::string& label, const Continuation& c, double low, double high) {
  PlotSeries area;
  area.label = label;
  area.kind = SeriesKind::kArea;
  std::vector<double> times, upper, lower;
  const auto pieces = static_cast<std::size_t>(std::lround(c.horizon / kCurveStep));
  for (std::size_t i = 0; i < pieces; ++i) {
    const std::vector<double> forces = ForcesAt(c, i);
    if (forces.empty()) break;
    times.push_back((static_cast<double>(i) + 0.5) * kCurveStep);
    upper.push_back(Quantile(forces, high));
    lower.push_back(Quantile(forces, low));
  }
  area.SetPoints(times, upper);
  area.base = MakeSamples(lower);
  return area;
}

PlotSeries CurveOf(const std::string& label, int color, const std::vector<double>& force) {
  PlotSeries line;
  line.label = label;
  line.color = color;
  std::vector<double> times;
  for (std::size_t i = 0; i < force.size(); ++i)
    times.push_back((static_cast<double>(i) + 0.5) * kCurveStep);
  line.SetPoints(times, force);
  return line;
}

Plot FanPlot(const Continuation& c) {
  Plot plot;
  plot.id = "force";
  plot.title = "Largest force of a hand, before the stop and without it";
  plot.caption =
      "The areas contain 90 % and 50 % of the possible operators at each time, without operators "
      "whose run had already ended with another fault. The largest force of a run can lie above "
      "the areas, because the areas apply to each time separately.";
  plot.x = {.label = "Time after the stop", .unit = "s"};
  plot.notes.push_back({0, "stop"});
  PlotPanel panel;
  panel.y = {.label = "Force", .unit = "N", .zero = true};
  panel.series.push_back(FanOf("90 % of the possible operators", c, 0.05, 0.95));
  panel.series.push_back(FanOf("50 %", c, 0.25, 0.75));
  panel.series.back().color = 0;
  PlotSeries past;
  past.label = "measured until the stop";
  past.color = 1;
  past.SetPoints(c.past_times, c.past_force);
  panel.series.push_back(past);
  if (c.reference)
    panel.series.push_back(CurveOf("the simulated operator itself", 2, c.reference->force));
  panel.limits.push_back({c.force_limit, "limit of the emulator"});
  plot.panels.push_back(panel);
  return plot;
}

Plot PeakPlot(const Continuation& c) {
  Plot plot;
  plot.id = "peak";
  plot.title = "Largest force of a hand without the stop";
  plot.caption = "Number of possible operators in each interval of 5 N.";
  plot.x = {.label = "Largest force", .unit = "N"};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const ContinuedRun& run : c.runs) {
    least = std::min(least, run.peak_force);
    most = std::max(most, run.peak_force);
  }
  const double first = kBarWidth * std::floor(least / kBarWidth);
  std::vector<double> centres, counts;
  for (double x = first; x <= most; x += kBarWidth) {
    centres.push_back(x + kBarWidth / 2);
    counts.push_back(
        static_cast<double>(std::ranges::count_if(c.runs, [x](const ContinuedRun& run) {
          return run.peak_force >= x && run.peak_force < x + kBarWidth;
        })));
  }
  PlotPanel panel;
  panel.y = {.label = "Operators", .zero = true};
  PlotSeries bars;
  bars.label = "possible operators";
  bars.kind = SeriesKind::kBars;
  bars.bar_width = 0.9 * kBarWidth;
  bars.SetPoints(centres, counts);
  panel.series.push_back(bars);
  plot.panels.push_back(panel);
  return plot;
}

std::string TableOf(const Continuation& c) {
  std::vector<std::vector<std::string>> rows = {{"Modelled", "5 %", "Median", "95 %"}};
  if (c.reference) rows.front().push_back("Simulated operator");
  for (const ContinuationQuantity& q : kContinuationQuantities) {
    const Interval90 range = c.IntervalOf(q.value);
    const auto cell = [&](const CensoredValue& value) {
      return std::isfinite(value.value) ? BoundText(value, q.format) : std::string("–");
    };
    rows.push_back({q.label, cell(range.low), cell(range.median), cell(range.high)});
    if (c.reference)
      rows.back().push_back(cell({(*c.reference).*q.value, c.reference->ending == Ending::kFault}));
  }
  return HtmlTable(rows);
}

}  // namespace

std::string ContinuationPage(const Continuation& c, const std::string& recording,
                             const std::string& program_version) {
  ReportPage page("Without the stop: " + c.scenario, "<p>" + EscapeMarkup(recording) +
                                                         " · continued by PREDICTOR " +
                                                         EscapeMarkup(program_version) + "</p>\n");
  page.Section("summary", "Summary");
  page.Paragraph(Formatted(
      "The emulator stopped this run after %.3f s. Cause: '%s', %s. The run itself shows only that "
      "the largest force was at least %.1f N. %zu possible operators continued the run for %.2g s.",
      c.time, Name(c.cause.cause),
      SeenAndAllowed(c.cause.value, c.cause.limit, c.cause.quantity).c_str(), c.peak_before,
      c.runs.size(), c.horizon));
  page.Html(TableOf(c));
  page.Paragraph("How it would have ended: " + EndingWords(c) + ".");
  page.Section("course", "Course");
  page.Figure(FanPlot(c));
  page.Figure(PeakPlot(c));
  page.Section("assumptions", "Assumptions and gaps");
  for (const std::string& line : ContinuationAssumptions(c)) page.Paragraph(line);
  return page.Finish();
}

}  // namespace predictor
