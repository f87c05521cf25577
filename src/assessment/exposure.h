// Computes the damage and the fatigue that a run causes, from the moments and forces over time.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ergonomics/damage.h"
#include "ergonomics/fatigue.h"

namespace predictor::assessment {

// Cumulative damage of one part of the body.
struct DamageResult {
  std::string tool, part;  // "LiFFT", "lower back"
  double per_run = 0;      // damage
  double day_share = 0;    // damage of the run, relative to the reference day
  double shift_share = 0;  // damage of an 8 h shift of such runs, relative to the reference day
  double probability = 0;  // probability of the tool's outcome after that shift
  // Largest load of the run divided by DamageTool::largest_load.
  double load_over_range = 0;
  // If a load is beyond the tool's range, the numbers above are extrapolated and must be marked.
  bool outside() const { return load_over_range > 1; }
};

// `moment` [N·m] covers a run at 100 Hz and is 0 at rest. The moment is low-passed with
// SmoothMoment. Ranges below kMinRange, or below the share kMinRangeShare of the largest range, are
// ignored. Without these thresholds, tremor and noise would count as lifts, because, in this
// method, each cycle causes some damage even without a load.
DamageResult DamageOfMoment(const ergonomics::DamageTool& tool, const std::string& part,
                            std::span<const double> moment);
// Returns the result for a run of `duration` [s] whose repetitions cause `damage` in total.
DamageResult DamageOfRepetitions(const ergonomics::DamageTool& tool, const std::string& part,
                                 double damage, double duration);
// Low-passes a moment at 100 Hz at kDamageCutoff in both directions, from rest to rest.
std::vector<double> SmoothMoment(std::span<const double> moment);
// Design choices.
inline constexpr double kDamageCutoff = 1;     // [Hz]
inline constexpr double kMinRange = 5;         // [N·m]
inline constexpr double kMinRangeShare = 0.2;  // share of the largest range

// The share of the time for which a load may be unknown. If it is unknown for longer, damage and
// fatigue are not evaluated (design choice).
inline constexpr double kMaxUnknownShare = 0.05;
// Replaces each unknown load (not a number) by the load before it, and by the first known load at
// the start. Returns nothing if more than kMaxUnknownShare of the loads are unknown.
std::optional<std::vector<double>> WithoutGaps(std::vector<double> load);

// Computes the fatigue of one joint sample by sample with the 3CC-r model.
class FatigueTracker {
 public:
  explicit FatigueTracker(ergonomics::FatigueJoint kind)
      : rates_(ergonomics::FatigueRatesOf(kind)) {}
  // Adds the next sample's load, at 100 Hz, as a share of strength. Fatigue changes within minutes,
  // so the state is updated at 10 Hz, with the mean load.
  void Add(double load);
  void Step(double mean_load);                           // advances by 0.1 s
  double capacity() const { return state_.capacity(); }  // remaining strength, as a share
  bool IsTooMuch(double load) const { return load > capacity(); }

 private:
  ergonomics::FatigueRates rates_;
  ergonomics::Compartments state_;
  double sum_ = 0;
  std::size_t count_ = 0;
};

// What a model of fatigue predicts for a run and its repetitions.
struct FatigueCourse {
  double capacity = 1;       // remaining strength at the end of the run, as a share
  double time_to_limit = 0;  // time until a repetition of the run needs more than the remaining
                             // strength [s]; infinite if longer than 8 h
};

// Fatigue of one joint over a run.
struct FatigueResult {
  std::string joint;           // "left shoulder"
  double mean_load = 0;        // share of strength
  FatigueCourse compartments;  // 3CC-r
  FatigueCourse ma;            // Ma et al. 2009
  // Peternel et al. 2018, if a trial was stated: `capacity` is 1 minus the fatigue, and the limit
  // is complete fatigue (kTrialExhaustion).
  std::optional<FatigueCourse> trial;
  // Time for which people held the mean load without a break (MeasuredEnduranceTime) [s].
  double endurance = 0;
};

// `load` is a share of strength at 100 Hz.
FatigueResult FatigueOfLoad(const std::string& joint, ergonomics::FatigueJoint kind,
                            std::span<const double> load,
                            const std::optional<ergonomics::TrialFatigue>& trial = {});

}  // namespace predictor::assessment
