// What was written to the arms of a run, in a file for audit_commands.py, which knows nothing of
// the program's own limits and guard.
#pragma once

#include <string>

#include "devices/faults.h"

namespace predictor {

// Appends a run: what is known of the arms and the stop, and what the bench captured. name: for a
// person.
void AppendForAudit(const std::string& file, const std::string& name, const FaultRig& rig,
                    const Bench& bench, const BenchStop& stop);

// Runs the script over a file. Returns "" or what it found.
std::string Audit(const std::string& file);

}  // namespace predictor
