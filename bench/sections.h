// The sections of `bench`.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/record.h"
#include "qp_set.h"
#include "recording.h"

namespace predictor::bench {

// Measurements of whole runs in virtual time.
struct RunTimes {
  std::array<double, kStages> p50{}, p99{};  // of ticks in RUN [µs], medians over the runs
  // The simulated time divided by the CPU time, and the simulated time divided by the wall-clock
  // time.
  double cpu_factor = 0, wall_factor = 0;
  double start_up = 0;  // from the scenario file to the end of the first tick [s]
};
RunTimes TimeRuns(const std::string& scenario, int runs);

// Returns the scenario box_9kg with the box on twenty posts that all touch it. The hands grip and
// hold.
Scenario ContactScene();
inline constexpr const char* kContactStep = "mj_step with 20 contact pairs";
// Prints the time of this scene's ticks and compares it with the bare steps of the engine [µs].
void TimeContact(double contact_step, double mj_step, int runs);

// Prints the time per tick of the drivers, monitor and guard of real arms. If `quick` is true, the
// measurement uses fewer ticks and no sockets.
void TimeDriversAndSupervisor(bool quick);

// Prints the time of the evaluation of the person. If `quick` is true, the measurement uses fewer
// samples.
void TimePerson(bool quick);

// Runs isolated benchmarks of the parts of the stages with google-benchmark. Returns a map from the
// name to the median time [µs].
std::map<std::string, double> TimeParts(const Recording& recording, int* argc, char** argv);

// Measures the costs of recording for runs of these scenarios.
void CompareRecordings(const std::vector<std::string>& names);

// Compares solvers on the same problems.
void CompareSolvers(const std::vector<ProblemSet>& sets, int repetitions);

}  // namespace predictor::bench
