// Table 1 of the paper, and the distributions of answers that are consistent with its rounded
// values.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "evaluation/questionnaire.h"

namespace predictor {

inline constexpr int kPaperPeople = 17;

// The mean and the sample standard deviation (denominator n − 1), as integers in hundredths because
// the table has two decimals.
struct RoundedFigures {
  int mean = 0, deviation = 0;
  bool operator==(const RoundedFigures&) const = default;
};

// Uses integers only. Halves are rounded away from zero. With 17 answers, no half can occur.
// Therefore, every rule that rounds to the nearest value gives the same result, but truncation does
// not. At least two answers are required.
RoundedFigures FiguresOf(const ScoreCounts& counts);

// Returns, in ascending order, all distributions of `people` answers that have these rounded values
// and no score below `lowest`.
std::vector<ScoreCounts> MatchingCounts(RoundedFigures figures, int people,
                                        int lowest = kLowestScore);

// Returns the middle score, or the mean of the two middle scores for an even number of answers.
// Returns NaN without answers.
double MedianOf(const ScoreCounts& counts);

struct PaperRow {
  RoundedFigures figures;
  // The lower bound that the paper's text states. The text says "for the statements S2–S4, there
  // was no degree of agreement below Neutral", and "no level of agreement below Agree" for S8.
  int lowest = kLowestScore;
};
const std::array<PaperRow, kStatements>& PaperTable();

// Returns one line per statement. The line contains the printed values, the distributions and their
// medians.
std::string PaperTableText();

}  // namespace predictor
