#include "evaluation/statistics_same_kind.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "evaluation/fidelity_signals.h"

namespace predictor {
namespace {

constexpr double kRounding = 1e-12;  // accounts for rounding of the sums: distances that differ by
                                     // less count as equal

// Sums over pairs of repeats, grouped by how many of the two repeats belong to set a.
double EnergyDistance(const Eigen::MatrixXd& distances, const std::vector<bool>& is_a) {
  double sums[3] = {}, pairs[3] = {};
  for (std::size_t j = 1; j < is_a.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const int both = is_a[i] + is_a[j];
      sums[both] += distances(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      pairs[both] += 1;
    }
  return sums[1] / pairs[1] - (sums[0] / pairs[0] + sums[2] / pairs[2]) / 2;
}

Eigen::MatrixXd DistancesOf(const std::vector<std::span<const double>>& repeats) {
  const auto n = static_cast<Eigen::Index>(repeats.size());
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 1; j < n; ++j)
    for (Eigen::Index i = 0; i < j; ++i)
      distances(i, j) = distances(j, i) = RootMeanSquareError(repeats[static_cast<std::size_t>(i)],
                                                              repeats[static_cast<std::size_t>(j)]);
  return distances;
}

// Returns one divided by the number of ways to divide the repeats into the two sets. If the sets
// have the same size, they are interchangeable, and the function returns twice this value.
double MinP(std::size_t a, std::size_t b, int draws) {
  double ways = 1;
  for (std::size_t k = 1; k <= a; ++k) ways *= static_cast<double>(b + k) / static_cast<double>(k);
  return std::max((a == b ? 2 : 1) / ways, 1.0 / (draws + 1));
}

}  // namespace

SameKindTest TestSameKind(std::span<const std::vector<double>> a,
                          std::span<const std::vector<double>> b, int draws) {
  std::vector<std::span<const double>> repeats(a.begin(), a.end());
  repeats.insert(repeats.end(), b.begin(), b.end());
  const Eigen::MatrixXd distances = DistancesOf(repeats);
  std::vector<bool> is_a(repeats.size(), false);
  std::fill_n(is_a.begin(), a.size(), true);
  SameKindTest test;
  test.distance = EnergyDistance(distances, is_a);
  test.min_p = MinP(a.size(), b.size(), draws);
  const double as_far = test.distance - kRounding * distances.maxCoeff();
  std::mt19937_64 random(1);
  int count = 1;
  for (int k = 0; k < draws; ++k) {
    for (std::size_t i = is_a.size() - 1; i > 0; --i) {  // std::shuffle differs between libraries
      const std::size_t other = random() % (i + 1);
      const bool kept = is_a[i];
      is_a[i] = is_a[other];
      is_a[other] = kept;
    }
    count += EnergyDistance(distances, is_a) >= as_far;
  }
  test.p = count / (draws + 1.0);
  return test;
}

}  // namespace predictor
