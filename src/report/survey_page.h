// Makes the page about a questionnaire, with a plot, tables, comments and methods.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "evaluation/questionnaire_report.h"
#include "report/plot.h"

namespace predictor {

// One set of distributions in a plot.
struct LikertSeries {
  std::string name;
  std::array<ScoreCounts, kStatements> counts{};
};
// Makes a plot like Fig. 11 of the paper for one or two series. The plot has a cross for each
// answer, with equal answers side by side. A dot with a bar shows the mean and the standard
// deviation.
Plot LikertPlot(const std::vector<LikertSeries>& series);

// Returns one self-contained page.
std::string SurveyPage(const SurveyReport& report);

}  // namespace predictor
