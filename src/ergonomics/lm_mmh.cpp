#include "ergonomics/lm_mmh.h"

#include <algorithm>
#include <cmath>

#include "core/normal.h"
#include "ergonomics/published_units.h"

namespace predictor::ergonomics {
namespace {

constexpr double kMinStudiedFrequency = 1.0 / 480;  // [1/min] once in eight hours
constexpr double kMaxStudiedFrequency = 20;         // [1/min]
constexpr double kMinStudiedTravel = 0.25;          // [m]

// A factor of the form constant + x / linear + x² / square. A divisor of 0 means that the term is
// absent.
struct Factor {
  double constant, linear, square = 0;
  double At(double x) const { return constant + x / linear + (square == 0 ? 0 : x * x / square); }
};

// MAL = reference · reach(H) · height(V) · distance(ln D or d) · frequency(ln F).
constexpr Factor kLiftReachF = {1.2602, -0.7686}, kLiftReachM = {1.3532, -0.7079};
constexpr Factor kLiftHeightF = {0.9877, 13.69, -9.221}, kLiftHeightM = {0.7746, 1.912, -3.296};
constexpr Factor kTravelF = {0.8199, -7.696}, kTravelM = {0.8695, -10.62};  // of ln D
constexpr Factor kLiftRateF = {0.6767, -12.59, -228.2};                     // of ln F, as below
constexpr Factor kLiftRateM = {0.6259, -9.092, -125.0}, kLowerRateM = {0.5773, -10.80, -255.9};

constexpr Factor kInitialHeightF = {-0.5304, 0.3361, -0.6915};
constexpr Factor kInitialDistanceF = {1.0286, -72.22, 9782};  // of d
constexpr Factor kInitialRateF = {0.7251, -13.19, -197.3};
constexpr Factor kSustainedHeightF = {-0.6539, 0.2941, -0.5722};
constexpr Factor kSustainedDistanceF = {1.0391, -52.91, 7975};  // of d
constexpr Factor kSustainedRateF = {0.6086, -11.95, -304.4};

constexpr Factor kPushInitialHeightM = {1.2737, -1.335, 2.576};
constexpr Factor kPullInitialHeightM = {1.7186, -0.6888, 2.025};
constexpr Factor kInitialDistanceM = {1.0790, -9.392};  // of ln d
constexpr Factor kInitialRateM = {0.6281, -13.07, -379.5};
constexpr Factor kPushSustainedHeightM = {2.2940, -0.3345, 0.6887};
constexpr Factor kPullSustainedHeightM = {2.1977, -0.3850, 0.9047};
constexpr Factor kSustainedDistanceM = {1.1035, -7.170};  // of ln d
constexpr Factor kSustainedRateM = {0.4896, -10.20, -403.9};

constexpr Factor kCarryHeightF = {1.1645, -4.437}, kCarryHeightM = {1.5505, -1.417};
constexpr Factor kCarryDistanceF = {1.0101, -207.8};  // of d
constexpr Factor kCarryDistanceM = {1.1172, -6.332};  // of ln d
constexpr Factor kCarryRateF = {0.6224, -16.33}, kCarryRateM = {0.5149, -7.958, -131.1};

double Limited(double x, double low, double high, bool* outside) {
  *outside |= x < low || x > high;
  return std::clamp(x, low, high);
}

double LogRate(double frequency, bool* outside) {
  return std::log(Limited(frequency, kMinStudiedFrequency, kMaxStudiedFrequency, outside));
}

// The equations for lifting and lowering differ in the reference, the variation and the men's
// frequency factor.
Acceptable Vertical(const VerticalHandling& task, Sex sex, double reference, double variation,
                    const Factor& rate) {
  const bool male = sex == Sex::kMale;
  Acceptable a;
  a.variation = variation;
  const double reach = Limited(task.reach, male ? 0.25 : 0.20, male ? 0.73 : 0.68, &a.outside);
  const double log_travel = std::log(Limited(task.travel, kMinStudiedTravel, INFINITY, &a.outside));
  a.mean = reference * (male ? kLiftReachM : kLiftReachF).At(reach) *
           (male ? kLiftHeightM : kLiftHeightF).At(task.mid_height) *
           (male ? kTravelM : kTravelF).At(log_travel) *
           rate.At(LogRate(task.frequency, &a.outside));
  a.mean = std::max(0.0, a.mean);
  return a;
}

// The distance factor of women is a function of d, and the distance factor of men is a function of
// ln d.
struct HorizontalEquation {
  double reference, variation;
  const Factor &height, &distance;
  bool of_log_distance;
  const Factor& rate;
};

Acceptable Horizontal(const HorizontalHandling& task, const HorizontalEquation& equation,
                      double unit) {
  Acceptable a;
  a.variation = equation.variation;
  const double d = Limited(task.distance, kShortestHorizontal, INFINITY, &a.outside);
  a.mean = equation.reference * unit * equation.height.At(task.hand_height) *
           equation.distance.At(equation.of_log_distance ? std::log(d) : d) *
           equation.rate.At(LogRate(task.frequency, &a.outside));
  a.mean = std::max(0.0, a.mean);
  return a;
}

// For women, the equations for pushing and pulling differ only in the variation.
HorizontalEquation ForceEquation(bool push, ForcePhase phase, Sex sex) {
  const bool initial = phase == ForcePhase::kInitial;
  if (sex == Sex::kFemale) {
    if (initial)
      return {36.9, push ? 0.214 : 0.234, kInitialHeightF, kInitialDistanceF, false, kInitialRateF};
    return {25.5,  push ? 0.286 : 0.298, kSustainedHeightF, kSustainedDistanceF,
            false, kSustainedRateF};
  }
  const Factor& distance = initial ? kInitialDistanceM : kSustainedDistanceM;
  const Factor& rate = initial ? kInitialRateM : kSustainedRateM;
  if (push && initial) return {70.3, 0.231, kPushInitialHeightM, distance, true, rate};
  if (push) return {65.3, 0.267, kPushSustainedHeightM, distance, true, rate};
  if (initial) return {69.8, 0.238, kPullInitialHeightM, distance, true, rate};
  return {61.0, 0.257, kPullSustainedHeightM, distance, true, rate};
}

}  // namespace

double Acceptable::ForShare(double share) const {
  return std::max(0.0, mean * (1 - NormalQuantile(share) * variation));
}

double Acceptable::ShareThatAccepts(double load) const {
  if (mean <= 0) return load <= 0 ? 1 : 0;
  return NormalProbability((1 - load / mean) / variation);
}

Acceptable AcceptableLift(const VerticalHandling& task, Sex sex) {
  return sex == Sex::kMale ? Vertical(task, sex, 82.6, 0.276, kLiftRateM)
                           : Vertical(task, sex, 34.9, 0.260, kLiftRateF);
}

Acceptable AcceptableLower(const VerticalHandling& task, Sex sex) {
  return sex == Sex::kMale ? Vertical(task, sex, 95.9, 0.304, kLowerRateM)
                           : Vertical(task, sex, 37.0, 0.307, kLiftRateF);
}

Acceptable AcceptablePush(const HorizontalHandling& task, ForcePhase phase, Sex sex) {
  return Horizontal(task, ForceEquation(true, phase, sex), kKilogramForce);
}

Acceptable AcceptablePull(const HorizontalHandling& task, ForcePhase phase, Sex sex) {
  return Horizontal(task, ForceEquation(false, phase, sex), kKilogramForce);
}

Acceptable AcceptableCarry(const HorizontalHandling& task, Sex sex) {
  if (sex == Sex::kFemale)
    return Horizontal(task, {28.6, 0.231, kCarryHeightF, kCarryDistanceF, false, kCarryRateF}, 1);
  return Horizontal(task, {74.9, 0.278, kCarryHeightM, kCarryDistanceM, true, kCarryRateM}, 1);
}

}  // namespace predictor::ergonomics
