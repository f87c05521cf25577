// Writes the page of a population study. For each quantity, the page shows every person as a dot,
// the differences person by person, and the curve over the height of the handles.
#include "report/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "analysis/population/population.h"
#include "assessment/design_differences.h"
#include "assessment/output_picture.h"
#include "core/format.h"
#include "core/person_state.h"
#include "core/text.h"
#include "evaluation/statistics_samples.h"

namespace predictor::population {
namespace {

constexpr double kHalfWidth = 0.36;  // half-width of a cloud of dots, in designs

struct Points {
  std::vector<double> x, y, error;
  void Add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

PlotSeries Series(const std::string& label, SeriesKind kind, int color, Points points) {
  PlotSeries series{.label = label, .kind = kind, .color = color};
  series.SetPoints(std::move(points.x), std::move(points.y));
  if (!points.error.empty()) series.error = MakeSamples(std::move(points.error));
  return series;
}

std::size_t QuantityAt(const std::string& path) {
  const auto all = StudyQuantities();
  return static_cast<std::size_t>(
      std::ranges::find_if(all, [&](const StudyQuantity& q) { return path == q.path; }) -
      all.begin());
}

bool HasValue(const PopulationRun& run, std::size_t quantity) {
  return quantity < run.values.size() && std::isfinite(run.values[quantity]);
}

bool IsWhole(const PopulationRun& run, std::size_t quantity) {
  return run.cause == StopCause::kNone && HasValue(run, quantity);
}

// Places dots of equal height side by side. Values are grouped into rows, and the dots of a row are
// distributed symmetrically about `at`.
void AddCloud(double at, std::vector<double> values, Points* points) {
  if (values.empty()) return;
  std::ranges::sort(values);
  const double range = values.back() - values.front();
  const double row = std::max(range / 40, 1e-12);
  const double step = 2 * kHalfWidth / 24;
  for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
    while (end < values.size() && values[end] < values[begin] + row) ++end;
    const auto n = static_cast<double>(end - begin);
    const double space = std::min(step, 2 * kHalfWidth / std::max(1.0, n - 1));
    for (std::size_t i = begin; i < end; ++i)
      points->Add(at + (static_cast<double>(i - begin) - (n - 1) / 2) * space, values[i]);
  }
}

std::vector<std::string> DesignNames(const PopulationStudy& study) {
  std::vector<std::string> names;
  for (const PopulationDesign& design : study.designs) names.push_back(design.name);
  return names;
}

// Returns the values of whole runs, or the bounds that stopped runs give.
std::vector<double> ValuesOf(const PopulationDesign& design, std::size_t quantity, bool whole,
                             double factor) {
  std::vector<double> values;
  for (const PopulationRun& run : design.runs)
    if (HasValue(run, quantity) && IsWhole(run, quantity) == whole)
      values.push_back(factor * run.values[quantity]);
  return values;
}

PlotAxis DesignAxis(std::vector<std::string> names) {
  PlotAxis axis{.label = "Design"};
  axis.low = -0.5;
  axis.high = static_cast<double>(names.size()) - 0.5;
  axis.names = std::move(names);
  return axis;
}

// Returns a sentence that begins with a space, or "".
std::string CaveatOf(const StudyQuantity& kind) {
  return kind.limit == kCompressionLimit ? std::string(" ") + kCompressionCaveat : "";
}

// Shows every person as a dot, with the median and the range of 90 % of the people.
PlotPanel PeoplePanel(const PopulationStudy& study, std::size_t quantity) {
  const StudyQuantity& kind = StudyQuantities()[quantity];
  const double factor = kind.unit.factor;
  PlotPanel panel;
  panel.y = {.label = kind.label, .unit = kind.unit.shown};
  Points people, stopped, medians;
  for (std::size_t i = 0; i < study.designs.size(); ++i) {
    const auto at = static_cast<double>(i);
    AddCloud(at, ValuesOf(study.designs[i], quantity, true, factor), &people);
    AddCloud(at, ValuesOf(study.designs[i], quantity, false, factor), &stopped);
    medians.Add(at, factor * study.summaries[i][quantity].median.value);
  }
  panel.series.push_back(Series("one person each", SeriesKind::kMarkers, 0, people));
  if (!stopped.x.empty())
    panel.series.push_back(Series("bound of a stopped run", SeriesKind::kMarkers, 2, stopped));
  PlotSeries middle = Series("median", SeriesKind::kMarkers, 1, medians);
  middle.symbol = PlotSymbol::kDiamond;
  panel.series.push_back(middle);
  if (kind.has_limit()) panel.limits.push_back({factor * kind.limit, kind.limit_name});
  return panel;
}

Plot PeoplePlot(const PopulationStudy& study, std::size_t quantity) {
  const StudyQuantity& kind = StudyQuantities()[quantity];
  Plot plot;
  plot.id = std::string("people-") + std::to_string(quantity);
  plot.title = std::string(kind.label) + ": every person";
  plot.caption = std::string("Each dot is one simulated person (") +
                 assessment::Name(kind.origin, true) + "). The same people perform every design.";
  plot.caption += CaveatOf(kind);
  plot.x = DesignAxis(DesignNames(study));
  plot.panels = {PeoplePanel(study, quantity)};
  return plot;
}

// Shows how each person's values differ from the values of the same person in the first design.
Plot DifferencePlot(const PopulationStudy& study, std::size_t quantity) {
  const StudyQuantity& kind = StudyQuantities()[quantity];
  const double factor = kind.unit.factor;
  Plot plot;
  plot.id = std::string("differences-") + std::to_string(quantity);
  plot.title = std::string(kind.label) + ": difference for the same person";
  plot.caption =
      "Each dot is one person's value minus the same person's value in '" +
      study.designs.front().name +
      "'. People with a stopped run have no dot. The diamonds show the Hodges-Lehmann "
      "estimate with its 95 % interval, which includes what the stopped runs leave open.";
  Points people, shifts;
  std::vector<std::string> names;
  for (const PairedDifference& d : study.differences) {
    if (d.b != 0 || d.quantity != quantity) continue;
    const auto at = static_cast<double>(names.size());
    names.push_back(study.designs[d.a].name);
    std::vector<double> values;
    for (std::size_t i = 0; i < study.people.size(); ++i) {
      const PopulationRun& a = study.designs[d.a].runs[i];
      const PopulationRun& b = study.designs[d.b].runs[i];
      if (IsWhole(a, quantity) && IsWhole(b, quantity))
        values.push_back(factor * (a.values[quantity] - b.values[quantity]));
    }
    AddCloud(at, values, &people);
    shifts.Add(at, factor * d.shift.estimate);
    shifts.error.push_back(factor * (d.shift.upper - d.shift.lower) / 2);
  }
  PlotPanel panel;
  panel.y = {.label = "Difference", .unit = kind.unit.shown, .zero = true};
  panel.series.push_back(Series("one person each", SeriesKind::kMarkers, 0, people));
  PlotSeries middle = Series("shift, 95 %", SeriesKind::kMarkers, 1, shifts);
  middle.symbol = PlotSymbol::kDiamond;
  panel.series.push_back(middle);
  plot.x = DesignAxis(std::move(names));
  plot.panels = {panel};
  return plot;
}

// Returns the designs of one scenario, by height.
std::vector<std::size_t> ByHeight(const PopulationStudy& study, const std::string& scenario) {
  std::vector<std::size_t> designs;
  for (std::size_t i = 0; i < study.designs.size(); ++i)
    if (study.designs[i].scenario == scenario && study.designs[i].height) designs.push_back(i);
  std::ranges::sort(designs, {}, [&](std::size_t i) { return *study.designs[i].height; });
  return designs;
}

Plot HeightPlot(const PopulationStudy& study, std::size_t quantity) {
  const StudyQuantity& kind = StudyQuantities()[quantity];
  const double factor = kind.unit.factor;
  Plot plot;
  plot.id = std::string("height-") + std::to_string(quantity);
  plot.title = std::string(kind.label) + " over the height of the handles";
  plot.caption =
      "Lines: the median person. The shaded areas contain 90 % of the people." + CaveatOf(kind);
  plot.x = {.label = "Height of the handles above the ground", .unit = "m"};
  PlotPanel panel;
  panel.y = {.label = kind.label, .unit = kind.unit.shown};
  std::set<std::string> scenarios;
  for (const PopulationDesign& design : study.designs) scenarios.insert(design.scenario);
  int color = 0;
  for (const std::string& scenario : scenarios) {
    Points median, high, low;
    for (const std::size_t i : ByHeight(study, scenario)) {
      const DesignSummary& s = study.summaries[i][quantity];
      const double at = *study.designs[i].height;
      median.Add(at, factor * s.median.value);
      high.Add(at, factor * s.p95.value);
      low.Add(at, factor * s.p5.value);
    }
    PlotSeries area =
        Series(scenario + ", 90 % of the people", SeriesKind::kArea, color, std::move(high));
    area.base = MakeSamples(std::move(low.y));
    panel.series.push_back(area);
    panel.series.push_back(Series(scenario, SeriesKind::kLine, color++, std::move(median)));
  }
  if (kind.has_limit()) panel.limits.push_back({factor * kind.limit, kind.limit_name});
  plot.panels = {panel};
  return plot;
}

// Returns the share of time at each score [0 … 1], averaged over the people whose run was not
// stopped.
std::array<double, kRulaScores> MeanShares(const PopulationDesign& design) {
  std::array<double, kRulaScores> mean = {};
  double people = 0;
  for (const PopulationRun& run : design.runs) {
    if (run.cause != StopCause::kNone) continue;
    people += 1;
    for (std::size_t score = 0; score < kRulaScores; ++score) mean[score] += run.rula_share[score];
  }
  for (double& share : mean) share /= std::max(people, 1.0);
  return mean;
}

// Draws a bar for each design. The colours run from green to dark red, with the action level.
std::string RulaBars(const PopulationStudy& study) {
  struct Level {
    std::size_t from, to;  // scores
    const char* name;
  };
  constexpr std::array kLevels = {Level{1, 2, "1 to 2: acceptable"},
                                  Level{3, 4, "3 to 4: investigate"},
                                  Level{5, 6, "5 to 6: change soon"}, Level{7, 7, "7: change now"}};
  const auto color = [&](std::size_t level) {
    return assessment::LoadColor(static_cast<double>(level) /
                                 static_cast<double>(kLevels.size() - 1));
  };
  std::string html = "<div class=\"scores\">";
  for (const PopulationDesign& design : study.designs) {
    const auto shares = MeanShares(design);
    html += "<b>" + EscapeMarkup(design.name) + "</b><span></span><div class=\"shares\">";
    for (std::size_t i = 0; i < kLevels.size(); ++i) {
      double share = 0;
      for (std::size_t score = kLevels[i].from; score <= kLevels[i].to; ++score)
        share += shares[score];
      if (share < 0.0005) continue;
      const std::string percent = Formatted("%.0f %%", 100 * share);
      Append(&html, "<span style=\"flex-grow: %.4f; background: %s%s\" title=\"%s: %s\">%s</span>",
             share, color(i).c_str(), i == kLevels.size() - 1 ? "; color: #fff" : "",
             kLevels[i].name, percent.c_str(), share < 0.06 ? "" : percent.c_str());
    }
    html += "</div>";
  }
  html += "</div>\n<p class=\"scale\">";
  for (std::size_t i = 0; i < kLevels.size(); ++i)
    Append(&html, "<i class=\"patch\" style=\"background: %s\"></i>%s ", color(i).c_str(),
           kLevels[i].name);
  return html +
         "</p>\n<p class=\"caption\">Share of time at each action level, averaged over the people "
         "whose run was not stopped.</p>\n";
}

// Returns the limit with the side that is beyond it, such as "> 3400", or a dash.
std::string BeyondText(const StudyQuantity& kind) {
  if (!kind.has_limit()) return "–";
  return (kind.bad == assessment::Bad::kHigh ? "> " : "< ") +
         Fixed(kind.unit.factor * kind.limit, kind.unit.decimals);
}

std::string SummaryTable(const PopulationStudy& study) {
  std::vector<std::vector<std::string>> rows = {
      {"Quantity", "Design", "Median", "90 % of the people", "Limit", "People beyond"}};
  for (std::size_t q = 0; q < StudyQuantities().size(); ++q) {
    const StudyQuantity& kind = StudyQuantities()[q];
    for (std::size_t i = 0; i < study.designs.size(); ++i) {
      const DesignSummary& s = study.summaries[i][q];
      const auto value = [&](const CensoredValue& x) {
        return s.people > 0 ? Shown(kind, x) : std::string("–");
      };
      const std::string name = EscapeMarkup(WithUnit(kind.label, kind.unit)) + "<br><small>" +
                               assessment::Name(kind.origin, true) + "</small>";
      rows.push_back(
          {i == 0 ? name : "", EscapeMarkup(study.designs[i].name), value(s.median),
           s.people > 0 ? value(s.p5) + " to " + value(s.p95) : "–", EscapeMarkup(BeyondText(kind)),
           kind.has_limit() && s.people > 0 ? Formatted("%.0f %%", 100 * s.beyond.value()) : "–"});
    }
  }
  return HtmlTable(rows);
}

// States where the limits come from.
std::string LimitWords() {
  std::string words = "Limits:";
  for (const StudyQuantity& kind : StudyQuantities())
    if (kind.has_limit())
      words += std::string(words.back() == ':' ? " " : "; ") + kind.label + ": " + kind.limit_name;
  return words + ". " + kCompressionCaveat;
}

}  // namespace

std::string PopulationPage(const PopulationStudy& study, const std::string& program_version) {
  ReportPage page("A population of simulated people",
                  "<p>Studied by PREDICTOR " + EscapeMarkup(program_version) + "</p>\n");
  page.Section("summary", "Summary");
  page.Paragraph(Formatted(
      "%zu simulated people with different bodies perform %zu designs. No real person took part.",
      study.people.size(), study.designs.size()));
  for (const std::string& line : study.warnings)
    page.Html("<p class=\"warning\">Warning: " + EscapeMarkup(line) + "</p>\n");
  page.Html(SummaryTable(study));
  page.Paragraph(
      "For each person's 95th percentile over time (5th percentile for balance), the table shows "
      "the median over the people and the range of 90 % of the people. The column \"People "
      "beyond\" "
      "shows the share of the people who exceed the limit. If the emulator stopped a run, only a "
      "bound of the person's value is known. The quantiles are those of Kaplan and Meier, and a "
      "quantile that is itself only a bound has the sign ≥ or ≤.");
  page.Paragraph(LimitWords());
  if (!study.differences_of_designs.empty()) {
    page.Paragraph(assessment::kDesignsDiffer);
    std::string list;
    for (const std::string& line : study.differences_of_designs)
      list += "<li>" + EscapeMarkup(line) + "</li>\n";
    page.Html("<ul>\n" + list + "</ul>\n");
  }
  for (const PopulationDesign& design : study.designs)
    if (const std::string beyond = BeyondLifftSentence(design); !beyond.empty())
      page.Paragraph(beyond);
  const bool has_heights = std::ranges::any_of(study.designs, [&](const PopulationDesign& design) {
    return ByHeight(study, design.scenario).size() > 1;
  });
  if (study.designs.size() > 1) {
    page.Section("rula", "Postures by RULA");
    page.Html(RulaBars(study));
  }
  for (const char* path : {"lower_back_compression_n", "hand_force_n", "shoulder_use", "elbow_use",
                           "trunk_flexion_rad", "upper_arm_elevation_rad"}) {
    const std::size_t quantity = QuantityAt(path);
    page.Section(std::string("quantity-") + std::to_string(quantity),
                 StudyQuantities()[quantity].label);
    page.Figure(PeoplePlot(study, quantity));
    if (has_heights) page.Figure(HeightPlot(study, quantity));
    if (study.designs.size() > 1) page.Figure(DifferencePlot(study, quantity));
  }
  return page.Finish();
}

}  // namespace predictor::population
