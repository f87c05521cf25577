// The paper's Table 1, and the distributions of answers that lie behind its rounded figures.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "evaluation/questionnaire.h"

namespace predictor {

inline constexpr int kPaperPeople = 17;

// A mean and a sample standard deviation (n − 1) as printed with two digits, in hundredths.
struct RoundedFigures {
  int mean = 0, deviation = 0;
  bool operator==(const RoundedFigures&) const = default;
};

// By whole numbers alone; a half is rounded away from zero. (Of 17 answers no half can occur, so
// every rule of rounding to the nearest gives the same; truncation does not.) At least two answers.
RoundedFigures FiguresOf(const ScoreCounts& counts);

// All distributions of `people` answers whose rounded figures are these and in which no score is
// below `lowest`, in ascending order.
std::vector<ScoreCounts> MatchingCounts(RoundedFigures figures, int people,
                                        int lowest = kLowestScore);

// The middle score; of an even number of answers the mean of the two; NaN of none.
double MedianOf(const ScoreCounts& counts);

struct PaperRow {
  RoundedFigures figures;
  // What the text says of the answers: "for the statements S2–S4, there was no degree of agreement
  // below Neutral", "no level of agreement below Agree" for S8.
  int lowest = kLowestScore;
};
const std::array<PaperRow, kStatements>& PaperTable();

// One line a statement: the printed figures, the distributions and their medians.
std::string PaperTableText();

}  // namespace predictor
