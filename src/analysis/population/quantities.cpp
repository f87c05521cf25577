#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "analysis/population/population.h"

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
constexpr Unit kFineShares = {"", "%", 100, 2};
constexpr Unit kScore = {"", "", 1, 0};
constexpr Unit kLength = {"m", "cm", 100, 1};

// Returns the 95th (or 5th) percentile over time of one of the assessment's quantities.
double Tail(const Assessment& a, std::string_view path) {
  for (const assessment::QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q.tail();
  return kMissing;
}

// Returns the larger value of the two hands, or the value of the only hand.
double Larger(const Assessment& a, std::string_view left, std::string_view right) {
  return std::fmax(Tail(a, left), Tail(a, right));
}

double Score(const Assessment& a, std::string_view name) {
  for (const assessment::WorksheetResult& w : a.worksheets)
    if (name == w.kind->name) return w.p95;
  return kMissing;
}

double DayShare(const Assessment& a, std::string_view tool) {
  double most = kMissing;
  for (const assessment::DamageResult& d : a.damage)
    if (d.tool == tool) most = std::fmax(most, d.day_share);
  return most;
}

constexpr StudyQuantity kQuantities[] = {
    {"hand_force_n", "hand force, larger hand", kNewtons, Origin::kMeasured,
     [](const Assessment& a) { return Larger(a, "hands.left.force_n", "hands.right.force_n"); }},
    {"lower_back_compression_n", "L5/S1 compression", kWholeNewtons, Origin::kModelled,
     [](const Assessment& a) { return Tail(a, "lower_back.compression_n"); }, 3400,
     "NIOSH's limit for compression"},
    {"lower_back_shear_n", "L5/S1 shear", kWholeNewtons, Origin::kModelled,
     [](const Assessment& a) { return Tail(a, "lower_back.shear_n"); }, 700,
     "Gallagher & Marras's limit for frequent shear"},
    {"shoulder_use", "share of own shoulder strength", kShares, Origin::kModelled,
     [](const Assessment& a) {
       return Larger(a, "strength.left_shoulder", "strength.right_shoulder");
     },
     1, "the person's own strength"},
    {"elbow_use", "share of own elbow strength", kShares, Origin::kModelled,
     [](const Assessment& a) { return Larger(a, "strength.left_elbow", "strength.right_elbow"); },
     1, "the person's own strength"},
    {"trunk_flexion_rad", "trunk flexion", kAngle, Origin::kModelled,
     [](const Assessment& a) { return Tail(a, "trunk.flexion_rad"); }},
    {"upper_arm_elevation_rad", "upper arm elevation, larger", kAngle, Origin::kModelled,
     [](const Assessment& a) {
       return Larger(a, "arms.left.elevation_rad", "arms.right.elevation_rad");
     }},
    {"rula", "RULA", kScore, Origin::kStandard,
     [](const Assessment& a) { return Score(a, "RULA"); }, 4,
     "RULA's level \"investigate further and change soon\" begins at 5"},
    {"reba", "REBA", kScore, Origin::kStandard,
     [](const Assessment& a) { return Score(a, "REBA"); }, 7, "REBA's high risk begins at 8"},
    {"lift_damage_day_share", "LiFFT, lower back: reference day per run", kFineShares,
     Origin::kStandard, [](const Assessment& a) { return DayShare(a, "LiFFT"); }},
    {"shoulder_damage_day_share", "Shoulder Tool, worse side: reference day per run", kFineShares,
     Origin::kStandard, [](const Assessment& a) { return DayShare(a, "Shoulder Tool"); }},
    {"balance_margin_m", "pressure to the feet's edge", kLength, Origin::kModelled,
     [](const Assessment& a) { return Tail(a, "balance.margin_m"); }, 0, "the edge of the feet",
     Bad::kLow},
    {"reached_share", "time in which the body reaches the handles", kShares, Origin::kModelled,
     [](const Assessment& a) { return a.reached; }, 0.99, "all but 1 % of the time", Bad::kLow},
};

}  // namespace

std::span<const StudyQuantity> StudyQuantities() { return kQuantities; }

}  // namespace predictor::population
