#include "evaluation/questionnaire_table.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>

namespace predictor {
namespace {

struct Sums {
  std::int64_t n = 0, sum = 0, squares = 0;
};

Sums SumsOf(const ScoreCounts& counts) {
  Sums sums;
  for (std::size_t i = 0; i < kScores; ++i) {
    const std::int64_t score = kLowestScore + static_cast<int>(i);
    sums.n += counts[i];
    sums.sum += score * counts[i];
    sums.squares += score * score * counts[i];
  }
  return sums;
}

// Enumerates all distributions of `left` answers over the scores from `score` upwards.
template <class Visit>
void Distribute(int left, std::size_t score, ScoreCounts* counts, const Visit& visit) {
  if (score + 1 == kScores) {
    (*counts)[score] = left;
    visit(*counts);
    return;
  }
  for (int here = 0; here <= left; ++here) {
    (*counts)[score] = here;
    Distribute(left - here, score + 1, counts, visit);
  }
}

std::string CountsText(const ScoreCounts& counts) {
  std::string text;
  for (const int count : counts) {
    char word[16];
    std::snprintf(word, sizeof word, "%4d", count);
    text += word;
  }
  return text;
}

}  // namespace

RoundedFigures FiguresOf(const ScoreCounts& counts) {
  const auto [n, sum, squares] = SumsOf(counts);
  // The rounded absolute mean in hundredths is 100 |sum| / n plus one half, rounded down.
  const std::int64_t size = (200 * std::abs(sum) + n) / (2 * n);
  // The square of the standard deviation is spread / (n (n − 1)). The rounded deviation in
  // hundredths is the largest m for which m − 1/2 does not exceed the exact deviation in
  // hundredths.
  const std::int64_t spread = n * squares - sum * sum;
  std::int64_t m = 0;
  while ((2 * m + 1) * (2 * m + 1) * n * (n - 1) <= 40000 * spread) ++m;
  return {static_cast<int>(sum < 0 ? -size : size), static_cast<int>(m)};
}

std::vector<ScoreCounts> MatchingCounts(RoundedFigures figures, int people, int lowest) {
  std::vector<ScoreCounts> found;
  ScoreCounts counts{};
  Distribute(people, static_cast<std::size_t>(lowest - kLowestScore), &counts,
             [&](const ScoreCounts& candidate) {
               if (FiguresOf(candidate) == figures) found.push_back(candidate);
             });
  return found;
}

double MedianOf(const ScoreCounts& counts) {
  const int n = std::accumulate(counts.begin(), counts.end(), 0);
  if (n == 0) return std::numeric_limits<double>::quiet_NaN();
  const auto at = [&](int place) {
    std::size_t i = 0;
    for (int passed = counts[0]; passed <= place; passed += counts[i]) ++i;
    return kLowestScore + static_cast<double>(i);
  };
  return (at((n - 1) / 2) + at(n / 2)) / 2;
}

const std::array<PaperRow, kStatements>& PaperTable() {
  static constexpr std::array<PaperRow, kStatements> kRows = {{
      {{147, 62}},
      {{106, 66}, 0},
      {{76, 56}, 0},
      {{100, 61}, 0},
      {{118, 88}},
      {{176, 56}},
      {{135, 79}},
      {{129, 47}, 1},
  }};
  return kRows;
}

std::string PaperTableText() {
  std::string text =
      "     mean ± std  |  −2  −1   0   1   2 | median\n"
      "-----------------+---------------------+-------\n";
  for (std::size_t i = 0; i < kStatements; ++i) {
    const PaperRow& row = PaperTable()[i];
    for (const ScoreCounts& counts : MatchingCounts(row.figures, kPaperPeople, row.lowest)) {
      char line[96];
      std::snprintf(line, sizeof line, "%s  %.2f ± %.2f |%s |   %.0f\n", Statements()[i].name,
                    row.figures.mean / 100.0, row.figures.deviation / 100.0,
                    CountsText(counts).c_str(), MedianOf(counts));
      text += line;
    }
  }
  return text;
}

}  // namespace predictor
