#include <algorithm>
#include <limits>
#include <utility>

#include "assessment/output.h"
#include "core/format.h"
#include "core/text.h"
#include "report/page.h"

namespace predictor::assessment {
namespace {

// A curve that is interrupted while no hand holds a handle.
struct Points {
  std::vector<double> x, y;
};

Points Interrupted(const std::vector<double>& times, const std::vector<double>& values,
                   double factor) {
  constexpr double kGap = 0.3;  // more than the interval of the intervals, 0.2 s [s]
  Points points;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && times[i] - times[i - 1] > kGap) {
      points.x.push_back((times[i] + times[i - 1]) / 2);
      points.y.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    points.x.push_back(times[i]);
    points.y.push_back(factor * values[i]);
  }
  return points;
}

PlotSeries LineOf(const std::string& label, int color, Points points) {
  PlotSeries line;
  line.label = label;
  line.color = color;
  line.SetPoints(std::move(points.x), std::move(points.y));
  return line;
}

PlotSeries AreaOf(const std::string& label, int color, Points high, Points low) {
  PlotSeries area = LineOf(label, color, std::move(high));
  area.kind = SeriesKind::kArea;
  area.base = MakeSamples(std::move(low.y));
  return area;
}

void AddCurve(const Assessment& a, const QuantityResult& q, int color, PlotPanel* panel) {
  const double factor = q.kind->unit.factor;
  if (!q.low.empty())
    panel->series.push_back(AreaOf(std::string(q.kind->label) + ", 90 % of the possible postures",
                                   color, Interrupted(a.sampled_times, q.high, factor),
                                   Interrupted(a.sampled_times, q.low, factor)));
  panel->series.push_back(LineOf(q.kind->label, color, Interrupted(a.times, q.values, factor)));
  if (q.kind->limit > 0) panel->limits.push_back({factor * q.kind->limit, q.kind->limit_name});
}

// The quantities of one group, in one panel for each unit and pair of quantities.
Plot GroupPlot(const Assessment& a, const std::string& group, const std::string& id) {
  Plot plot;
  plot.id = id;
  plot.title = group + " over time";
  plot.caption = std::string(
                     "Lines: the nominal posture. Areas: 90 % of the possible postures "
                     "and bodies. ") +
                 OperatorSentence(a);
  plot.x = {.label = "Run time", .unit = "s"};
  plot.group = "time";
  for (const QuantityResult& q : a.quantities) {
    if (group != q.kind->group) continue;
    PlotPanel* panel = plot.panels.empty() ? nullptr : &plot.panels.back();
    const bool joins = panel && panel->y.unit == q.kind->unit.shown && panel->series.size() < 4 &&
                       panel->limits.empty() && q.kind->limit == 0;
    if (!joins) {
      panel = &plot.panels.emplace_back();
      panel->y = {.label = q.kind->limit > 0 ? q.kind->label : group, .unit = q.kind->unit.shown};
    }
    const auto lines = std::ranges::count(panel->series, SeriesKind::kLine, &PlotSeries::kind);
    AddCurve(a, q, static_cast<int>(lines), panel);
  }
  return plot;
}

Plot ScorePlot(const Assessment& a) {
  Plot plot;
  plot.id = "scores";
  plot.title = "Scores of the worksheets";
  plot.caption =
      "Lines: the nominal posture. Areas: between the 5th and 95th percentile of the possible "
      "postures.";
  plot.x = {.label = "Run time", .unit = "s"};
  plot.group = "time";
  int color = 0;
  for (const WorksheetResult& w : a.worksheets) {
    PlotPanel panel;
    panel.y = {.label = w.kind->name, .low = 0, .high = w.kind->most};
    if (!w.likely_low.empty())
      panel.series.push_back(AreaOf("90 % of the possible postures", color,
                                    Interrupted(a.sampled_times, w.likely_high, 1),
                                    Interrupted(a.sampled_times, w.likely_low, 1)));
    panel.series.push_back(
        LineOf("nominal", color++, Interrupted(a.times, {w.values.begin(), w.values.end()}, 1)));
    plot.panels.push_back(panel);
  }
  return plot;
}

std::string QuantityTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {
      {"Quantity", "Mean", "p5", "p95", "Worst", "Tail, 90 %", "Origin"}};
  for (const QuantityResult& q : a.quantities) {
    const Unit& unit = q.kind->unit;
    const auto value = [&](double x) { return ValueText(*q.kind, x); };
    const std::string name = std::string(q.kind->group) + ", " + q.kind->label;
    rows.push_back(
        {EscapeMarkup(WithUnit(name, unit)), value(q.mean), value(q.p5), value(q.p95),
         value(q.worst()),
         q.tail_interval ? value(q.tail_interval->low) + " … " + value(q.tail_interval->high) : "–",
         Name(q.kind->origin)});
  }
  return HtmlTable(rows);
}

std::string ScoreTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {
      {"Method", "Score", "Share of time", "Probability", "What the method advises"}};
  for (const WorksheetResult& w : a.worksheets)
    for (std::size_t score = 1; score < w.share.size(); ++score) {
      const double likely = w.probability.empty() ? 0 : w.probability[score];
      if (w.share[score] < 0.0005 && likely < 0.0005) continue;
      rows.push_back({w.kind->name, std::to_string(score),
                      Formatted("%.1f %%", 100 * w.share[score]),
                      w.probability.empty() ? "–" : Formatted("%.1f %%", 100 * likely),
                      EscapeMarkup(w.kind->action(static_cast<int>(score)).sentence)});
    }
  return HtmlTable(rows);
}

template <class T>
void AddSentences(const std::string& id, const std::string& title, const std::vector<T>& list,
                  ReportPage* page) {
  if (list.empty()) return;
  page->Section(id, title);
  for (const T& entry : list) page->Paragraph(Sentence(entry));
}

void AddGroups(const Assessment& a, ReportPage* page) {
  std::string group;
  int number = 0;
  for (const QuantityResult& q : a.quantities) {
    if (group == q.kind->group) continue;
    group = q.kind->group;
    const std::string id = "group-" + std::to_string(++number);
    page->Section(id, group);
    page->Figure(GroupPlot(a, group, "plot-" + id));
  }
}

}  // namespace

std::string AssessmentPage(const Assessment& a, const std::string& program_version) {
  const BodySpec& body = a.setup.body;
  std::string words = "<p>" + EscapeMarkup(a.recording) + " · evaluated by PREDICTOR " +
                      EscapeMarkup(program_version) + "</p>\n";
  ReportPage page("The person in: " + a.scenario, words);
  page.Section("summary", "Summary");
  page.Paragraph(OperatorSentence(a) + " " + ReachSentence(a));
  for (const std::string& line : a.warnings) page.Paragraph("Warning: " + line);
  page.Paragraph(Formatted("Body: %s, %.2f m, %.0f kg.", body.sex == Sex::kMale ? "male" : "female",
                           body.height, body.mass));
  page.Html(QuantityTable(a));
  page.Paragraph(
      "p5 and p95: percentiles over the judged time, of the nominal posture. Tail: 90 % interval "
      "of "
      "p95 (of balance p5) over 64 possible postures and bodies.");
  page.Paragraph(OriginWords() + ".");
  page.Section("scores", "Scores");
  page.Html(ScoreTable(a));
  page.Figure(ScorePlot(a));
  AddGroups(a, &page);
  AddSentences("lifts", "Lifts (standard)", a.lifts, &page);
  AddSentences("damage", "Cumulative damage (standard)", a.damage, &page);
  AddSentences("fatigue", "Fatigue by 3CC-r (modelled)", a.fatigue, &page);
  page.Section("gaps", "Assumptions and gaps");
  for (const std::string& line : a.assumptions) page.Paragraph(line);
  for (const NotEvaluable& n : a.not_evaluable)
    page.Paragraph("Not evaluable: " + n.what + ", because " + n.why + ".");
  return page.Finish();
}

}  // namespace predictor::assessment
