// The loop closed: what identifying the joint friction does to an emulation's fidelity.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/identify/identify.h"
#include "analysis/identify/real.h"
#include "evaluation/statistics_same_kind.h"
#include "scenario/scenario.h"

namespace predictor {

struct IdentifyLoopOptions {
  int seeds = 17;                   // runs of each kind, at least 2
  std::uint64_t first_seed = 1001;  // the real runs'; the emulated runs take the ones that follow
  RealCobot real;                   // without friction: drawn from its seed
  std::filesystem::path folder;     // for the real cobot's files; must exist
  std::function<void(double share)> progress = {};
};

// Mean over pairs of runs.
struct Agreement {
  double rmse = 0, rmse_deviation = 0;  // mean and standard deviation over the pairs [unit]
  double correlation = 0;               // Pearson's, mean
};

// One channel: a hand's force along an axis of W, or the end-effector's position.
struct AxisAgreement {
  std::string name, unit;
  double range = 0;         // of the real runs, mean [unit]
  Agreement repeat;         // two real runs of different seeds
  Agreement before, after;  // a real run and an emulated one, with the friction as it was believed
                            // and as it was identified
  // The real runs against the emulated ones, whole runs laid over one another by the cycle's phase.
  SameKindTest same_before, same_after;
  // There are runs enough to tell the kinds apart, and they do not.
  bool indistinguishable_before() const {
    return same_before.can_tell() && !same_before.told_apart();
  }
  bool indistinguishable_after() const { return same_after.can_tell() && !same_after.told_apart(); }
};

struct IdentifyLoopResult {
  RealCobot real;                 // the truth
  Identification identification;  // of a real run of the excitation
  JointFriction believed, found;
  int seeds = 0;
  std::vector<AxisAgreement> axes;
  std::uint64_t first_seed = 0;
};

// Excites the real cobot, identifies its friction, and compares `seeds` real runs of `task` with as
// many emulated ones, of other draws of the person's, before and after. Both scenarios tell of the
// same cobot as it is believed to be. Throws InputError; std::runtime_error if a run was stopped.
IdentifyLoopResult IdentifyLoop(const Scenario& excitation, const Scenario& task,
                                const IdentifyLoopOptions& options);

std::string IdentifyLoopText(const IdentifyLoopResult& result);  // for people

}  // namespace predictor
