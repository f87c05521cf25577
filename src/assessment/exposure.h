// Damage and fatigue that a run causes, from the moments and forces over time.
#pragma once

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
  double day_share = 0;    // of the reference day, per run
  double shift_share = 0;  // of the reference day, if the run is repeated for 8 h
  double probability = 0;  // of the tool's outcome for that shift
};

// `moment` [N·m]: during a run of `duration` [s]. Ranges below kMinRange do not count.
DamageResult DamageOfMoment(const std::string& tool, const std::string& part,
                            std::span<const double> moment, double duration,
                            double (*per_cycle)(double), const ergonomics::DamageRisk& risk);
inline constexpr double kMinRange = 1;  // a design choice, above the noise of the sensors [N·m]

// Fatigue of one joint by 3CC-r.
struct FatigueResult {
  std::string joint;         // "left shoulder"
  double mean_load = 0;      // share of strength
  double capacity = 1;       // strength that is left at the end of the run, as a share
  double time_to_limit = 0;  // until a repetition of the run needs more than what is left [s];
                             // infinite: not within 8 h
};

// `load`: share of strength at 100 Hz.
FatigueResult FatigueOfLoad(const std::string& joint, ergonomics::FatigueJoint kind,
                            std::span<const double> load);

}  // namespace predictor::assessment
