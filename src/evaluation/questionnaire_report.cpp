#include "evaluation/questionnaire_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/text_table.h"
#include "evaluation/questionnaire_table.h"
#include "evaluation/statistics.h"
#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

using Answers = std::map<std::string, std::array<const StoredAnswer*, kConditions>>;

// Groups the answers by pseudonym.
Answers ByPerson(const std::vector<StoredAnswer>& stored) {
  Answers people;
  for (const StoredAnswer& one : stored) {
    auto& place = people[one.answer.pseudonym][static_cast<std::size_t>(one.answer.condition)];
    if (place)
      throw InputError(one.answer.pseudonym + " answered twice for the " +
                       Name(one.answer.condition) + " system: " + place->file.string() + " and " +
                       one.file.string() + ". Give only one of the two.");
    place = &one;
  }
  return people;
}

void CountPerson(const SurveyAnswer& answer, ConditionSummary* summary,
                 std::array<ScoreCounts, kStatements>* counts, Statistics* ages) {
  ++summary->people;
  for (std::size_t i = 0; i < kStatements; ++i)
    if (answer.scores[i])
      ++(*counts)[i][static_cast<std::size_t>(*answer.scores[i] - kLowestScore)];
  if (answer.age) ages->Add(*answer.age);
  summary->female += answer.sex == "female" ? 1 : 0;
  summary->male += answer.sex == "male" ? 1 : 0;
  summary->other += answer.sex == "other" ? 1 : 0;
}

// Returns, for one statement, the score or the difference of each person for whom this value is
// available.
std::vector<double> ScoresOf(const Answers& people, std::size_t condition, std::size_t statement) {
  std::vector<double> scores;
  for (const auto& [pseudonym, answers] : people)
    if (answers[condition] && answers[condition]->answer.scores[statement])
      scores.push_back(*answers[condition]->answer.scores[statement]);
  return scores;
}

std::vector<double> DifferencesOf(const Answers& people, std::size_t statement) {
  std::vector<double> differences;
  for (const auto& [pseudonym, answers] : people) {
    if (!answers[0] || !answers[1]) continue;
    const auto real = answers[0]->answer.scores[statement];
    const auto emulated = answers[1]->answer.scores[statement];
    if (real && emulated) differences.push_back(*emulated - *real);
  }
  return differences;
}

ShiftSummary SummariseShift(const std::vector<double>& values) {
  return {static_cast<int>(values.size()), TestSignedRank(values), HodgesLehmann(values), 1};
}

void AdjustForAll(ShiftSummaries* summaries) {
  std::vector<double> p;
  for (const ShiftSummary& one : *summaries)
    if (one.count > 0) p.push_back(one.test.p);
  const std::vector<double> adjusted = HolmAdjusted(p);
  std::size_t next = 0;
  for (ShiftSummary& one : *summaries)
    if (one.count > 0) one.adjusted = adjusted[next++];
}

ConditionSummary SummariseCondition(const Answers& people, std::size_t condition) {
  ConditionSummary summary;
  std::array<ScoreCounts, kStatements> counts{};
  Statistics ages;
  for (const auto& [pseudonym, answers] : people)
    if (answers[condition]) CountPerson(answers[condition]->answer, &summary, &counts, &ages);
  for (std::size_t i = 0; i < kStatements; ++i) {
    summary.statements[i] = SummariseCounts(counts[i]);
    summary.from_neutral[i] = SummariseShift(ScoresOf(people, condition, i));
  }
  AdjustForAll(&summary.from_neutral);
  summary.ages = static_cast<int>(ages.count());
  summary.age_mean = summary.ages > 0 ? ages.mean() : kUndefined;
  summary.age_deviation = summary.ages > 1 ? ages.std() : kUndefined;
  return summary;
}

// Formats a value, for example with "%+.2f". An undefined value becomes a dash.
std::string Figure(const char* format, double value) {
  if (value != value) return "–";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string PeopleText(const ConditionSummary& c) {
  std::string text = std::to_string(c.people) + (c.people == 1 ? " person" : " people");
  if (c.ages > 0) text += ", age " + AgeText(c) + " years (" + std::to_string(c.ages) + " stated)";
  const int silent = c.people - c.female - c.male - c.other;
  text += ", " + std::to_string(c.female) + " female, " + std::to_string(c.male) + " male, " +
          std::to_string(c.other) + " other, " + std::to_string(silent) + " not stated";
  return text;
}

std::string ConditionTable(const ConditionSummary& c, Condition condition) {
  std::string text = std::string("After the ") + Name(condition) + " system: " + PeopleText(c) +
                     "\n         n    mean ±  std   median   agree    −2  −1   0   1   2\n";
  for (std::size_t i = 0; i < kStatements; ++i) {
    const StatementSummary& s = c.statements[i];
    text += std::string("  ") + Statements()[i].name + RightAligned(std::to_string(s.answers), 6) +
            RightAligned(Figure("%.2f", s.mean), 8) + " ± " +
            RightAligned(Figure("%.2f", s.deviation), 4) +
            RightAligned(Figure("%.1f", s.median), 9) +
            RightAligned(s.answers > 0 ? Figure("%.0f %%", 100 * s.agreeing) : "–", 8) + "  ";
    for (const int count : s.counts) text += RightAligned(std::to_string(count), 4);
    text += '\n';
  }
  return text;
}

// `counted` is the name of the counted items.
std::string ShiftTable(const char* counted, const ShiftSummaries& summaries) {
  std::string text = "   " + RightAligned(counted, 7) +
                     "  zeros   shift     interval  confidence        p     Holm\n";
  for (std::size_t i = 0; i < kStatements; ++i) {
    const ShiftSummary& s = summaries[i];
    text += std::string("  ") + Statements()[i].name + RightAligned(std::to_string(s.count), 6);
    if (s.count > 0)
      text += RightAligned(std::to_string(s.test.zeros), 7) +
              RightAligned(Figure("%+.2f", s.shift.estimate), 8) +
              RightAligned(HasInterval(s.shift) ? Figure("%+.1f", s.shift.lower) + " to " +
                                                      Figure("%+.1f", s.shift.upper)
                                                : "–",
                           13) +
              RightAligned(HasInterval(s.shift) ? Figure("%.1f %%", 100 * s.shift.confidence) : "–",
                           12) +
              RightAligned(ProbabilityText(s.test.p), 9) +
              RightAligned(ProbabilityText(s.adjusted), 9);
    text += '\n';
  }
  const std::string few = TooFewText(summaries);
  return few.empty() ? text : text + "  " + few + "\n";
}

std::string NeutralTable(const ConditionSummary& c, Condition condition) {
  return std::string("After the ") + Name(condition) + " system, compared with neutral (0)\n" +
         ShiftTable("answers", c.from_neutral);
}

std::string PairedTable(const SurveyReport& report) {
  if (report.paired_people == 0)
    return "No one answered exactly once for each system, so the answers are compared only with "
           "the neutral score.\n";
  return "Emulated minus real, " + std::to_string(report.paired_people) +
         (report.paired_people == 1 ? " person" : " people") + " who answered for both\n" +
         ShiftTable("pairs", report.paired);
}

std::string TestsInWords() {
  return "Wilcoxon's signed-rank test, two-sided, exact for up to " +
         std::to_string(kMaxEnumerated) +
         " non-zero values; zeros are dropped;\nHodges-Lehmann shift with a 95 % interval; p "
         "adjusted by Holm's method for all statements together.\n";
}

}  // namespace

std::string AgeText(const ConditionSummary& c) {
  if (c.ages == 1) return Figure("%.0f", c.age_mean);
  return Figure("%.2f", c.age_mean) + " ± " + Figure("%.2f", c.age_deviation);
}

StatementSummary SummariseCounts(const ScoreCounts& counts) {
  StatementSummary summary;
  summary.counts = counts;
  std::vector<double> scores;
  for (std::size_t i = 0; i < kScores; ++i)
    scores.insert(scores.end(), static_cast<std::size_t>(counts[i]),
                  kLowestScore + static_cast<double>(i));
  summary.answers = static_cast<int>(scores.size());
  summary.mean = Mean(scores);
  summary.deviation = SampleDeviation(scores);
  summary.median = MedianOf(counts);
  if (!scores.empty())
    summary.agreeing = (counts[3] + counts[4]) / static_cast<double>(scores.size());
  return summary;
}

SurveyReport SummariseSurvey(const std::vector<StoredAnswer>& answers) {
  if (answers.empty()) throw InputError("There are no answers (*.survey.json) in these places.");
  const Answers people = ByPerson(answers);
  SurveyReport report;
  report.people = static_cast<int>(people.size());
  for (const auto& [pseudonym, both] : people) report.paired_people += both[0] && both[1] ? 1 : 0;
  for (std::size_t c = 0; c < kConditions; ++c)
    report.conditions[c] = SummariseCondition(people, c);
  for (std::size_t i = 0; i < kStatements; ++i)
    report.paired[i] = SummariseShift(DifferencesOf(people, i));
  AdjustForAll(&report.paired);
  for (const StoredAnswer& one : answers)
    if (!one.answer.comment.empty())
      report.comments.push_back({one.answer.condition, one.answer.comment});
  return report;
}

std::string ProbabilityText(double p) { return p < 1e-4 ? "<0.0001" : Figure("%.4f", p); }

std::string TooFewText(const ShiftSummaries& summaries) {
  int most = 0;
  for (const ShiftSummary& summary : summaries) most = std::max(most, summary.count);
  const double smallest = std::ldexp(1.0, 1 - most);
  if (most == 0 || smallest <= 0.05) return "";
  return "The smallest p that " + std::to_string(most) + (most == 1 ? " value" : " values") +
         " can give is " + ProbabilityText(smallest) +
         ". So few people cannot show a difference, and no 95 % interval exists.";
}

std::string SurveyTable(const SurveyReport& report) {
  std::string text;
  for (const Condition condition : {Condition::kEmulated, Condition::kReal}) {
    const ConditionSummary& c = report.conditions[static_cast<std::size_t>(condition)];
    if (c.people > 0)
      text += ConditionTable(c, condition) + "\n" + NeutralTable(c, condition) + "\n";
  }
  return text + PairedTable(report) + "\n" + TestsInWords();
}

}  // namespace predictor
