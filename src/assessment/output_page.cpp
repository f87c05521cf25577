#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "assessment/joint_quantities.h"
#include "assessment/output.h"
#include "assessment/output_picture.h"
#include "assessment/safety/output.h"
#include "core/format.h"
#include "core/person_state.h"
#include "core/text.h"
#include "report/page.h"

namespace predictor::assessment {
namespace {

// A curve with gaps where no hand holds a handle.
struct Points {
  std::vector<double> x, y;
};

Points Interrupted(const std::vector<double>& times, const std::vector<double>& values,
                   double factor) {
  constexpr double kGap = 0.3;  // longer than the step of the intervals, 0.2 s [s]
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

constexpr double kSmallestRange = 4;  // smallest range of a panel, in steps of the last digit that
                                      // tables show

// Plots the quantities of one group, with one panel for each unit and left-right pair.
Plot GroupPlot(const Assessment& a, const std::string& group, const std::string& id) {
  Plot plot;
  plot.id = id;
  plot.title = group + " over time";
  plot.caption = "Lines: the nominal posture. ";
  plot.x = {.label = "Run time", .unit = "s"};
  plot.group = "time";
  bool intervals = false;
  for (const QuantityResult& q : a.quantities) {
    if (group != q.kind->group || q.kind->only_in_files) continue;
    intervals = intervals || !q.low.empty();
    PlotPanel* panel = plot.panels.empty() ? nullptr : &plot.panels.back();
    const bool joins = panel && panel->y.unit == q.kind->unit.shown && panel->series.size() < 4 &&
                       panel->limits.empty() && q.kind->limit == 0;
    if (!joins) {
      panel = &plot.panels.emplace_back();
      panel->y = {.label = q.kind->limit > 0 ? q.kind->label : group,
                  .unit = q.kind->unit.shown,
                  .least = kSmallestRange * std::pow(10, -q.kind->unit.decimals)};
    }
    const auto lines = std::ranges::count(panel->series, SeriesKind::kLine, &PlotSeries::kind);
    AddCurve(a, q, static_cast<int>(lines), panel);
  }
  if (intervals)
    plot.caption += "The shaded areas contain 90 % of the possible postures and bodies. ";
  const bool compression = std::ranges::any_of(a.quantities, [&](const QuantityResult& q) {
    return group == q.kind->group && q.kind->limit == kCompressionLimit;
  });
  if (compression) plot.caption += std::string(kCompressionCaveat) + " ";
  plot.caption += OperatorSentence(a);
  return plot;
}

// Returns the scores over time, with gaps where the posture is unknown.
std::vector<double> ScoresOf(const WorksheetResult& w) {
  std::vector<double> scores;
  for (const int score : w.values)
    scores.push_back(score > 0 ? score : std::numeric_limits<double>::quiet_NaN());
  return scores;
}

Plot ScorePlot(const Assessment& a) {
  Plot plot;
  plot.id = "person-scores";
  plot.title = "Scores of the worksheets over time";
  plot.caption =
      "Lines: the nominal posture. The shaded areas lie between the 5th and 95th percentile of the "
      "possible postures.";
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
    panel.series.push_back(LineOf("nominal", color++, Interrupted(a.times, ScoresOf(w), 1)));
    plot.panels.push_back(panel);
  }
  return plot;
}

// Structures the parts of an assessment on a page: as chapters, or as parts of one chapter.
class Outline {
 public:
  Outline(ReportPage* page, bool chapters) : page_(page), chapters_(chapters) {}
  void Begin(const std::string& id, const std::string& title) {
    if (chapters_)
      page_->Section("person-" + id, title);
    else
      page_->Html("<h3 id=\"person-" + id + "\">" + EscapeMarkup(title) + "</h3>\n");
  }
  ReportPage& page() const { return *page_; }

 private:
  ReportPage* page_;
  bool chapters_;
};

std::string RangeOrDash(const QuantityKind& kind, const std::optional<person::Interval>& range) {
  return range ? RangeText(kind, range) : "–";
}

std::string QuantityTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {
      {"Quantity", "Mean", "p5", "p95", "Worst", "Tail, 90 %", "Limit", "Origin"}};
  for (const QuantityResult& q : a.quantities) {
    const QuantityKind& kind = *q.kind;
    if (!kind.has_row()) continue;
    const auto value = [&](double x) { return ValueText(kind, x); };
    const std::string name = std::string(kind.group) + ", " + kind.label;
    rows.push_back({EscapeMarkup(WithUnit(name, kind.unit)), value(q.mean), value(q.p5),
                    value(q.p95), value(q.worst()), RangeOrDash(kind, q.tail_interval),
                    kind.limit > 0 ? value(kind.limit) : "–", Name(kind.origin, a.simulated())});
  }
  return HtmlTable(rows);
}

std::string Percent(double share) { return Formatted("%.1f %%", 100 * share); }

// Draws a bar of a worksheet's scores. The width of each segment is the share of its score, and its
// colour stands for the advised action.
std::string ScoreBar(const WorksheetResult& w, const std::vector<double>& shares) {
  const int levels = w.kind->action(w.kind->most).level;
  std::string html = "<div class=\"shares\">";
  for (std::size_t score = 1; score < shares.size(); ++score) {
    if (shares[score] < 0.0005) continue;
    const int level = w.kind->action(static_cast<int>(score)).level;
    const double severity = static_cast<double>(level - 1) / (levels - 1);
    Append(&html,
           "<span style=\"flex-grow: %.4f; background: %s%s\" title=\"score %zu: %s\">%s</span>",
           shares[score], LoadColor(severity).c_str(), severity > 0.7 ? "; color: #fff" : "", score,
           Percent(shares[score]).c_str(),
           shares[score] < 0.03 ? "" : std::to_string(score).c_str());
  }
  return html + "</div>";
}

std::string ScoreBars(const Assessment& a) {
  std::string html;
  for (const WorksheetResult& w : a.worksheets)
    html += "<p>" + EscapeMarkup(Sentence(w)) + "</p>\n";
  html += "<div class=\"scores\">";
  for (const WorksheetResult& w : a.worksheets) {
    html += std::string("<b>") + w.kind->name + "</b><span>nominal posture</span>" +
            ScoreBar(w, w.share);
    if (!w.probability.empty())
      html += "<b></b><span>possible postures</span>" + ScoreBar(w, w.probability);
  }
  return html +
         "</div>\n<p class=\"caption\">Bars: the share of time at each score in the nominal "
         "posture, and the probability of each score over the possible postures. Colours: what the "
         "method advises, from no action "
         "(light green) to action now (dark red).</p>\n";
}

std::string ScoreTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {
      {"Method", "Score", "Share of time, nominal posture", "Probability, possible postures",
       "What the method advises"}};
  for (const WorksheetResult& w : a.worksheets)
    for (std::size_t score = 1; score < w.share.size(); ++score) {
      const double likely = w.probability.empty() ? 0 : w.probability[score];
      if (w.share[score] < 0.0005 && likely < 0.0005) continue;
      rows.push_back({w.kind->name, std::to_string(score), Percent(w.share[score]),
                      w.probability.empty() ? "–" : Percent(likely),
                      EscapeMarkup(w.kind->action(static_cast<int>(score)).sentence)});
    }
  return HtmlTable(rows);
}

std::string DamageTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {
      {"Part", "Method", "One run", "A shift of such runs", "Probability"}};
  for (const DamageResult& d : a.damage)
    rows.push_back({EscapeMarkup(d.part), EscapeMarkup(d.tool + RangeWords(d)),
                    Formatted("%.3g %%", 100 * d.day_share),
                    Formatted("%.3g %%", 100 * d.shift_share), Percent(d.probability)});
  return HtmlTable(rows);
}

std::string FatigueTable(const Assessment& a) {
  std::vector<std::vector<std::string>> rows = {
      {"Joint", "Mean load", "Model", "Strength left", "Too much after"}};
  for (const FatigueResult& f : a.fatigue) {
    const auto add = [&](const char* model, const FatigueCourse& course) {
      rows.push_back({EscapeMarkup(f.joint), Percent(f.mean_load), EscapeMarkup(model),
                      Percent(course.capacity), MinutesText(course.time_to_limit)});
    };
    add("3CC-r", f.compartments);
    add(kMaModel, f.ma);
    if (f.trial) add(kTrialModel, *f.trial);
    rows.push_back({EscapeMarkup(f.joint), Percent(f.mean_load), kEnduranceModel, "–",
                    MinutesText(f.endurance)});
  }
  return HtmlTable(rows);
}

void AddLimits(const Assessment& a, Outline* outline) {
  if (a.limits.empty()) return;
  outline->Begin("limits", "Limits of your files (standard)");
  for (const LimitResult& limit : a.limits) outline->page().Paragraph(Sentence(limit));
}

void AddCosts(const Assessment& a, Outline* outline) {
  ReportPage& page = outline->page();
  if (!a.lifts.empty()) outline->Begin("lifts", "Lifts and lowerings (standard)");
  for (const Lift& lift : a.lifts) page.Paragraph(Sentence(lift));
  if (a.job) page.Paragraph(Sentence(*a.job));
  outline->Begin("damage", "Cumulative damage (standard)");
  page.Html(DamageTable(a));
  page.Html(
      "<p class=\"caption\">The values are shares of the reference day. For the damage of the "
      "reference day, the method gives a probability of one half that the job causes many "
      "injuries. This probability is not the risk of a single person.</p>\n");
  outline->Begin("fatigue", "Fatigue (modelled)");
  page.Html(FatigueTable(a));
  page.Html(
      "<p class=\"caption\">As shares of strength. Too much after: the time after which a "
      "repetition of the run, without a break, needs more strength than is left. The measured "
      "endurance is the time for which people held the mean load without moving (Frey-Law &amp; "
      "Avin 2010).</p>\n");
  outline->Begin("hand-activity", "Hand activity, ACGIH (standard)");
  for (const HandActivity& activity : a.hand_activity) page.Paragraph(Sentence(activity));
}

void AddGroups(const Assessment& a, Outline* outline) {
  std::string group;
  int number = 0;
  for (const QuantityResult& q : a.quantities) {
    // The table shows the other quantities of the joints, and the CSV file contains them over time.
    const bool only_table = q.kind->of_joint && q.kind->group != std::string_view(kJointTorques);
    if (group == q.kind->group || only_table) continue;
    group = q.kind->group;
    const std::string id = "group-" + std::to_string(++number);
    outline->Begin(id, group);
    outline->page().Figure(GroupPlot(a, group, "person-plot-" + id));
  }
}

void AddJoints(const Assessment& a, Outline* outline) {
  outline->Begin("joints", "Joints of the arms (modelled)");
  auto rows = JointTable(a);
  for (auto& row : rows)
    for (std::string& cell : row) cell = EscapeMarkup(cell);
  outline->page().Html(HtmlTable(rows));
  outline->page().Paragraph(JointTableWords());
}

void AddSummary(const Assessment& a, ReportPage* page) {
  const BodySpec& body = a.setup.body;
  page->Paragraph(OperatorSentence(a) + " " + ReachSentence(a));
  for (const std::string& line : a.warnings)
    page->Html("<p class=\"warning\">Warning: " + EscapeMarkup(line) + "</p>\n");
  page->Paragraph(Formatted("Body: %s, %.2f m, %.0f kg.",
                            body.sex == Sex::kMale ? "male" : "female", body.height, body.mass));
  page->Html(PicturesHtml(a));
}

void AddMeasured(const MeasuredBody& measured, Outline* outline) {
  if (measured.tracks.empty()) return;
  outline->Begin("measured", "Measured in addition to the hands");
  ReportPage& page = outline->page();
  for (const MeasuredPart& part : measured.parts) page.Paragraph(Sentence(part));
  for (const MeasuredSignal& signal : measured.signals) page.Paragraph(Sentence(signal));
  for (const MeasuredEmg& emg : measured.emg.channels) page.Paragraph(Sentence(emg));
  for (const UsedTrack& track : measured.tracks) page.Paragraph(Sentence(track));
}

void AddSafety(const SafetyAssessment& safety, Outline* outline) {
  ReportPage& page = outline->page();
  int number = 0;
  for (const SafetyTable& table : SafetyTables(safety)) {
    outline->Begin("safety-" + std::to_string(++number), table.title + " (" + table.origin + ")");
    std::vector<std::vector<std::string>> rows = table.rows;
    for (auto& row : rows)
      for (std::string& cell : row) cell = EscapeMarkup(cell);
    if (!rows.empty()) page.Html(HtmlTable(rows));
    for (const std::string& note : table.notes) page.Paragraph(note);
  }
  for (const NotEvaluable& gap : safety.not_evaluable)
    page.Paragraph("Not evaluable: " + gap.what + ", because " + gap.why + ".");
}

void AddParts(const Assessment& a, Outline* outline) {
  ReportPage& page = outline->page();
  outline->Begin("values", "Values");
  page.Html(QuantityTable(a));
  page.Paragraph(
      "p5 and p95: percentiles over the judged time, of the nominal posture. The column \"Tail\" "
      "contains the 90 % interval of p95 (of p5 for balance) over 64 possible postures and "
      "bodies.");
  page.Paragraph(OriginWords(a.simulated()) + ". " + kCompressionCaveat);
  AddJoints(a, outline);
  outline->Begin("worksheets", "Scores (standard)");
  page.Html(ScoreBars(a));
  page.Html(ScoreTable(a));
  page.Figure(ScorePlot(a));
  AddMeasured(a.measured, outline);
  AddGroups(a, outline);
  AddLimits(a, outline);
  AddCosts(a, outline);
  if (a.safety) AddSafety(*a.safety, outline);
  outline->Begin("gaps", "Assumptions and gaps");
  for (const std::string& line : a.assumptions) page.Paragraph(line);
  for (const NotEvaluable& n : a.not_evaluable)
    page.Paragraph("Not evaluable: " + n.what + ", because " + n.why + ".");
}

void AddReason(const PersonOfRun& run, ReportPage* page) {
  page->Html("<p class=\"warning\">" + EscapeMarkup(run.name.empty() ? "" : run.name + ": ") +
             "Posture, loads and scores of the person cannot be evaluated. " +
             EscapeMarkup(run.why) + "</p>\n");
}

void AddComparison(std::span<const PersonOfRun> runs, ReportPage* page) {
  std::vector<std::vector<std::string>> rows = {{"Tail (90 %)"}};
  for (const PersonOfRun& run : runs)
    if (run.assessment) {
      rows[0].push_back(EscapeMarkup(run.name));
    } else {
      AddReason(run, page);
    }
  if (rows[0].size() < 2) return;
  const bool simulated = std::ranges::all_of(
      runs, [](const PersonOfRun& run) { return !run.assessment || run.assessment->simulated(); });
  for (const QuantityKind& kind : Quantities()) {
    if (!kind.has_row()) continue;
    std::vector<std::string> row = {
        EscapeMarkup(WithUnit(std::string(kind.group) + ", " + kind.label, kind.unit) + ", " +
                     Name(kind.origin, simulated))};
    for (const PersonOfRun& run : runs) {
      if (!run.assessment) continue;
      const auto& all = run.assessment->quantities;
      const auto q = std::ranges::find(all, &kind, &QuantityResult::kind);
      row.push_back(q == all.end() ? "–"
                                   : ValueText(kind, q->tail()) + " (" +
                                         RangeOrDash(kind, q->tail_interval) + ")");
    }
    rows.push_back(row);
  }
  page->Html(HtmlTable(rows));
  page->Paragraph(
      "The table shows the 95th percentile over time (5th percentile for balance) for the nominal "
      "posture, and its 90 % interval over 64 possible postures and bodies. To compare two runs "
      "for the same possible people, use predictor evaluate with --against, which gives narrower "
      "intervals of the differences.");
}

}  // namespace

std::string AssessmentPage(const Assessment& a, const std::string& program_version,
                           const Comparison* comparison) {
  std::string words = "<p>" + EscapeMarkup(a.recording) + " · evaluated by PREDICTOR " +
                      EscapeMarkup(program_version) + "</p>\n";
  ReportPage page(
      comparison ? ComparisonTitle(*comparison) : "The person in: " + Printable(a.scenario), words);
  Outline outline(&page, true);
  if (comparison) {
    outline.Begin("comparison", "Compared with " + Printable(comparison->b));
    page.Html(ComparisonHtml(*comparison));
  }
  outline.Begin("summary", comparison ? "Summary of " + Printable(a.recording) : "Summary");
  AddSummary(a, &page);
  AddParts(a, &outline);
  return page.Finish();
}

void AddPersonChapter(std::span<const PersonOfRun> runs, ReportPage* page) {
  page->Section("person", "Person");
  if (runs.size() > 1) return AddComparison(runs, page);
  if (!runs[0].assessment) return AddReason(runs[0], page);
  AddSummary(*runs[0].assessment, page);
  Outline outline(page, false);
  AddParts(*runs[0].assessment, &outline);
}

}  // namespace predictor::assessment
