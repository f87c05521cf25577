// Measures the effect of identified joint friction on the fidelity of an emulation.
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
  std::uint64_t first_seed = 1001;  // first seed of the real runs; the emulated runs use the seeds
                                    // after theirs
  RealCobot real;                   // without friction; it is drawn from the seed
  std::filesystem::path folder;     // for the files of the real cobot; must exist
  std::function<void(double share)> progress = {};
};

// The agreement as a mean over pairs of runs.
struct Agreement {
  double rmse = 0, rmse_deviation = 0;  // mean and standard deviation over the pairs [unit]
  double correlation = 0;               // mean of Pearson's correlation
};

// One channel: a hand's force along an axis of W, or the end-effector's position.
struct AxisAgreement {
  std::string name, unit;
  double range = 0;         // mean range of the real runs [unit]
  Agreement repeat;         // two real runs with different seeds
  Agreement before, after;  // a real run and an emulated run, with nominal and with identified
                            // friction
  // The real runs compared with the emulated runs; whole runs are aligned by the phase of the
  // cycle.
  SameKindTest same_before, same_after;
  // Returns whether there are enough runs to detect a difference between real and emulated runs,
  // and the test found none.
  bool indistinguishable_before() const {
    return same_before.can_distinguish() && !same_before.distinguished();
  }
  bool indistinguishable_after() const {
    return same_after.can_distinguish() && !same_after.distinguished();
  }
};

struct IdentifyLoopResult {
  RealCobot real;                 // the true cobot
  Identification identification;  // from a real run of the excitation
  JointFriction nominal, found;
  int seeds = 0;
  std::vector<AxisAgreement> axes;
  std::uint64_t first_seed = 0;
};

// Excites the real cobot and identifies the friction of its joints. Before and after the
// identification, compares `seeds` real runs of `task` with the same number of emulated runs. The
// emulated runs use different random draws for the operator. Both scenarios describe the same
// nominal cobot. Throws InputError, or std::runtime_error if a run was stopped.
IdentifyLoopResult IdentifyLoop(const Scenario& excitation, const Scenario& task,
                                const IdentifyLoopOptions& options);

}  // namespace predictor
