// Injects a fault into a run and judges the result.
#pragma once

#include <string>

#include "devices/faults.h"
#include "scenario/stop_budget.h"

namespace predictor {

// `audit` is the file to which the commands to the arms are appended.
FaultOutcome Bring(Bench& bench, const Fault& fault, const FaultRig& rig, std::uint64_t seed,
                   const std::string& audit);
// The second fault occurs up to 100 ms after the first.
FaultOutcome BringBoth(Bench& bench, const Fault& first, const Fault& second, const FaultRig& rig,
                       std::uint64_t seed, const std::string& audit);

// Returns the text that a person at the console sees: the stop, warnings, and faults of devices.
std::string Messages(const Bench& bench);

// The following functions are parts of the judgement that are also used for other kinds of faults.
// JudgeMessage checks that the message describes the fault and names its hand first.
void JudgeMessage(const Fault& fault, int hand, FaultOutcome* outcome);
void Take(const BenchStop& stop, FaultOutcome* outcome);
// Checks the time and the distance of a stop.
void JudgeReach(const StopBudget& most, FaultOutcome* outcome);
void JudgeStop(const Fault& fault, const StopBudget& most, FaultOutcome* outcome);
// Checks that nothing moves any longer.
void JudgeRest(Bench& bench, FaultOutcome* outcome);

}  // namespace predictor
