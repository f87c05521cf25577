#include "tracks/clock_offset.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/format.h"
#include "core/least_squares.h"
#include "tracks/series.h"

namespace predictor::tracks {
namespace {

constexpr double kRate = 100;     // sampling rate of the compared speeds [Hz]
constexpr double kWindow = 0.1;   // time over which a speed is computed [s]
constexpr double kMaxHole = 0.1;  // longest interpolated gap between samples [s]
constexpr double kLobe = 0.5;     // offsets closer to the best one belong to the same maximum [s]
constexpr double kSearch = 0.3;   // search range of a part's offset about the best one [s]
constexpr double kMinDeviation = 0.01;  // smallest standard deviation of a usable speed [m/s]
constexpr std::size_t kBlocks = 8, kMinBlocks = 3;
constexpr double kMaxWork = 2e8;  // products in the search over all offsets

// The speeds of the hand on a grid of times.
struct Speeds {
  double start = 0, step = 0;  // [s]
  std::vector<double> values;  // [m/s]; NaN: not known
};

Vector3 Interpolated(const Path& path, double time) {
  const auto later = std::ranges::lower_bound(path.times, time);
  const auto i = static_cast<std::size_t>(later - path.times.begin());
  if (later == path.times.end() || (i == 0 && *later > time)) return Vector3::Constant(kMissing);
  if (*later == time) return path.p[i];
  if (path.times[i] - path.times[i - 1] > kMaxHole) return Vector3::Constant(kMissing);
  const double w = (time - path.times[i - 1]) / (path.times[i] - path.times[i - 1]);
  return (1 - w) * path.p[i - 1] + w * path.p[i];
}

// The difference quotients are symmetric about each time, so they cause no delay.
Speeds SpeedsOf(const Path& path) {
  Speeds speeds{path.times.front(), 1 / kRate, {}};
  const auto n = static_cast<std::size_t>((path.times.back() - path.times.front()) * kRate) + 1;
  std::vector<Vector3> points;
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(Interpolated(path, speeds.start + static_cast<double>(i) / kRate));
  const auto half = static_cast<std::size_t>(kWindow * kRate / 2);
  speeds.values.assign(n, kMissing);
  for (std::size_t i = 2 * half; i + 2 * half < n; ++i) {
    Vector3 before = Vector3::Zero(), after = Vector3::Zero();
    for (std::size_t k = 0; k < 2 * half; ++k) {
      before += points[i - k] / static_cast<double>(2 * half);
      after += points[i + k] / static_cast<double>(2 * half);
    }
    speeds.values[i] = (after - before).norm() / ((2 * static_cast<double>(half) - 1) / kRate);
  }
  return speeds;
}

// Returns the means of successive groups of `n` values.
Speeds Coarser(const Speeds& fine, std::size_t n) {
  Speeds coarse{fine.start + fine.step * (static_cast<double>(n) - 1) / 2,
                fine.step * static_cast<double>(n),
                {}};
  for (std::size_t i = 0; i + n <= fine.values.size(); i += n) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += fine.values[i + k];
    coarse.values.push_back(sum / static_cast<double>(n));
  }
  return coarse;
}

// Compares the part of `a` from `begin` to `end` with `b` shifted by `lag` steps, so that value i
// of `a` meets value i - lag of `b`. Returns no value if fewer than `least` pairs of values meet,
// or if one of the parts is at rest.
std::optional<double> Correlation(const Speeds& a, const Speeds& b, std::ptrdiff_t lag,
                                  std::size_t begin, std::size_t end, double least) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) - lag;
    if (j < 0 || j >= static_cast<std::ptrdiff_t>(b.values.size())) continue;
    const double x = a.values[i], y = b.values[static_cast<std::size_t>(j)];
    if (!(x - x == 0 && y - y == 0)) continue;
    n += 1;
    sa += x;
    sb += y;
    saa += x * x;
    sbb += y * y;
    sab += x * y;
  }
  if (n < least || n < 2) return {};
  const double va = saa / n - sa * sa / (n * n), vb = sbb / n - sb * sb / (n * n);
  if (!(va > kMinDeviation * kMinDeviation && vb > kMinDeviation * kMinDeviation)) return {};
  return (sab / n - sa * sb / (n * n)) / std::sqrt(va * vb);
}

struct Fit {
  double lag = 0, correlation = -1;  // lag in steps
};

// Returns the best lag between `low` and `high`, refined by interpolation with a parabola.
std::optional<Fit> BestLag(const Speeds& a, const Speeds& b, std::ptrdiff_t low,
                           std::ptrdiff_t high, std::size_t begin, std::size_t end, double least) {
  std::optional<std::ptrdiff_t> best;
  double highest = -1;
  for (std::ptrdiff_t lag = low; lag <= high; ++lag)
    if (const auto r = Correlation(a, b, lag, begin, end, least); r && *r > highest) {
      highest = *r;
      best = lag;
    }
  if (!best) return {};
  Fit fit{static_cast<double>(*best), highest};
  const auto before = Correlation(a, b, *best - 1, begin, end, least);
  const auto after = Correlation(a, b, *best + 1, begin, end, least);
  if (before && after) {
    const double curvature = *before - 2 * highest + *after;
    if (curvature < 0) fit.lag += std::clamp(0.5 * (*before - *after) / curvature, -0.5, 0.5);
  }
  return fit;
}

// Returns the offset between the starts of the two grids plus the lag.
double OffsetOf(const Speeds& a, const Speeds& b, double lag) {
  return a.start - b.start + lag * a.step;
}

// Searches all offsets on coarse grids. Throws InputError if no offset fits, or if several do.
double SearchAll(const Speeds& fine_a, const Speeds& fine_b, const std::string& what) {
  const auto work = [&](std::size_t n) {
    const std::size_t a = fine_a.values.size() / n;
    const std::size_t both = (fine_a.values.size() + fine_b.values.size()) / n;
    return static_cast<double>(a) * static_cast<double>(both);
  };
  std::size_t n = 5;
  while (work(n) > kMaxWork) ++n;
  const Speeds a = Coarser(fine_a, n), b = Coarser(fine_b, n);
  const double shorter = static_cast<double>(std::min(a.values.size(), b.values.size()));
  const double least = std::max(kMinOverlap / a.step, 0.5 * shorter);
  Fit best, second;
  std::vector<Fit> fits;
  for (auto lag = -static_cast<std::ptrdiff_t>(b.values.size());
       lag <= static_cast<std::ptrdiff_t>(a.values.size()); ++lag)
    if (const auto r = Correlation(a, b, lag, 0, a.values.size(), least)) {
      fits.push_back({static_cast<double>(lag), *r});
      if (*r > best.correlation) best = fits.back();
    }
  if (fits.empty())
    throw InputError(what,
                     "The offset of the clocks cannot be estimated: the hand is seen in both "
                     "measurements for less than 3 s, or it hardly moves. Give the offset "
                     "(clock: recording, offset: SECONDS).");
  for (const Fit& fit : fits)
    if (std::abs(fit.lag - best.lag) * a.step > kLobe && fit.correlation > second.correlation)
      second = fit;
  if (best.correlation < kMinCorrelation)
    throw InputError(what, Formatted("The offset of the clocks cannot be estimated: the speeds of "
                                     "the hand correlate by %.2f at most, instead of %.2f. Check "
                                     "that the hand is mapped to the right markers, or give the "
                                     "offset (clock: recording, offset: SECONDS).",
                                     best.correlation, kMinCorrelation));
  if (second.correlation > kMaxSecond * best.correlation)
    throw InputError(
        what, Formatted("The offset of the clocks is ambiguous: %.2f s and %.2f s fit "
                        "nearly equally (correlations %.3f and %.3f). Repeated motions "
                        "cause this. Give the offset (clock: recording, offset: "
                        "SECONDS).",
                        OffsetOf(a, b, best.lag), OffsetOf(a, b, second.lag), best.correlation,
                        second.correlation));
  return OffsetOf(a, b, best.lag);
}

}  // namespace

ClockOffset EstimateOffset(const Path& reference, const Path& track, const std::string& what) {
  const Speeds a = SpeedsOf(reference), b = SpeedsOf(track);
  const double coarse = SearchAll(a, b, what);
  const double middle = (coarse - OffsetOf(a, b, 0)) / a.step;
  const auto low = static_cast<std::ptrdiff_t>(std::floor(middle - kSearch * kRate));
  const auto high = static_cast<std::ptrdiff_t>(std::ceil(middle + kSearch * kRate));
  const auto whole = BestLag(a, b, low, high, 0, a.values.size(), kMinOverlap * kRate);
  if (!whole) throw InputError(what, "The offset of the clocks cannot be estimated.");
  // Only the part of the reference that overlaps the track is divided into blocks.
  const auto lag = static_cast<std::ptrdiff_t>(std::lround(whole->lag));
  const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(lag, 0));
  const std::size_t end =
      std::min(a.values.size(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(
                                    lag + static_cast<std::ptrdiff_t>(b.values.size()), 0)));
  std::vector<double> lags;
  for (std::size_t k = 0; k < kBlocks && end > begin; ++k) {
    const std::size_t from = begin + k * (end - begin) / kBlocks;
    const std::size_t to = begin + (k + 1) * (end - begin) / kBlocks;
    const auto part = BestLag(a, b, lag - static_cast<std::ptrdiff_t>(kSearch * kRate),
                              lag + static_cast<std::ptrdiff_t>(kSearch * kRate), from, to,
                              0.5 * static_cast<double>(to - from));
    if (part && part->correlation > kMinCorrelation) lags.push_back(part->lag);
  }
  if (lags.size() < kMinBlocks)
    throw InputError(what, Formatted("The uncertainty of the clocks' offset cannot be estimated: "
                                     "the hand moves in only %zu of %zu parts of the record. Give "
                                     "the offset (clock: recording, offset: SECONDS).",
                                     lags.size(), kBlocks));
  const auto [least, most] = std::ranges::minmax(lags);
  if ((most - least) * a.step > kMaxDrift)
    throw InputError(what, Formatted("The clock jumps or drifts: its offset changes from %.2f s to "
                                     "%.2f s within the record. Cut the file at the jump.",
                                     OffsetOf(a, b, least), OffsetOf(a, b, most)));
  double mean = 0, square = 0;
  const auto n = static_cast<double>(lags.size());
  for (const double x : lags) mean += x / n;
  for (const double x : lags) square += (x - mean) * (x - mean) / (n - 1);
  return {OffsetOf(a, b, whole->lag),
          StudentQuantile95(n - 1) * std::sqrt(square / n) * a.step + 0.5e-3, whole->correlation};
}

}  // namespace predictor::tracks
