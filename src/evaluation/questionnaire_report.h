// What many answers to the questionnaire say together: table, plot and page.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "evaluation/questionnaire.h"
#include "evaluation/questionnaire_files.h"
#include "evaluation/statistics_signed_rank.h"

namespace predictor {

struct StatementSummary {
  ScoreCounts counts{};
  int answers = 0;
  double mean = 0, deviation = 0, median = 0;  // NaN where not defined; deviation with n − 1
  double agreeing = 0;                         // share of "agree" and "strongly agree"
};

// Where a statement's scores lie, or the differences of those who answered it twice.
struct ShiftSummary {
  int count = 0;
  SignedRankTest test;  // against 0, zeros dropped
  ShiftEstimate shift;  // at 95 %
  double adjusted = 1;  // p by Holm over the statements that have any
};
using ShiftSummaries = std::array<ShiftSummary, kStatements>;

struct ConditionSummary {
  int people = 0;
  std::array<StatementSummary, kStatements> statements;
  ShiftSummaries from_neutral;
  int ages = 0;  // how many told it
  double age_mean = 0, age_deviation = 0;
  int female = 0, male = 0, other = 0;  // the rest did not tell
};

struct SurveyComment {
  Condition condition = Condition::kEmulated;
  std::string text;
};

struct SurveyReport {
  std::array<ConditionSummary, kConditions> conditions;  // by Condition
  int people = 0;                                        // with both conditions counted once
  int paired_people = 0;
  ShiftSummaries paired;  // emulated minus real, of those who answered a statement for both
  std::vector<SurveyComment> comments;
};

StatementSummary SummariseCounts(const ScoreCounts& counts);

// Throws InputError if there is no answer, or if somebody answered twice in one condition (after
// two runs): the answers of a person do not count as those of two.
SurveyReport SummariseSurvey(const std::vector<StoredAnswer>& answers);

// "0.0312", or "<0.0001": a probability is never shown as none.
std::string ProbabilityText(double p);

// For a person at a terminal.
std::string SurveyTable(const SurveyReport& report);

// One set of distributions in a plot.
struct LikertSeries {
  std::string name;
  std::array<ScoreCounts, kStatements> counts{};
};
// As the paper's Fig. 11, an SVG element: a cross for each answer, side by side where they agree,
// and a dot with a bar for mean and standard deviation. One or two series.
std::string LikertPlot(const std::vector<LikertSeries>& series);

// One self-contained page with table, plot, comments and how the figures were obtained.
std::string SurveyPage(const SurveyReport& report);

}  // namespace predictor
