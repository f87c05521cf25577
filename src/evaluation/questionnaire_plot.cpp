// The plot of the paper's Fig. 11 as SVG, by hand: a few marks need no library.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "evaluation/questionnaire_report.h"

namespace predictor {
namespace {

// [px]
constexpr double kWidth = 960, kHeight = 470, kLeft = 150, kRight = 10, kTop = 46, kBottom = 60;
constexpr double kColumn = (kWidth - kLeft - kRight) / kStatements;
constexpr double kHighest = 2.6, kLowest = -2.6;  // scores at the plot's edges
constexpr double kLevel = (kHeight - kTop - kBottom) / (kHighest - kLowest);
constexpr double kRowHeight = 8, kMark = 4;
constexpr int kMostRows = 6;  // of crosses at one score

// Told apart not by colour alone: the second series has upright crosses and square means.
struct Look {
  const char* cross;
  const char* mean;
  bool second;
};
constexpr std::array<Look, 2> kLooks = {
    {{"#2166ac", "#b2182b", false}, {"#3c7d22", "#6a2383", true}}};

template <class... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

double HeightOf(double score) { return kTop + (kHighest - score) * kLevel; }

std::string Text(double x, double y, const char* anchor, const std::string& words) {
  return Format("<text x='%.1f' y='%.1f' text-anchor='%s'>", x, y, anchor) + words + "</text>\n";
}

std::string Cross(double x, double y, const Look& look) {
  if (look.second)
    return Format("<path d='M%.1f %.1fh7m-3.5 -3.5v7' stroke='%s'/>\n", x - 3.5, y, look.cross);
  return Format("<path d='M%.1f %.1fl5.6 5.6m0 -5.6l-5.6 5.6' stroke='%s'/>\n", x - 2.8, y - 2.8,
                look.cross);
}

std::string MeanMark(double x, double y, const Look& look) {
  if (look.second)
    return Format("<rect x='%.1f' y='%.1f' width='8' height='8' fill='%s'/>\n", x - kMark,
                  y - kMark, look.mean);
  return Format("<circle cx='%.1f' cy='%.1f' r='4.5' fill='%s'/>\n", x, y, look.mean);
}

std::string Bar(double x, double high, double low, const Look& look) {
  return Format("<path class='bar' d='M%.1f %.1fh8m-4 0V%.1fm-4 0h8' stroke='%s'/>\n", x - kMark,
                high, low, look.mean);
}

// The crosses of one score: as many rows as needed, centred on it.
std::string Crosses(double x, double width, double score, int count, const Look& look) {
  const int a_row = std::max(4, (count + kMostRows - 1) / kMostRows);
  const int rows = (count + a_row - 1) / a_row;
  const double step = std::min(9.0, width / a_row);
  std::string svg;
  for (int i = 0; i < count; ++i) {
    const int row = i / a_row, here = std::min(a_row, count - row * a_row);
    svg += Cross(x + (i % a_row - (here - 1) / 2.0) * step,
                 HeightOf(score) + (row - (rows - 1) / 2.0) * kRowHeight, look);
  }
  return svg;
}

std::string Axes() {
  std::string svg;
  for (std::size_t i = 0; i < kScores; ++i) {
    const int score = kLowestScore + static_cast<int>(i);
    svg += Format("<path class='grid' d='M%.1f %.1fH%.1f'/>\n", kLeft, HeightOf(score),
                  kWidth - kRight);
    svg += Text(kLeft - 8, HeightOf(score) + 4, "end",
                std::string(ScoreNames()[i]) + (score < 0 ? " (−" : " (") +
                    std::to_string(std::abs(score)) + ")");
  }
  for (std::size_t i = 0; i < kStatements; ++i)
    svg += Text(kLeft + (static_cast<double>(i) + 0.5) * kColumn, kHeight - kBottom + 20, "middle",
                Statements()[i].name);
  svg += Text(kLeft + kColumn * kStatements / 2, kHeight - 12, "middle", "Statement");
  return svg + Format("<path class='axis' d='M%.1f %.1fV%.1fH%.1f'/>\n", kLeft, kTop - 6,
                      kHeight - kBottom, kWidth - kRight);
}

std::string Legend(const std::vector<LikertSeries>& series) {
  std::string svg;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double x = kLeft + 400 * static_cast<double>(k);
    svg +=
        Cross(x + 6, 16, kLooks[k]) + Text(x + 16, 20, "start", series[k].name + ": each answer");
    svg += Bar(x + 190, 8, 24, kLooks[k]) + MeanMark(x + 190, 16, kLooks[k]);
    svg += Text(x + 202, 20, "start", "mean ± standard deviation");
  }
  return svg;
}

std::string Series(const LikertSeries& series, std::size_t which, std::size_t of) {
  const double width = kColumn / static_cast<double>(of);
  std::string svg;
  for (std::size_t i = 0; i < kStatements; ++i) {
    const double x =
        kLeft + static_cast<double>(i) * kColumn + (static_cast<double>(which) + 0.5) * width;
    for (std::size_t s = 0; s < kScores; ++s)
      svg += Crosses(x - 6, width - 24, kLowestScore + static_cast<double>(s), series.counts[i][s],
                     kLooks[which]);
    const StatementSummary summary = SummariseCounts(series.counts[i]);
    if (summary.answers == 0) continue;
    const double at = x + width / 2 - 10;
    if (summary.answers > 1)
      svg += Bar(at, HeightOf(summary.mean + summary.deviation),
                 HeightOf(summary.mean - summary.deviation), kLooks[which]);
    svg += MeanMark(at, HeightOf(summary.mean), kLooks[which]);
  }
  return svg;
}

}  // namespace

std::string LikertPlot(const std::vector<LikertSeries>& series) {
  std::string svg =
      Format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' role='img' ", kWidth,
             kHeight) +
      "aria-label='Answers to each statement, with mean and standard deviation'>\n"
      "<style>text{font:12px system-ui,sans-serif;fill:#222}path{fill:none;stroke-width:1.3}"
      ".grid{stroke:#ddd;stroke-width:1}.axis{stroke:#444}.bar{stroke-width:1.8}</style>\n" +
      Axes() + Legend(series);
  for (std::size_t k = 0; k < std::min(series.size(), kLooks.size()); ++k)
    svg += Series(series[k], k, series.size());
  return svg + "</svg>\n";
}

}  // namespace predictor
