// Cumulative damage of a working day by fatigue failure of tissue: LiFFT (back), DUET (hand and
// forearm), Shoulder Tool. Each repetition causes damage, and the damages add up (Palmgren-Miner).
//
// In contrast to posture scores, the damage changes smoothly with load and lever arm, so it shows
// the benefit of a change of a design. The methods may be used with measured moments, so they
// include the benefit of assistance (as in Zelik et al. 2022 for exoskeletons).
//
// All of the following pitfalls were found in public code: - Another form of LiFFT uses the
// compression, e^(0.162 S) / 902416 with S in % of 10 kN. If it is
//   mixed up with the moment form below, the damage doubles.
// - A second DUET (S = 10 OMNI, 0.766, 1.515) was fitted to two examples. This formula agrees with
// one published example and is wrong elsewhere, so agreement with one example is not sufficient.
// - The probabilities are those of a *job* with many injuries in US car plants. These probabilities
// are not the risk of a person.
//
// Some methods are omitted because no source could be verified: Potvin's maximum acceptable effort
// (public copies differ in a constant), ACGIH's hand activity level, the revised strain index and
// RCRA.
#pragma once

#include <span>

#include "ergonomics/rainflow.h"

namespace predictor::ergonomics {

// Probability of the outcome for a day's damage: a logistic function of log10(damage).
struct DamageRisk {
  double constant = 0, slope = 0;
  double Probability(double daily_damage) const;  // 0 … 1; 0 without damage
  // Inverts Probability: returns the daily damage with this probability, 0 < probability < 1.
  double DailyDamage(double probability) const;
};

// ---- Back: LiFFT (Gallagher et al. 2017, as printed by Zelik et al. 2022; verified) ----
// Outcome: a job with at least 12 low back injuries per 200 000 h.
inline constexpr DamageRisk kLiftRisk = {1.72, 1.03};
// `load_moment` [N·m] is the moment of the handled load alone about the lower back, that is, load
// times its horizontal distance, without the weight of the trunk. Interpret results above 100 N·m
// with care.
double LiftDamage(double load_moment);

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
// Returns the moment [N·m] due to holding `force` [N] with one hand at the horizontal distance
// `lever` [m] from the shoulder, with an arm of 8.6 lb at half the distance. For pushes and pulls,
// use force · lever.
double ShoulderMoment(double force, double lever);

// ---- A run, and a shift ----

// Returns the damage of a run, which is the sum over its rainflow cycles. Only the range of a cycle
// counts, so a constant moment or the mean of a cycle causes no damage (design choice: the tools
// only consider loads that begin and end at zero).
double DamageOf(std::span<const LoadCycle> cycles, double (*damage_per_cycle)(double));

// The reference day (design choice): the day whose damage has a probability of one half on the
// tool's own curve. If each lift causes 0.1 % of this damage, the job has the outcome with a
// probability of one half after 1000 lifts per day.
inline constexpr double kReferenceProbability = 0.5;
// Returns `damage` as a share of the reference day; 0.001 means 0.1 %.
double ShareOfReferenceDay(double damage, const DamageRisk& risk);

// Returns the damage of a shift in which the run is repeated without a break. Both durations are
// above 0.
double DamageOfShift(double damage_of_run, double run_duration,  // [s]
                     double shift_duration = 8 * 3600.0);        // [s]

}  // namespace predictor::ergonomics
