#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "analysis/population/population.h"
#include "core/person_state.h"
#include "evaluation/statistics_samples.h"

namespace predictor::population {
namespace {

using assessment::Assessment;
using assessment::Bad;
using assessment::Origin;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr Unit kNewtons = {"N", "N", 1, 1};
constexpr Unit kWholeNewtons = {"N", "N", 1, 0};
constexpr Unit kAngle = {"rad", "°", kDegrees, 0};
constexpr Unit kShares = {"", "%", 100, 0};
constexpr Unit kFineShares = {"", "%", 100, 5};  // one run is a small part of a day
constexpr Unit kScore = {"", "", 1, 0};
constexpr Unit kLength = {"m", "cm", 100, 1};

// Returns the value of one of the assessment's quantities that is exceeded, in the bad direction,
// for the share `tail` of the time. Returns kMissing if there is no such value.
double Tail(const Assessment& a, std::string_view path, double tail) {
  for (const assessment::QuantityResult& q : a.quantities) {
    if (path != q.kind->path) continue;
    std::vector<double> values;
    for (const double value : q.values)
      if (std::isfinite(value)) values.push_back(value);
    if (values.empty() || tail >= 1) return kMissing;
    return Quantile(values, q.kind->bad == Bad::kHigh ? 1 - tail : tail);
  }
  return kMissing;
}

// Returns the larger value of the two hands, or the value of the only hand.
double Larger(const Assessment& a, double tail, std::string_view left, std::string_view right) {
  return std::fmax(Tail(a, left, tail), Tail(a, right, tail));
}

// Returns the highest score that is reached for more than the share `tail` of the time.
double Score(const Assessment& a, std::string_view name, double tail) {
  constexpr double kRounding = 1e-9;
  for (const assessment::WorksheetResult& w : a.worksheets) {
    if (name != w.kind->name) continue;
    double above = 0;
    for (std::size_t score = w.share.size(); score-- > 0;) {
      above += w.share[score];
      if (above > tail + kRounding) return static_cast<double>(score);
    }
  }
  return kMissing;
}

// Returns an upper bound of the share of the time in which the body reaches the handles. The share
// of the time in which it does not reach them is known only for the judged part of the run.
double Reached(const Assessment& a, double tail) { return 1 - (1 - a.reached) * kTailShare / tail; }

double DayShare(const Assessment& a, std::string_view tool) {
  double most = kMissing;
  for (const assessment::DamageResult& d : a.damage)
    if (d.tool == tool) most = std::fmax(most, d.day_share);
  return most;
}

constexpr StudyQuantity kQuantities[] = {
    {"hand_force_n", "hand force, larger hand", kNewtons, Origin::kMeasured,
     [](const Assessment& a, double tail) {
       return Larger(a, tail, "hands.left.force_n", "hands.right.force_n");
     }},
    {"lower_back_compression_n", "L5/S1 compression", kWholeNewtons, Origin::kModelled,
     [](const Assessment& a, double tail) { return Tail(a, "lower_back.compression_n", tail); },
     kCompressionLimit, kCompressionLimitName},
    {"lower_back_shear_n", "L5/S1 shear", kWholeNewtons, Origin::kModelled,
     [](const Assessment& a, double tail) { return Tail(a, "lower_back.shear_n", tail); },
     kShearLimit, kShearLimitName},
    {"shoulder_use", "share of own shoulder strength", kShares, Origin::kModelled,
     [](const Assessment& a, double tail) {
       return Larger(a, tail, "strength.left_shoulder", "strength.right_shoulder");
     },
     1, "the person's own strength"},
    {"elbow_use", "share of own elbow strength", kShares, Origin::kModelled,
     [](const Assessment& a, double tail) {
       return Larger(a, tail, "strength.left_elbow", "strength.right_elbow");
     },
     1, "the person's own strength"},
    {"trunk_flexion_rad", "trunk flexion", kAngle, Origin::kModelled,
     [](const Assessment& a, double tail) { return Tail(a, "trunk.flexion_rad", tail); }},
    {"upper_arm_elevation_rad", "upper arm elevation, larger", kAngle, Origin::kModelled,
     [](const Assessment& a, double tail) {
       return Larger(a, tail, "arms.left.elevation_rad", "arms.right.elevation_rad");
     }},
    {"rula", "RULA", kScore, Origin::kStandard,
     [](const Assessment& a, double tail) { return Score(a, "RULA", tail); }, 4,
     "RULA's level \"investigate further and change soon\" begins at 5"},
    {"reba", "REBA", kScore, Origin::kStandard,
     [](const Assessment& a, double tail) { return Score(a, "REBA", tail); }, 7,
     "REBA's high risk begins at 8"},
    {"lift_damage_day_share", "LiFFT, lower back: reference day per run", kFineShares,
     Origin::kStandard, [](const Assessment& a, double) { return DayShare(a, "LiFFT"); }},
    {"shoulder_damage_day_share", "Shoulder Tool, worse side: reference day per run", kFineShares,
     Origin::kStandard, [](const Assessment& a, double) { return DayShare(a, "Shoulder Tool"); }},
    {"balance_margin_m", "pressure to the feet's edge", kLength, Origin::kModelled,
     [](const Assessment& a, double tail) { return Tail(a, "balance.margin_m", tail); }, 0,
     "the edge of the feet", Bad::kLow},
    {"reached_share", "time in which the body reaches the handles", kShares, Origin::kModelled,
     Reached, 0.99, "all but 1 % of the time", Bad::kLow},
};

}  // namespace

std::span<const StudyQuantity> StudyQuantities() { return kQuantities; }

}  // namespace predictor::population
