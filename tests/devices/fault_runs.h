// Runs faults, each in a process of its own that splits off a run that goes on: the same beginning
// serves all of them, and one that dies is seen.
#pragma once

#include <string>
#include <vector>

#include "devices/faults.h"

namespace predictor {

// In FaultRun::fault: the audit of what was written to the arms in runs of that seed.
inline constexpr std::size_t kAudit = ~std::size_t{0};

// One fault at a rig, or two (the second up to 100 ms after the first), with one seed.
struct FaultRun {
  std::size_t fault = 0;  // in Faults()
  int second = -1;        // the same; none
  std::uint64_t seed = 0;
  std::uint64_t beginning = 0;  // of the runs that are audited with it
  FaultOutcome outcome;
};

struct FaultRuns {
  std::vector<FaultRun> all;
  std::size_t due = 0, audits_due = 0;  // as many must be in it
};

// Whether the rig has what carries this fault.
bool Concerns(const Fault& fault, const FaultRig& rig);

// Whether the second can come upon a run of the rig that the first has befallen: faults up to 33,
// of which each order counts, but of those with which a run begins, or after which it is no more.
bool HavePair(const Fault& first, const Fault& second, const FaultRig& rig);

// When a fault comes, in RUN: in the middle of the first motions [s].
double TimeOf(const std::string& fault, std::uint64_t seed);

// Each fault that concerns the rig with the seeds from 1 on; or each pair, spread over so many
// seeds. On all processors. What an earlier, broken off run of the same program has done and
// audited, by the same audit, scenario and descriptions, is not done again, if `kept` names a file
// for it.
FaultRuns RunFaults(const FaultRig& rig, long seeds, const std::string& kept);
FaultRuns RunFaultPairs(const FaultRig& rig, double share, const std::string& kept);

}  // namespace predictor
