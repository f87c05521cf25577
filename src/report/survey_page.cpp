#include "report/survey_page.h"

#include <cstdio>
#include <string>
#include <vector>

#include "core/text.h"
#include "evaluation/questionnaire_table.h"
#include "report/page.h"

namespace predictor {
namespace {

// Formats a value with a true minus sign, or as a dash if the value is undefined.
std::string Figure(const char* format, double value) {
  if (value != value) return "–";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  const std::string text = buffer;
  return text.starts_with('-') ? "−" + text.substr(1) : text;
}

using Rows = std::vector<std::vector<std::string>>;

std::string MeanText(const StatementSummary& s) {
  return Figure("%.2f", s.mean) + " ± " + Figure("%.2f", s.deviation);
}

// `counted` is the name of the counted items. `zero` is the heading of the column that contains the
// number of zeros.
std::string ShiftTable(const char* counted, const char* zero, const ShiftSummaries& summaries) {
  Rows rows = {{"", counted, zero, "shift", "interval", "its confidence", "p", "p (Holm)"}};
  for (std::size_t i = 0; i < kStatements; ++i) {
    const ShiftSummary& s = summaries[i];
    if (s.count == 0) {
      rows.push_back({Statements()[i].name, "0", "–", "–", "–", "–", "–", "–"});
      continue;
    }
    rows.push_back({Statements()[i].name, std::to_string(s.count), std::to_string(s.test.zeros),
                    Figure("%.2f", s.shift.estimate),
                    HasInterval(s.shift)
                        ? Figure("%.1f", s.shift.lower) + " to " + Figure("%.1f", s.shift.upper)
                        : "–",
                    HasInterval(s.shift) ? Figure("%.1f %%", 100 * s.shift.confidence) : "–",
                    EscapeMarkup(ProbabilityText(s.test.p)),
                    EscapeMarkup(ProbabilityText(s.adjusted))});
  }
  const std::string few = TooFewText(summaries);
  return HtmlTable(rows) + (few.empty() ? few : "<p>" + few + "</p>\n");
}

std::string PeopleText(const ConditionSummary& c) {
  std::string text = std::to_string(c.people) + (c.people == 1 ? " person: " : " people: ") +
                     std::to_string(c.female) + " female, " + std::to_string(c.male) + " male, " +
                     std::to_string(c.other) + " other";
  if (c.ages > 0)
    text += "; age " + AgeText(c) + " years (" + std::to_string(c.ages) + " gave their age)";
  return text + ".";
}

std::string ScoreTable(const ConditionSummary& c, bool with_paper) {
  Rows rows = {{"", "answers", "mean ± std", "median", "agree", "−2", "−1", "0", "1", "2"}};
  if (with_paper) rows.front().emplace_back("paper, n = 17");
  for (std::size_t i = 0; i < kStatements; ++i) {
    const StatementSummary& s = c.statements[i];
    std::vector<std::string> row = {Statements()[i].name, std::to_string(s.answers), MeanText(s),
                                    Figure("%.1f", s.median),
                                    s.answers > 0 ? Figure("%.0f %%", 100 * s.agreeing) : "–"};
    for (const int count : s.counts) row.push_back(std::to_string(count));
    const RoundedFigures& paper = PaperTable()[i].figures;
    if (with_paper)
      row.push_back(Figure("%.2f", paper.mean / 100.0) + " ± " +
                    Figure("%.2f", paper.deviation / 100.0));
    rows.push_back(std::move(row));
  }
  return HtmlTable(rows);
}

void AddCondition(const ConditionSummary& c, Condition condition, ReportPage* page) {
  if (c.people == 0) return;
  page->Section(Name(condition), std::string("After the ") + Name(condition) + " system");
  page->Paragraph(PeopleText(c));
  page->Html(ScoreTable(c, condition == Condition::kEmulated));
  page->Html("<h3>Compared with neutral (0)</h3>\n" +
             ShiftTable("answers", "neutral", c.from_neutral));
}

void AddPaired(const SurveyReport& report, ReportPage* page) {
  page->Section("paired", "Emulated minus real");
  if (report.paired_people == 0) {
    page->Paragraph(
        "No person answered for both systems, so the answers are only compared with the neutral "
        "answer.");
    return;
  }
  page->Paragraph(std::to_string(report.paired_people) + " answered for both.");
  page->Html(ShiftTable("pairs", "no difference", report.paired));
}

Plot AllAnswers(const SurveyReport& report) {
  std::vector<LikertSeries> series;
  for (const Condition condition : {Condition::kEmulated, Condition::kReal}) {
    const ConditionSummary& c = report.conditions[static_cast<std::size_t>(condition)];
    if (c.people == 0) continue;
    LikertSeries one;
    one.name = condition == Condition::kReal ? "Real" : "Emulated";
    for (std::size_t i = 0; i < kStatements; ++i) one.counts[i] = c.statements[i].counts;
    series.push_back(one);
  }
  return LikertPlot(series);
}

void AddComments(const SurveyReport& report, ReportPage* page) {
  if (report.comments.empty()) return;
  page->Section("comments", "Comments");
  for (const SurveyComment& comment : report.comments)
    page->Html(std::string("<p class=\"caption\">After the ") + Name(comment.condition) +
               " system</p><blockquote>" + EscapeMarkup(comment.text) + "</blockquote>\n");
}

void AddStatements(ReportPage* page) {
  page->Section("statements", "The statements");
  for (const Statement& statement : Statements())
    page->Html(std::string("<p><b>") + statement.name + "</b> " + statement.text + " <small>(" +
               statement.aspect + ")</small></p>\n");
}

std::string Method() {
  return "Standard deviations are sample standard deviations (n − 1). “Agree” is the share of the "
         "two upper levels. The answers to a statement are compared with neutral. Real and "
         "emulated are compared by the differences of people who answered for both. The test is "
         "Wilcoxon's signed-rank test, two-sided; zeros are omitted before ranking, and ties share "
         "their mean rank. p is computed by enumerating all signs up to " +
         std::to_string(kMaxEnumerated) +
         " values, and above that by the normal approximation with corrections for ties and "
         "continuity. The shift is the Hodges–Lehmann median of the Walsh averages, including "
         "zeros. Its interval has at least the stated confidence (95 % was requested; with few "
         "answers, this may be unattainable). p (Holm) is adjusted for testing all statements at "
         "once. The levels are treated as equally spaced. A large p does not prove that there is "
         "no difference: consider the interval.";
}

}  // namespace

std::string SurveyPage(const SurveyReport& report) {
  ReportPage page(
      "Questionnaire",
      "<p>" + std::to_string(report.people) + (report.people == 1 ? " person" : " people") +
          " answered, on a scale from −2 (strongly disagree) to 2 (strongly agree).</p>\n");
  page.Section("all", "All answers");
  page.Figure(AllAnswers(report));
  for (const Condition condition : {Condition::kEmulated, Condition::kReal})
    AddCondition(report.conditions[static_cast<std::size_t>(condition)], condition, &page);
  AddPaired(report, &page);
  AddComments(report, &page);
  AddStatements(&page);
  page.Section("method", "How the figures were obtained");
  page.Paragraph(Method());
  return page.Finish();
}

}  // namespace predictor
