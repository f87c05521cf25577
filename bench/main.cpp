// Measures the computing time of the parts of a tick, compares this time with the bare physics
// engine, and compares QP solvers on the same problems. The options are --quick (fewer
// repetitions), --tick (only the median tick) and those of google-benchmark.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include "samples.h"
#include "sections.h"

namespace predictor::bench {
namespace {

void PrintParts(const std::map<std::string, double>& parts) {
  const double engine = parts.count("mj_step") ? parts.at("mj_step") : NAN;
  Heading("Isolated parts, box_9kg (medians, time of one core)");
  std::printf("%-42s %8s %10s\n", "part", "us", "/ mj_step");
  for (const auto& [name, us] : parts)
    std::printf("%-42s %8.2f %10.2f\n", name.c_str(), us, us / engine);
}

void PrintRuns(const RunTimes& t, double mj_step) {
  const double tick = t.p50[static_cast<std::size_t>(Stage::kTick)];
  Heading("Whole runs of box_9kg in virtual time (medians over the runs)");
  std::printf("%-12s %8s %8s %8s %10s\n", "stage", "p50 us", "p99 us", "share", "/ mj_step");
  for (std::size_t k = 0; k < kStages; ++k)
    std::printf("%-12s %8.2f %8.2f %7.0f%% %10.2f\n", kStageNames[k], t.p50[k], t.p99[k],
                100 * t.p50[k] / tick, t.p50[k] / mj_step);
  const auto verdict = [](bool good) { return good ? "met" : "MISSED"; };
  std::printf("\ntick, median            %7.2f us   aim 15: %s, required 25: %s\n", tick,
              verdict(tick <= 15), verdict(tick <= 25));
  std::printf(
      "real-time factor        %7.1f      of one core's time; required 40: %s (wall clock "
      "%.1f)\n",
      t.cpu_factor, verdict(t.cpu_factor >= 40), t.wall_factor);
  std::printf("start-up to first tick  %7.3f s    required 1: %s\n", t.start_up,
              verdict(t.start_up < 1));
}

// Removes an option from the arguments, and returns whether the arguments contained this option.
bool Take(const std::string& option, int* argc, char** argv) {
  char** end = std::remove(argv + 1, argv + *argc, option);
  const bool found = end != argv + *argc;
  *argc = static_cast<int>(end - argv);
  return found;
}

int Main(int argc, char** argv) {
  if (Take("--tick", &argc, argv)) {
    std::printf("%.2f\n", TimeRuns("box_9kg", 1).p50[static_cast<std::size_t>(Stage::kTick)]);
    return 0;
  }
  const bool quick = Take("--quick", &argc, argv);
  const Recording box = Record("box_9kg");
  const std::map<std::string, double> parts = TimeParts(box, &argc, argv);
  const RunTimes runs = TimeRuns("box_9kg", quick ? 1 : 5);
  TimeDriversAndSupervisor(quick);
  TimePerson(quick);
  CompareRecordings(quick ? std::vector<std::string>{"box_9kg"}
                          : std::vector<std::string>{"box_9kg", "bar_circle", "dual_ur5"});
  std::vector<ProblemSet> sets;
  sets.push_back(FromRecording(box, "box_9kg", quick ? 100 : 30));
  sets.push_back(FromRecording(Record("bar_circle"), "bar_circle", quick ? 100 : 30));
  sets.push_back(AtTheLimits(box, quick ? 300 : 1000));
  CompareSolvers(sets, quick ? 3 : 7);
  PrintParts(parts);
  if (parts.count("mj_step")) PrintRuns(runs, parts.at("mj_step"));
  if (parts.count("mj_step") && parts.count(kContactStep))
    TimeContact(parts.at(kContactStep), parts.at("mj_step"), quick ? 1 : 5);
  return 0;
}

}  // namespace
}  // namespace predictor::bench

int main(int argc, char** argv) {
  try {
    return predictor::bench::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench: %s\n", error.what());
    return 2;
  }
}
