#include "ergonomics/rainflow.h"

#include <algorithm>
#include <cmath>

namespace predictor::ergonomics {
namespace {

// Returns the first sample, all peaks and valleys, and the last sample. Equal neighbours count
// once.
std::vector<double> Reversals(std::span<const double> signal) {
  std::vector<double> points;
  for (const double x : signal) {
    const std::size_t n = points.size();
    if (n > 0 && x == points[n - 1]) continue;
    if (n > 1 && (points[n - 1] > points[n - 2]) == (x > points[n - 1]))
      points[n - 1] = x;  // continues in the same direction
    else
      points.push_back(x);
  }
  return points;
}

LoadCycle CycleBetween(double a, double b, double count) {
  return {std::abs(a - b), (a + b) / 2, count};
}

}  // namespace

std::vector<LoadCycle> CountRainflow(std::span<const double> signal, double min_range) {
  std::vector<LoadCycle> cycles;
  const auto add = [&](double a, double b, double count) {
    if (std::abs(a - b) >= min_range && a != b) cycles.push_back(CycleBetween(a, b, count));
  };
  std::vector<double> open;  // reversals that no cycle has used yet
  for (const double point : Reversals(signal)) {
    open.push_back(point);
    while (open.size() >= 3) {
      const std::size_t n = open.size();
      const double newest = std::abs(open[n - 1] - open[n - 2]);
      const double before = std::abs(open[n - 2] - open[n - 3]);
      if (newest < before) break;
      if (n == 3) {
        add(open[0], open[1], 0.5);
        open.erase(open.begin());
      } else {
        add(open[n - 3], open[n - 2], 1);
        open.erase(open.end() - 3, open.end() - 1);
      }
    }
  }
  for (std::size_t i = 1; i < open.size(); ++i) add(open[i - 1], open[i], 0.5);
  return cycles;
}

}  // namespace predictor::ergonomics
