// Writes the commands that a run sent to the arms into a file. audit_commands.py checks this file
// independently of the program's limits and guard.
#pragma once

#include <cstdint>
#include <string>

#include "devices/faults.h"

namespace predictor {

// Appends a run: data about the arms and the stop, and the bytes that the bench recorded. `name` is
// a label for messages.
void AppendForAudit(const std::string& file, const std::string& name, const FaultRig& rig,
                    const Bench& bench, const BenchStop& stop);

// Appends a run with the fault and the seed as the label.
void AppendForAudit(const std::string& file, const Fault& fault, std::uint64_t seed,
                    const FaultRig& rig, const Bench& bench, const BenchStop& stop);

// Runs the script on a file. Returns its findings, or "" if there are none.
std::string Audit(const std::string& file);

}  // namespace predictor
