// Makes a plot like Fig. 11 of the paper.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "report/survey_page.h"

namespace predictor {
namespace {

// Lengths are in units of the axes. Each statement is 1 wide, and each score is 1 high.
constexpr double kMarginX = 0.06, kMeanWidth = 0.2;  // space beside the crosses of a series
constexpr double kStepX = 0.085, kStepY = 0.11;      // distance of neighbouring crosses
constexpr double kHighest = 2.6;                     // largest y; the smallest is its negative
constexpr int kMinRow = 4, kMaxRows = 6;             // limits for the crosses at one score

struct Points {
  std::vector<double> x, y, error;
};

// Adds the crosses at one score, in as many rows as needed, centred on the score.
void AddCrosses(double left, double width, double score, int count, Points* points) {
  const int a_row = std::max(kMinRow, (count + kMaxRows - 1) / kMaxRows);
  const int rows = (count + a_row - 1) / a_row;
  const double step = std::min(kStepX, width / a_row);
  for (int i = 0; i < count; ++i) {
    const int row = i / a_row, here = std::min(a_row, count - row * a_row);
    points->x.push_back(left + width / 2 + (i % a_row - (here - 1) / 2.0) * step);
    points->y.push_back(score + ((rows - 1) / 2.0 - row) * kStepY);
  }
}

PlotSeries Markers(const std::string& label, int color, PlotSymbol symbol, Points points) {
  PlotSeries series{.label = label, .kind = SeriesKind::kMarkers, .color = color, .symbol = symbol};
  series.SetPoints(std::move(points.x), std::move(points.y));
  if (!points.error.empty()) series.error = MakeSamples(std::move(points.error));
  return series;
}

// Adds the answers of series number `which`, and their means. The `of` series of the plot share the
// width of a statement.
void AddSeries(const LikertSeries& series, std::size_t which, std::size_t of, PlotPanel* panel) {
  const double width = 1.0 / static_cast<double>(of);
  Points answers, means;
  for (std::size_t i = 0; i < kStatements; ++i) {
    const double left = static_cast<double>(i) - 0.5 + static_cast<double>(which) * width;
    for (std::size_t s = 0; s < kScores; ++s)
      AddCrosses(left + kMarginX, width - kMarginX - kMeanWidth,
                 kLowestScore + static_cast<double>(s), series.counts[i][s], &answers);
    const StatementSummary summary = SummariseCounts(series.counts[i]);
    if (summary.answers == 0) continue;
    means.x.push_back(left + width - kMeanWidth / 2);
    means.y.push_back(summary.mean);
    means.error.push_back(summary.deviation);  // NaN for a single answer: no bar
  }
  const int color = static_cast<int>(2 * which);
  panel->series.push_back(Markers(series.name + ": each answer", color,
                                  which == 0 ? PlotSymbol::kCross : PlotSymbol::kPlus,
                                  std::move(answers)));
  panel->series.push_back(Markers(series.name + ": mean ± standard deviation", color + 1,
                                  which == 0 ? PlotSymbol::kDot : PlotSymbol::kSquare,
                                  std::move(means)));
}

}  // namespace

Plot LikertPlot(const std::vector<LikertSeries>& series) {
  Plot plot;
  plot.id = "answers";
  plot.title = "Answers to each statement, with mean and standard deviation";
  plot.x = {.label = "Statement"};
  for (const Statement& statement : Statements()) plot.x.names.emplace_back(statement.name);
  plot.x.low = -0.5;
  plot.x.high = static_cast<double>(kStatements) - 0.5;
  PlotPanel panel{.height = 2};
  panel.y = {.label = "Answer", .first = kLowestScore};
  for (std::size_t i = 0; i < kScores; ++i) {
    const int score = kLowestScore + static_cast<int>(i);
    panel.y.names.push_back(std::string(ScoreNames()[i]) + (score < 0 ? " (−" : " (") +
                            std::to_string(std::abs(score)) + ")");
  }
  panel.y.low = -kHighest;
  panel.y.high = kHighest;
  for (std::size_t k = 0; k < std::min<std::size_t>(series.size(), 2); ++k)
    AddSeries(series[k], k, series.size(), &panel);
  plot.panels.push_back(std::move(panel));
  return plot;
}

}  // namespace predictor
