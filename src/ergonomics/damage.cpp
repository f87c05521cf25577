#include "ergonomics/damage.h"

#include <algorithm>
#include <cmath>

#include "ergonomics/published_units.h"

namespace predictor::ergonomics {
namespace {

constexpr double kArmWeight = 8.6 * kPoundForce;                 // [N]
constexpr double kShoulderStrength = 681 * kInch * kPoundForce;  // [N·m]

// Returns the damage per cycle of a tendon at `stress`, in % of its ultimate stress (Schechtman &
// Bader 1997; verified in a public copy).
double TendonDamage(double stress) { return std::pow(10, (stress - 101.25) / 14.83); }

}  // namespace

double DamageRisk::Probability(double daily_damage) const {
  if (daily_damage <= 0) return 0;
  return 1 / (1 + std::exp(-(constant + slope * std::log10(daily_damage))));
}

double DamageRisk::DailyDamage(double probability) const {
  return std::pow(10, (std::log(probability / (1 - probability)) - constant) / slope);
}

double LiftDamage(double load_moment) { return std::exp(0.038 * load_moment + 0.32) / 1902416; }

double HandDamage(double effort) {
  // The greatest effort loads a tendon to 1/1.4 of its failure stress. DUET's table assigns a
  // stress of 3.6 % to effort 0.
  return TendonDamage(std::max(3.6, 10 * effort / 1.4));
}

double ShoulderDamage(double moment) { return TendonDamage(100 * moment / kShoulderStrength); }

double ShoulderMoment(double force, double lever) { return force * lever + kArmWeight * lever / 2; }

double DamageOf(std::span<const LoadCycle> cycles, double (*damage_per_cycle)(double)) {
  double sum = 0;
  for (const LoadCycle& cycle : cycles) sum += cycle.count * damage_per_cycle(cycle.range);
  return sum;
}

double ShareOfReferenceDay(double damage, const DamageRisk& risk) {
  return damage / risk.DailyDamage(kReferenceProbability);
}

double DamageOfShift(double damage_of_run, double run_duration) {
  return damage_of_run * kShift / run_duration;
}

}  // namespace predictor::ergonomics
