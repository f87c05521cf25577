// Runs each fault in a child process that is forked from an active run. All faults therefore share
// the same beginning, and a crash is detected.
#pragma once

#include <string>
#include <vector>

#include "devices/faults.h"

namespace predictor {

// This value of FaultRun::fault stands for the audit of the commands in all runs with the same
// beginning.
inline constexpr std::size_t kAudit = ~std::size_t{0};

// A run on a rig with one seed and with one or two faults. The second fault occurs up to 100 ms
// after the first.
struct FaultRun {
  std::size_t fault = 0;  // index in Faults()
  int second = -1;        // index in Faults(); −1: none
  std::uint64_t seed = 0;
  std::uint64_t beginning = 0;  // identifies the runs that share an audit
  FaultOutcome outcome;
};

struct FaultRuns {
  std::vector<FaultRun> all;
  std::size_t due = 0, audits_due = 0;  // numbers of entries that it must contain
};

// Returns the number of the only fault to test, from the environment (PREDICTOR_FAULT), or 0 for
// all faults.
int OnlyFault();

// Returns whether the rig has the device to which this fault applies and the fault is to be tested.
bool Concerns(const Fault& fault, const FaultRig& rig);

// Returns whether the second fault can occur after the first in a run of the rig. Only faults with
// numbers up to 33 form pairs. Two faults form two pairs, one for each order. If a run begins with
// one of the faults or cannot continue after it, the faults form at most one pair.
bool HavePair(const Fault& first, const Fault& second, const FaultRig& rig);

// Returns the time in RUN at which a fault is injected, during the first motions [s].
double TimeOf(const std::string& fault, std::uint64_t seed);

// Runs faults on all processors. Runs either every fault that applies to the rig, with the seeds
// from 1 on, or a share of all pairs of faults, distributed over the seeds. If `kept` names a file,
// results of an earlier, interrupted call are reused, provided that the program, the audit, the
// scenario and the robot descriptions are unchanged.
FaultRuns RunFaults(const FaultRig& rig, long seeds, const std::string& kept);
FaultRuns RunFaultPairs(const FaultRig& rig, double share, const std::string& kept);

}  // namespace predictor
