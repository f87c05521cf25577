// Computes the cumulative damage of a working day due to fatigue failure of tissue. The methods are
// LiFFT (back), DUET (hand and forearm) and the Shoulder Tool. Each repetition causes damage, and
// the damages add up (Palmgren-Miner).
//
// In contrast to posture scores, the damage changes smoothly with load and lever arm. The damage
// therefore shows how much a change of a design improves the work. The methods may be used with
// measured moments and therefore include the benefit of assistance (as in Zelik et al. 2022 for
// exoskeletons).
//
// All of the following pitfalls were found in public code:
// - Another form of LiFFT uses the compression, e^(0.162 S) / 902416 with S in % of 10 kN. If this
//   form is mixed up with the moment form below, the damage doubles.
// - A second DUET (S = 10 OMNI, 0.766, 1.515) was fitted to two examples. This formula agrees with
//   one published example but is wrong elsewhere. Agreement with one example is therefore not
//   sufficient.
// - The probabilities are those of a *job* with many injuries in US car plants. These probabilities
//   are not the risk of a person.
//
// Some methods are omitted because no source could be verified. These are Potvin's maximum
// acceptable effort (public copies differ in a constant), the revised strain index and RCRA.
// ACGIH's hand activity level is in hand_activity.h.
#pragma once

#include <limits>
#include <span>

#include "ergonomics/rainflow.h"

namespace predictor::ergonomics {

// The probability of the outcome for a day's damage, which is a logistic function of log10(damage).
struct DamageRisk {
  double constant = 0, slope = 0;
  double Probability(double daily_damage) const;  // 0 … 1; 0 without damage
  // Returns the daily damage that has this probability, 0 < probability < 1. This function is the
  // inverse of Probability.
  double DailyDamage(double probability) const;
};

// ---- Back: LiFFT (Gallagher et al. 2017, as printed by Zelik et al. 2022; verified) ----
// Outcome: a job with at least 12 low back injuries per 200 000 h.
inline constexpr DamageRisk kLiftRisk = {1.72, 1.03};
// `load_moment` [N·m] is the moment of the handled load about the lower back, which is the load
// times its horizontal distance. This moment does not include the weight of the trunk. Interpret
// results above kLargestLiftMoment with care.
double LiftDamage(double load_moment);
inline constexpr double kLargestLiftMoment = 100;  // [N·m]

// ---- Hand and forearm: DUET (Gallagher et al. 2018; verified against its table and examples) ----
// Outcome: injury, or pain in the last year.
inline constexpr DamageRisk kHandRisk = {0.573, 0.747};
// `effort` is 0 … 10 on the OMNI-RES scale (0 extremely easy, 10 extremely hard).
double HandDamage(double effort);

// ---- Shoulder Tool (Bani Hani et al. 2021; verified against published examples) ----
// Outcome: first visit to the plant's clinic because of the shoulder.
inline constexpr DamageRisk kShoulderRisk = {0.870, 0.932};
// `moment` [N·m] is the moment at the shoulder. The strength of the median man is 76.9 N·m (681
// in·lb).
double ShoulderDamage(double moment);
// Returns the moment at the shoulder [N·m] if one hand holds `force` [N] at the horizontal distance
// `lever` [m] from the shoulder. The arm weighs 8.6 lb, and its weight acts at half the distance.
// For pushes and pulls, use the product force · lever as the moment.
double ShoulderMoment(double force, double lever);

// A tool for the damage of one part of the body.
struct DamageTool {
  const char* name;
  double (*per_cycle)(double load);  // damage of one repetition
  DamageRisk risk;
  double largest_load;  // the largest load of the tool's range; infinite: no limit is known
};
inline constexpr double kNoLargestLoad = std::numeric_limits<double>::infinity();
inline constexpr DamageTool kLiftTool = {"LiFFT", LiftDamage, kLiftRisk, kLargestLiftMoment};
inline constexpr DamageTool kHandTool = {"DUET", HandDamage, kHandRisk, kNoLargestLoad};
inline constexpr DamageTool kShoulderTool = {"Shoulder Tool", ShoulderDamage, kShoulderRisk,
                                             kNoLargestLoad};

// ---- A run, and a shift ----

// Returns the damage of a run, which is the sum of the damage of its rainflow cycles. Only the
// range of a cycle counts, so neither a constant moment nor the mean of a cycle causes damage. This
// is a design choice, because the tools only consider loads that begin and end at zero.
double DamageOf(std::span<const LoadCycle> cycles, double (*damage_per_cycle)(double));

// The damage of the reference day (design choice). On the tool's own curve, this damage has a
// probability of one half. For example, if each lift causes 0.1 % of this damage, a job with 1000
// lifts per day has the outcome with a probability of one half.
inline constexpr double kReferenceProbability = 0.5;
// Returns `damage` as a share of the damage of the reference day. The value 0.001 means 0.1 %.
double ShareOfReferenceDay(double damage, const DamageRisk& risk);

inline constexpr double kShift = 8 * 3600;  // duration of a shift [s]
// Returns the damage of a shift in which the run is repeated without a break. The duration of the
// run [s] must be above 0.
double DamageOfShift(double damage_of_run, double run_duration);

}  // namespace predictor::ergonomics
