// Summarises the answers of many people to the questionnaire, and writes the summary as a table.
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
  // Undefined values are NaN. The denominator of the standard deviation is n − 1.
  double mean = 0, deviation = 0, median = 0;
  double agreeing = 0;  // share of "agree" and "strongly agree"
};

// The location parameter of a statement's scores, or of the differences between the two answers of
// each person.
struct ShiftSummary {
  int count = 0;
  SignedRankTest test;  // against 0; zeros are dropped
  ShiftEstimate shift;  // with a 95 % interval
  double adjusted = 1;  // p after Holm's adjustment over the statements with scores
};
using ShiftSummaries = std::array<ShiftSummary, kStatements>;

struct ConditionSummary {
  int people = 0;
  std::array<StatementSummary, kStatements> statements;
  ShiftSummaries from_neutral;
  int ages = 0;  // number of people who gave their age
  double age_mean = 0, age_deviation = 0;
  int female = 0, male = 0, other = 0;  // the others did not answer
};

struct SurveyComment {
  Condition condition = Condition::kEmulated;
  std::string text;
};

struct SurveyReport {
  std::array<ConditionSummary, kConditions> conditions;  // summaries by Condition
  int people = 0;  // a person with both conditions counts once
  int paired_people = 0;
  ShiftSummaries paired;  // emulated minus real, for people who answered a statement in both
                          // conditions
  std::vector<SurveyComment> comments;
};

StatementSummary SummariseCounts(const ScoreCounts& counts);

// Throws InputError if there is no answer, or if a person answered twice in one condition (after
// two runs). Two answers of one person must not count as two people.
SurveyReport SummariseSurvey(const std::vector<StoredAnswer>& answers);

// Returns "0.0312" or "<0.0001". A probability is never shown as zero.
std::string ProbabilityText(double p);

// A single value has no interval: the confidence of its range is 0.
inline bool HasInterval(const ShiftEstimate& shift) { return shift.confidence > 0; }
// Returns a sentence if every statement has so few values that no test can show a difference,
// otherwise an empty text. The smallest two-sided p of n values is 2^(1 − n).
std::string TooFewText(const ShiftSummaries& summaries);

// Returns the mean and the standard deviation of the ages, or the age of a single person, which has
// no deviation.
std::string AgeText(const ConditionSummary& c);

// Returns a table for the terminal.
std::string SurveyTable(const SurveyReport& report);

}  // namespace predictor
