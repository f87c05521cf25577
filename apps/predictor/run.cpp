#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>

#include "commands.h"
#include "core/error.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "progress.h"
#include "report.h"

namespace predictor {
namespace {

std::atomic<bool> quit{false};

void OnSignal(int) { quit.store(true); }

// Follows the records as any reader does: it may be slow, and counts what it lost.
class Follower {
 public:
  Follower(const RecordRing& ring, const Scenario& scenario, bool quiet)
      : reader_(ring),
        builder_(scenario.name, scenario.seed, scenario.safety.force, scenario.safety.torque),
        progress_("Running", scenario.duration, quiet),
        thread_([this] { Follow(); }) {}

  SummaryBuilder& Finish() {
    done_.store(true);
    thread_.join();
    progress_.Finish();
    builder_.summary().records_dropped = reader_.lost();
    return builder_;
  }

 private:
  void Follow() {
    for (bool last = false; !last;) {
      last = done_.load();
      TickRecord record;
      while (reader_.Next(&record)) {
        builder_.Add(record);
        if (record.tick % 64 == 0) progress_.Update(record.run_time, Name(record.state));
      }
      if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  RingReader<TickRecord, kRecordRing> reader_;
  SummaryBuilder builder_;
  Progress progress_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

int RunScenario(const ScenarioOptions& options) {
  const Scenario scenario = options.Load();
  Emulator emulator(scenario);
  PrintSetup(emulator, options.quiet);
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
  auto ring = std::make_unique<RecordRing>();
  Follower follower(*ring, scenario, options.quiet);
  RealTimeReport report;
  const auto start = std::chrono::steady_clock::now();
  const RunEnd end = RunRealTime(&emulator, scenario.duration, quit, ring.get(), &report);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  Summary& summary = follower.Finish().summary();
  summary.overruns = report.overruns;
  const int code = Report(emulator, end, wall.count(), options, &summary);
  if (!options.quiet) {
    std::fprintf(
        stderr,
        "Loop: %llu ticks; woke %.0f / %.0f / %.0f / %.0f µs late (p50 / p99 / p99.9 / max); %llu "
        "ticks missed; %s.\n",
        static_cast<unsigned long long>(report.ticks), static_cast<double>(report.lateness_us[0]),
        static_cast<double>(report.lateness_us[1]), static_cast<double>(report.lateness_us[2]),
        static_cast<double>(report.lateness_us[3]),
        static_cast<unsigned long long>(report.overruns), report.scheduling.c_str());
  }
  if (end == RunEnd::kStopped && isatty(STDIN_FILENO) == 1 && !quit) {
    std::fprintf(stderr, "HELD after the stop '%s'. Press Ctrl-C to end.\n",
                 Name(emulator.record().cause));
    while (!quit) pause();
  }
  return code;
}

}  // namespace

void AddRun(CLI::App* app, Command* command) {
  CLI::App* run = app->add_subcommand("run", "Run a scenario in real time");
  auto options = std::make_shared<ScenarioOptions>();
  options->AddTo(run);
  run->callback([command, options] { *command = [options] { return RunScenario(*options); }; });
}

}  // namespace predictor
