// Brings a fault upon a run that goes on, and judges what follows.
#pragma once

#include <string>

#include "devices/faults.h"
#include "scenario/stop_budget.h"

namespace predictor {

// audit: file to which what was written to the arms is appended.
FaultOutcome Bring(Bench& bench, const Fault& fault, const FaultRig& rig, std::uint64_t seed,
                   const std::string& audit);
// The second comes up to 100 ms after the first.
FaultOutcome BringBoth(Bench& bench, const Fault& first, const Fault& second, const FaultRig& rig,
                       std::uint64_t seed, const std::string& audit);

// What a person at the console is told of a stop, warnings and devices.
std::string Told(const Bench& bench);

// The parts of a judgement, for faults that come otherwise.
// Whether what was told is in the words of the fault, and of its hand first.
void JudgeTold(const Fault& fault, int hand, FaultOutcome* outcome);
void Take(const BenchStop& stop, FaultOutcome* outcome);
// Time and way of a stop.
void JudgeReach(const StopBudget& most, FaultOutcome* outcome);
void JudgeStop(const Fault& fault, const StopBudget& most, FaultOutcome* outcome);
// Nothing moves any more.
void JudgeRest(Bench& bench, FaultOutcome* outcome);

}  // namespace predictor
