#include "evaluation/fidelity_signals.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/linear_algebra.h"
#include "evaluation/statistics_samples.h"

namespace predictor {
namespace {

constexpr double kJoined = 0.5;  // a sample further from the circle than this share of its radius
                                 // is ignored
constexpr double kShort = 0.02;  // permitted shortfall of the last cycle [cycles]
constexpr int kFits = 4;  // iterations of the circle fit, each using the samples near the previous
                          // circle

struct Circle {
  double x = 0, y = 0, radius = 0;
};

// Solves x² + y² = 2 x_c x + 2 y_c y + c by least squares over the samples near the circle (Kåsa
// 1976).
Circle FitOnce(std::span<const double> x, std::span<const double> y, const Circle* before) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double x0 = x[0], y0 = y[0];  // origin near the path, to avoid loss of precision
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double far = before ? std::hypot(x[i] - before->x, y[i] - before->y) - before->radius : 0;
    if (before && std::abs(far) > kJoined * before->radius) continue;
    const Eigen::Vector3d row(2 * (x[i] - x0), 2 * (y[i] - y0), 1);
    normal += row * row.transpose();
    right += row * (row[0] * row[0] + row[1] * row[1]) / 4;
  }
  const Eigen::Vector3d solution = LeastSquares(normal, right);
  const double square = solution[2] + solution.head<2>().squaredNorm();
  return {solution[0] + x0, solution[1] + y0, std::sqrt(std::max(0.0, square))};
}

Circle FitCircle(std::span<const double> x, std::span<const double> y) {
  Circle circle = FitOnce(x, y, nullptr);
  for (int i = 1; i < kFits && circle.radius > 0; ++i) circle = FitOnce(x, y, &circle);
  return circle;
}

// Returns the Fourier transform of one segment at one frequency [cycles/sample]. The mean of the
// segment is removed, and a window is applied.
std::complex<double> Transform(std::span<const double> segment, double frequency) {
  const double mean = Mean(segment);
  const double n = static_cast<double>(segment.size());
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < segment.size(); ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i);
    const double window = 0.5 - 0.5 * std::cos(turn / n);
    sum += window * (segment[i] - mean) * std::polar(1.0, -turn * frequency);
  }
  return sum;
}

double MeanSquareDifference(const std::vector<double>& a, const std::vector<double>& b) {
  const double rmse = RootMeanSquareError(a, b);
  return rmse * rmse;
}

double MeanSquareWithin(const std::vector<std::vector<double>>& set) {
  double sum = 0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < set.size(); ++i)
    for (std::size_t j = 0; j < i; ++j, ++pairs) sum += MeanSquareDifference(set[i], set[j]);
  return pairs > 0 ? sum / static_cast<double>(pairs) : kUndefined;
}

}  // namespace

std::vector<double> CyclePhase(std::span<const double> x, std::span<const double> y) {
  std::vector<double> phase(x.size(), 0.0);
  if (x.empty()) return phase;
  const Circle circle = FitCircle(x, y);
  if (!(circle.radius > 0)) return phase;
  double turned = 0, last = kUndefined;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - circle.x, dy = y[i] - circle.y;
    if (std::hypot(dx, dy) > kJoined * circle.radius) {
      const double angle = std::atan2(dy, dx);
      if (last == last) turned += std::remainder(angle - last, 2 * std::numbers::pi);
      last = angle;
    }
    phase[i] = turned / (2 * std::numbers::pi);
  }
  const double sign = turned < 0 ? -1 : 1;
  double furthest = 0;
  for (double& p : phase) p = furthest = std::max(furthest, sign * p);
  return phase;
}

std::size_t CyclesIn(std::span<const double> phase) {
  return phase.empty() ? 0 : static_cast<std::size_t>(std::floor(phase.back() + kShort));
}

double PlaceOfPhase(std::span<const double> phase, double at) {
  const auto after = std::upper_bound(phase.begin(), phase.end(), at);
  if (after == phase.begin()) return 0;
  if (after == phase.end()) {
    // Returns the first sample that has the final phase. After this sample, the phase is constant.
    return static_cast<double>(std::lower_bound(phase.begin(), phase.end(), phase.back()) -
                               phase.begin());
  }
  const auto before = after - 1;
  return static_cast<double>(before - phase.begin()) + (at - *before) / (*after - *before);
}

std::vector<double> CutCycle(std::span<const double> samples, std::span<const double> phase,
                             std::size_t cycle, std::size_t points) {
  std::vector<double> cut(points);
  for (std::size_t k = 0; k < points; ++k) {
    const double place = PlaceOfPhase(
        phase, static_cast<double>(cycle) + static_cast<double>(k) / static_cast<double>(points));
    const auto below = std::min(static_cast<std::size_t>(place), samples.size() - 1);
    const std::size_t above = std::min(below + 1, samples.size() - 1);
    cut[k] = std::lerp(samples[below], samples[above], place - static_cast<double>(below));
  }
  return cut;
}

double RootMeanSquareError(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  const std::size_t n = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return n > 0 ? std::sqrt(sum / static_cast<double>(n)) : kUndefined;
}

double RootMeanSquare(std::span<const double> a) {
  double sum = 0;
  for (const double x : a) sum += x * x;
  return a.empty() ? kUndefined : std::sqrt(sum / static_cast<double>(a.size()));
}

Lag LagOf(std::span<const double> a, std::span<const double> b, std::size_t longest) {
  const auto n = static_cast<std::ptrdiff_t>(std::min(a.size(), b.size()));
  // The overlap must be at least half of the signals, because two samples always correlate.
  const auto most = std::min(static_cast<std::ptrdiff_t>(longest), n / 2);
  const auto at = [&](std::ptrdiff_t lag) {
    const auto overlap = static_cast<std::size_t>(n - std::abs(lag));
    return Correlation(
        a.subspan(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, -lag)), overlap),
        b.subspan(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, lag)), overlap));
  };
  Lag best{kUndefined, kUndefined};
  if (n < 2) return best;
  std::ptrdiff_t place = 0;
  for (std::ptrdiff_t step = 0; step <= 2 * most; ++step) {
    // The lags are tried in the order 0, 1, −1, 2, −2, ..., so that the shortest of equally good
    // lags is chosen.
    const std::ptrdiff_t lag = step % 2 == 0 ? -step / 2 : (step + 1) / 2;
    const double correlation = at(lag);
    if (best.correlation != best.correlation || correlation > best.correlation)
      place = lag, best.correlation = correlation;
  }
  if (best.correlation != best.correlation) return best;
  best.samples = static_cast<double>(place);
  if (std::abs(place) == most) return best;
  const double before = at(place - 1), after = at(place + 1);
  const double curvature = before - 2 * best.correlation + after;
  if (curvature < 0) best.samples += std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5);
  return best;
}

double WarpedDistance(std::span<const double> a, std::span<const double> b, double band) {
  if (a.empty() || b.empty()) return kUndefined;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const double longer = static_cast<double>(std::max(a.size(), b.size()));
  const double slope = static_cast<double>(b.size()) / static_cast<double>(a.size());
  // With a narrower band, no step would be possible.
  const double reach = std::max(band * longer, slope);
  std::vector<double> row(b.size() + 1, kFar), above(b.size() + 1, kFar);
  above[0] = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double middle = slope * (static_cast<double>(i) + 0.5) - 0.5;
    const double first = std::max(0.0, std::ceil(middle - reach));
    const double last = std::min(static_cast<double>(b.size()) - 1, std::floor(middle + reach));
    std::fill(row.begin(), row.end(), kFar);
    for (auto j = static_cast<std::size_t>(first); static_cast<double>(j) <= last; ++j)
      row[j + 1] = std::abs(a[i] - b[j]) + std::min({above[j], above[j + 1], row[j]});
    std::swap(row, above);
  }
  return above.back() / longer;
}

Coherence CoherenceOf(std::span<const double> a, std::span<const double> b, double rate,
                      std::size_t segment, double highest) {
  Coherence result{kUndefined, kUndefined, 0};
  const std::size_t n = std::min(a.size(), b.size()), step = std::max<std::size_t>(1, segment / 2);
  if (segment < 4 || n < segment) return result;
  result.segments = (n - segment) / step + 1;
  if (result.segments < 2) return result;
  double weights = 0, sum = 0;
  const double resolution = rate / static_cast<double>(segment);
  for (int k = 1; k * resolution <= highest && 2 * k < static_cast<int>(segment); ++k) {
    const double frequency = static_cast<double>(k) / static_cast<double>(segment);
    double aa = 0, bb = 0;
    std::complex<double> ab = 0;
    for (std::size_t s = 0; s < result.segments; ++s) {
      const auto fa = Transform(a.subspan(s * step, segment), frequency);
      const auto fb = Transform(b.subspan(s * step, segment), frequency);
      aa += std::norm(fa);
      bb += std::norm(fb);
      ab += std::conj(fa) * fb;
    }
    if (!(aa > 0 && bb > 0)) continue;
    const double weight = std::sqrt(aa * bb);
    weights += weight;
    sum += weight * std::norm(ab) / (aa * bb);
  }
  if (!(weights > 0)) return result;
  result.mean = sum / weights;
  const std::size_t independent = std::max<std::size_t>(2, n / segment);
  result.chance = 1 - std::pow(0.05, 1 / static_cast<double>(independent - 1));
  return result;
}

RepeatComparison CompareRepeats(const std::vector<std::vector<double>>& a,
                                const std::vector<std::vector<double>>& b) {
  double between = 0;
  for (const auto& one : a)
    for (const auto& other : b) between += MeanSquareDifference(one, other);
  between =
      a.empty() || b.empty() ? kUndefined : between / static_cast<double>(a.size() * b.size());
  const double within = (MeanSquareWithin(a) + MeanSquareWithin(b)) / 2;
  return {std::sqrt(within), std::sqrt(between), std::sqrt(between / within)};
}

}  // namespace predictor
