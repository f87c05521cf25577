// Models of muscle fatigue for each joint. In all models, the load is the share of strength u =
// torque / strength in the same direction, 0 … 1. The models have no memory beyond their state and
// do not allocate.
//
// Without a trial, these models do not predict the endurance of a particular person, because people
// differ by a factor of two or more. The models also do not predict eccentric or fast movement, or
// pain.
#pragma once

#include <string_view>

namespace predictor::ergonomics {

enum class FatigueJoint { kAnkle, kKnee, kTrunk, kShoulder, kElbow, kGrip, kGeneral };
inline constexpr int kFatigueJoints = 7;

// Returns "shoulder", …
std::string_view NameOf(FatigueJoint joint);

// ---- Three compartments with rest recovery, 3CC-r (Xia & Frey-Law 2008; Looft et al. 2018) ----

// Constants of a joint.
struct FatigueRates {
  double fatigue = 0;          // F [1/s]
  double recovery = 0;         // R [1/s]
  double rest_multiplier = 1;  // r: the recovery rate is r R while the load is 0
};

// F and R are from Frey-Law, Looft & Heitsman 2012 (verified in MyoSuite's test; the extremes also
// in the paper's abstract). The value r = 15 is from Looft & Frey-Law 2020 for the shoulder
// (verified) and is also used for the other joints (design choice). The grip has the value 30
// (quoted from memory, not verified).
FatigueRates FatigueRatesOf(FatigueJoint joint);

// Shares of the muscle. The sum of the shares is 1.
struct Compartments {
  double active = 0, resting = 1, fatigued = 0;
  // Returns the remaining strength, as a share of full strength.
  double capacity() const { return active + resting; }
};

// Returns the state after `dt` [s] at constant load 0 … 1. The function uses Runge-Kutta steps of
// at most 0.05 s, which are stable for the development rate of 10 1/s.
Compartments Fatigued(const Compartments& state, double load, double dt, const FatigueRates& rates);

// Computes the fatigue in closed form for a person who is rested at the start and then holds a
// load. Returns the fatigued share after `time` [s]. The result is valid until the endurance time.
double FatiguedShareUnderConstantLoad(double load, double time, const FatigueRates& rates);

// Returns the time [s] for which a rested person can hold the load in this model, or infinity if
// there is no limit.
double EnduranceTime(double load, const FatigueRates& rates);

// ---- Endurance from experiments ----

// Returns the endurance time [s] according to the power law b0 · load^b1 of Frey-Law & Avin 2010
// (from 194 publications; coefficients verified in MyoSuite's test). The time is infinite for a
// load of 0.
double MeasuredEnduranceTime(double load, FatigueJoint joint);

// Returns the endurance time [s] according to Rohmert 1960 for 0.15 < load ≤ 1, and infinity for
// smaller loads (quoted from memory, not verified).
double RohmertEnduranceTime(double load);

// ---- One state: Ma et al. 2009 ----

struct CapacityRates {
  // k [1/s] is 1 per minute (quoted from memory). A later study of the elbows of 30 people found a
  // rate with a mean of 0.96 per minute and a standard deviation of 0.29 per minute (Ergonomics 61,
  // 806, abstract; verified).
  double fatigue = 1.0 / 60;
  double recovery = 2.4 / 60;  // [1/s] 2.4 per minute (quoted from memory, not verified)
};
// Returns the remaining share of strength after `dt` [s] at constant load. The result is exact for
// any dt. Under load, the share is c exp(−k load dt). At rest, the share returns to 1 exponentially
// (form verified).
double Capacity(double capacity, double load, double dt, const CapacityRates& rates = {});
// Returns the endurance time −ln(load) / (k load) [s].
double CapacityEnduranceTime(double load, const CapacityRates& rates = {});

// ---- One state: Peternel et al. 2018 ----

// The parameters follow from one trial in which the person held a reference load until exhaustion.
// The form and the constants are quoted from memory and were not verified.
struct TrialFatigue {
  double reference_load = 0.5;  // 0 … 1
  double reference_time = 60;   // [s]
  double threshold = 0.1;       // loads below it count as rest
  double recovery = 0.5;        // R, as a share of the reference effort
  double Effort() const;        // C [s]: −load · time / ln(1 − kTrialExhaustion)
};
// The fatigue at which the person is exhausted.
inline constexpr double kTrialExhaustion = 0.993;
// Returns the fatigue 0 … 1 after `dt` [s] at constant load. The result is exact for any dt.
double TrialFatigueAfter(double fatigue, double load, double dt, const TrialFatigue& trial);

}  // namespace predictor::ergonomics
