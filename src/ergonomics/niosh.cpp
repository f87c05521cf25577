#include "ergonomics/niosh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/types.h"
#include "core/units.h"

namespace predictor::ergonomics {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();  // index if no load is allowed
constexpr double kKnuckleHeight = 0.75;      // [m] optimal height, and the boundary between two
                                             // tables
constexpr double kMaxLiftHeight = 1.75;      // [m]
constexpr double kMinLiftHorizontal = 0.25;  // [m]
constexpr double kMaxLiftHorizontal = 0.63;  // [m]
constexpr double kMinLiftTravel = 0.25;      // [m]
constexpr double kMaxLiftTravel = 1.75;      // [m]
constexpr double kMaxLiftAsymmetry = 135;    // [°]
constexpr double kAsymmetryLoss = 0.0032;    // [1/°]
constexpr double kVerticalLoss = 0.3;        // [1/m]

constexpr std::array<double, 17> kFrequencies = {0.2, 0.5, 1,  2,  3,  4,  5,  6, 7,
                                                 8,   9,   10, 11, 12, 13, 14, 15};
constexpr std::size_t kRows = 17;
// Table 5 in hundredths. A lift is low if the hands are below 0.75 m at the origin.
struct FrequencyColumns {
  std::array<int, kRows> high;
  std::size_t rows_high, rows_low;  // rows that are not 0
};
constexpr FrequencyColumns kFrequencyTable[3] = {
    {{100, 97, 94, 91, 88, 84, 80, 75, 70, 60, 52, 45, 41, 37, 34, 31, 28}, 17, 14},
    {{95, 92, 88, 84, 79, 72, 60, 50, 42, 35, 30, 26, 23, 21, 0, 0, 0}, 14, 12},
    {{85, 81, 75, 65, 55, 45, 35, 27, 22, 18, 15, 13, 0, 0, 0, 0, 0}, 12, 10}};

double CouplingMultiplier(Coupling coupling, double height) {
  if (coupling == Coupling::kGood) return 1;
  if (coupling == Coupling::kFair) return height < kKnuckleHeight ? 0.95 : 1;
  return 0.90;
}

LiftMultipliers MultipliersAt(const HandPlace& place, const LiftTask& task) {
  LiftMultipliers m;
  if (place.horizontal <= kMaxLiftHorizontal)
    m.horizontal = kMinLiftHorizontal / std::max(place.horizontal, kMinLiftHorizontal);
  if (place.height >= 0 && place.height <= kMaxLiftHeight)
    m.vertical = 1 - kVerticalLoss * std::abs(place.height - kKnuckleHeight);
  const double travel = std::abs(task.destination.height - task.origin.height);
  if (travel <= kMaxLiftTravel) m.distance = 0.82 + 0.045 / std::max(travel, kMinLiftTravel);
  const double angle = std::abs(place.asymmetry) * kDegrees;
  if (angle <= kMaxLiftAsymmetry) m.asymmetry = 1 - kAsymmetryLoss * angle;
  m.frequency = FrequencyMultiplier(task.frequency, task.duration, task.origin.height);
  m.coupling = CouplingMultiplier(task.coupling, place.height);
  return m;
}

double Ratio(double load, double limit) {
  if (limit > 0) return load / limit;
  return load > 0 ? kNoLimit : 0;
}

// The properties of a task that the composite index needs.
struct RatedTask {
  const LiftTask* task;
  double frequency_independent_index;  // FILI
  double single_task_index;            // STLI
};

RatedTask Rate(const LiftTask& task) {
  const LiftAssessment lift = AssessLift(task);
  const LiftMultipliers& m = lift.by_destination ? lift.destination : lift.origin;
  return {&task, Ratio(task.max_load, m.FrequencyIndependentLimit()),
          Ratio(task.mean_load, lift.limit)};
}

// Returns the lowest of the frequency multipliers that these tasks have at the sum of their
// frequencies.
double CombinedMultiplier(std::span<const RatedTask> tasks) {
  double frequency = 0, lowest = 1;
  for (const RatedTask& rated : tasks) frequency += rated.task->frequency;
  for (const RatedTask& rated : tasks)
    lowest = std::min(
        lowest, FrequencyMultiplier(frequency, rated.task->duration, rated.task->origin.height));
  return lowest;
}

}  // namespace

double FrequencyMultiplier(double per_minute, LiftDuration duration, double height_at_origin) {
  const FrequencyColumns& columns = kFrequencyTable[static_cast<int>(duration)];
  const std::size_t rows = height_at_origin < kKnuckleHeight ? columns.rows_low : columns.rows_high;
  const double f = std::max(per_minute, kFrequencies[0]);
  if (f > kFrequencies[rows - 1]) return 0;
  std::size_t above = 1;
  while (kFrequencies[above] < f) ++above;
  const double share =
      (f - kFrequencies[above - 1]) / (kFrequencies[above] - kFrequencies[above - 1]);
  return std::lerp(columns.high[above - 1], columns.high[above], share) / 100;
}

LiftAssessment AssessLift(const LiftTask& task) {
  LiftAssessment lift;
  lift.origin = MultipliersAt(task.origin, task);
  lift.destination = MultipliersAt(task.destination, task);
  lift.limit = lift.origin.Limit();
  if (task.controlled_at_destination && lift.destination.Limit() < lift.limit) {
    lift.limit = lift.destination.Limit();
    lift.by_destination = true;
  }
  lift.index = Ratio(task.mean_load, lift.limit);
  return lift;
}

double CompositeLiftingIndex(std::span<const LiftTask> tasks) {
  if (tasks.empty()) return 0;
  std::vector<RatedTask> rated;
  for (const LiftTask& task : tasks) rated.push_back(Rate(task));
  std::ranges::stable_sort(rated, [](const RatedTask& a, const RatedTask& b) {
    if (a.single_task_index != b.single_task_index)
      return a.single_task_index > b.single_task_index;
    return a.task->frequency > b.task->frequency;
  });
  double index = rated[0].single_task_index, before = 0;
  for (std::size_t n = 0; n < rated.size(); ++n) {
    const double multiplier = CombinedMultiplier(std::span(rated).first(n + 1));
    if (multiplier == 0 || std::isinf(rated[n].frequency_independent_index)) return kNoLimit;
    if (n > 0) index += rated[n].frequency_independent_index * (1 / multiplier - 1 / before);
    before = multiplier;
  }
  return index;
}

AssistedLift AssessAssistedLift(const LiftTask& whole, double mean_vertical_force) {
  LiftTask carried = whole;
  carried.mean_load = carried.max_load = std::max(0.0, mean_vertical_force / kStandardGravity);
  return {AssessLift(carried), AssessLift(whole)};
}

}  // namespace predictor::ergonomics
