// The parts of `bench`.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/record.h"
#include "qp_set.h"
#include "recording.h"

namespace predictor::bench {

// Whole runs in virtual time.
struct RunTimes {
  std::array<double, kStages> p50{}, p99{};  // of ticks in RUN [µs], medians over the runs
  double cpu_factor = 0, wall_factor = 0;    // simulated time over time of one core, of the clock
  double start_up = 0;                       // scenario file to end of the first tick [s]
};
RunTimes TimeRuns(const std::string& scenario, int runs);

// What real arms' drivers, monitor and guard take of a tick, printed. quick: fewer ticks, and not
// over sockets.
void TimeDriversAndSupervisor(bool quick);

// Isolated benchmarks of the stages' parts by google-benchmark: name → median [µs].
std::map<std::string, double> TimeParts(const Recording& recording, int* argc, char** argv);

// What recordings of these scenarios' runs cost.
void CompareRecordings(const std::vector<std::string>& names);

// Solvers on the same problems.
void CompareSolvers(const std::vector<ProblemSet>& sets, int repetitions);

}  // namespace predictor::bench
