// The survey's page: self-contained, nothing of it comes from the network.
#include <algorithm>
#include <cstdio>
#include <string>

#include "core/text.h"
#include "evaluation/questionnaire_report.h"
#include "evaluation/questionnaire_table.h"

namespace predictor {
namespace {

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Questionnaire</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #1b2430; background: #fff;
  max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.15rem; margin-top: 2rem; } h3 { font-size: 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%; }
th, td { padding: .3rem .6rem; text-align: right; border-bottom: 1px solid #dde3ea; }
th { font-weight: 600; color: #51606f; } th:first-child, td:first-child { text-align: left; }
svg { width: 100%; height: auto; } .note { color: #51606f; }
blockquote { margin: .6rem 0; padding: .3rem .9rem; border-left: 3px solid #cfd8e3;
  white-space: pre-wrap; overflow-wrap: anywhere; }
@media print { body { margin: 0; max-width: none; } h2, table, svg { break-inside: avoid; } }
</style></head><body>
)";

// With a true minus sign, or a dash where there is no figure.
std::string Figure(const char* format, double value) {
  if (value != value) return "–";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  const std::string text = buffer;
  return text.starts_with('-') ? "−" + text.substr(1) : text;
}

std::string Row(const std::string& cell, const std::vector<std::string>& cells) {
  std::string html = "<tr>";
  for (const std::string& text : cells) {
    html += "<" + cell + ">";
    html += text;
    html += "</" + cell + ">";
  }
  return html + "</tr>\n";
}

std::string MeanText(const StatementSummary& s) {
  return Figure("%.2f", s.mean) + " ± " + Figure("%.2f", s.deviation);
}

// `counted`: what there are so many of; `zero`: what a zero means.
std::string ShiftTable(const char* counted, const char* zero, const ShiftSummaries& summaries) {
  std::string html = "<table>" + Row("th", {"", counted, zero, "shift", "interval",
                                            "its confidence", "p", "p by Holm"});
  for (std::size_t i = 0; i < kStatements; ++i) {
    const ShiftSummary& s = summaries[i];
    if (s.count == 0) {
      html += Row("td", {Statements()[i].name, "0", "–", "–", "–", "–", "–", "–"});
      continue;
    }
    html += Row(
        "td", {Statements()[i].name, std::to_string(s.count), std::to_string(s.test.zeros),
               Figure("%.2f", s.shift.estimate),
               Figure("%.1f", s.shift.lower) + " to " + Figure("%.1f", s.shift.upper),
               Figure("%.1f %%", 100 * s.shift.confidence), EscapeMarkup(ProbabilityText(s.test.p)),
               EscapeMarkup(ProbabilityText(s.adjusted))});
  }
  return html + "</table>\n";
}

std::string ConditionSection(const ConditionSummary& c, Condition condition) {
  const bool emulated = condition == Condition::kEmulated;
  std::string html = std::string("<h2>After the ") + Name(condition) + " system</h2>\n<p>" +
                     std::to_string(c.people) + (c.people == 1 ? " person: " : " people: ") +
                     std::to_string(c.female) + " female, " + std::to_string(c.male) + " male, " +
                     std::to_string(c.other) + " other";
  if (c.ages > 0)
    html += "; age " + Figure("%.2f", c.age_mean) + " ± " + Figure("%.2f", c.age_deviation) +
            " years (" + std::to_string(c.ages) + " told)";
  html += ".</p>\n<table>";
  std::vector<std::string> head = {"",   "answers", "mean ± std", "median", "agree",
                                   "−2", "−1",      "0",          "1",      "2"};
  if (emulated) head.emplace_back("paper, n = 17");
  html += Row("th", head);
  for (std::size_t i = 0; i < kStatements; ++i) {
    const StatementSummary& s = c.statements[i];
    std::vector<std::string> row = {Statements()[i].name, std::to_string(s.answers), MeanText(s),
                                    Figure("%.1f", s.median),
                                    s.answers > 0 ? Figure("%.0f %%", 100 * s.agreeing) : "–"};
    for (const int count : s.counts) row.push_back(std::to_string(count));
    const RoundedFigures& paper = PaperTable()[i].figures;
    if (emulated)
      row.push_back(Figure("%.2f", paper.mean / 100.0) + " ± " +
                    Figure("%.2f", paper.deviation / 100.0));
    html += Row("td", row);
  }
  return html + "</table>\n<h3>Against neutral (0)</h3>\n" +
         ShiftTable("answers", "neutral", c.from_neutral);
}

std::string PairedSection(const SurveyReport& report) {
  std::string html = "<h2>Emulated minus real</h2>\n";
  if (report.paired_people == 0)
    return html +
           "<p>Nobody answered once for each system, so the answers are held against neutral "
           "only.</p>\n";
  return html + "<p>" + std::to_string(report.paired_people) + " answered for both.</p>\n" +
         ShiftTable("pairs", "no difference", report.paired);
}

std::string PlotSection(const SurveyReport& report) {
  std::vector<LikertSeries> series;
  for (const Condition condition : {Condition::kEmulated, Condition::kReal}) {
    const ConditionSummary& c = report.conditions[static_cast<std::size_t>(condition)];
    if (c.people == 0) continue;
    LikertSeries one;
    one.name = condition == Condition::kReal ? "Real" : "Emulated";
    for (std::size_t i = 0; i < kStatements; ++i) one.counts[i] = c.statements[i].counts;
    series.push_back(one);
  }
  return "<h2>All answers</h2>\n" + LikertPlot(series);
}

std::string Notes() {
  std::string html = "<h2>The statements</h2>\n";
  for (const Statement& statement : Statements())
    html += std::string("<p><b>") + statement.name + "</b> " + statement.text +
            " <span class='note'>(" + statement.aspect + ")</span></p>\n";
  return html +
         "<h2>How the figures were obtained</h2>\n<p class='note'>Standard deviations are "
         "those "
         "of samples (n − 1). “Agree” is the share of the two upper levels. The answers to a "
         "statement "
         "are held against neutral, and real against emulated by the differences of those who "
         "answered for both: Wilcoxon's signed-rank test, two-sided, zeros left out before "
         "ranking, equal sizes sharing their mean rank; "
         "p by enumeration of all signs up to " +
         std::to_string(kMostEnumerated) +
         " values, beyond by the normal approximation with corrections for ties and "
         "continuity. "
         "The shift is Hodges and Lehmann's median of the Walsh averages, zeros included, with the "
         "interval that has at least the confidence beside it (95 % was asked for; few answers "
         "cannot "
         "give it). p by Holm is adjusted for all statements being tested at once. A level counts "
         "as far from the next as any other. A large p is no "
         "proof "
         "that there is no difference: look at the interval.</p>\n</body></html>\n";
}

}  // namespace

std::string SurveyPage(const SurveyReport& report) {
  std::string html = kHead;
  html += "<h1>Questionnaire</h1>\n<p>" + std::to_string(report.people) +
          (report.people == 1 ? " person" : " people") +
          " answered, on a scale from −2 (strongly disagree) to 2 (strongly agree).</p>\n";
  html += PlotSection(report);
  for (const Condition condition : {Condition::kEmulated, Condition::kReal}) {
    const ConditionSummary& c = report.conditions[static_cast<std::size_t>(condition)];
    if (c.people > 0) html += ConditionSection(c, condition);
  }
  html += PairedSection(report);
  if (!report.comments.empty()) html += "<h2>Comments</h2>\n";
  for (const SurveyComment& comment : report.comments)
    html += std::string("<p class='note'>After the ") + Name(comment.condition) +
            " system</p><blockquote>" + EscapeMarkup(comment.text) + "</blockquote>\n";
  return html + Notes();
}

}  // namespace predictor
