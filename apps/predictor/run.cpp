#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "commands.h"
#include "core/error.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "progress.h"
#include "report.h"
#include "ros_tcp/ros_tcp_process.h"
#include "viewer/viewer_process.h"

namespace predictor {
namespace {

std::atomic<bool> quit{false};

void OnSignal(int) { quit.store(true); }

// Follows the records as any reader does: it may be slow, and counts what it lost.
class Follower {
 public:
  // held: a line to print when the arms have come to rest.
  Follower(const RecordRing& ring, const Scenario& scenario, bool quiet, std::string held)
      : reader_(ring),
        held_(std::move(held)),
        builder_(scenario),
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
        if (record.tick % 64 == 0 && held_time_ == 0)
          progress_.Update(record.run_time, Name(record.state));
        TellWhenHeld(record);
      }
      if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  void TellWhenHeld(const TickRecord& record) {
    const bool held = record.state == RunState::kHeld || record.state == RunState::kUnpowered;
    if (held && held_time_ == 0 && !held_.empty()) {
      progress_.Finish();
      if (record.cause == StopCause::kNone)
        std::fprintf(stderr, "Done. %s\n", held_.c_str());
      else
        std::fprintf(stderr, "%s after the stop '%s'. %s\n", Name(record.state), Name(record.cause),
                     held_.c_str());
    }
    held_time_ = held ? held_time_ + 1 : 0;
  }

  RingReader<TickRecord, kRecordRing> reader_;
  std::string held_;
  std::uint64_t held_time_ = 0;  // [ticks]
  SummaryBuilder builder_;
  Progress progress_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

void PrintLoop(const RealTimeReport& report) {
  std::fprintf(
      stderr,
      "Loop: %llu ticks; woke %.0f / %.0f / %.0f / %.0f µs late (p50 / p99 / p99.9 / max); %llu "
      "ticks missed; %s.\n",
      static_cast<unsigned long long>(report.ticks), static_cast<double>(report.lateness_us[0]),
      static_cast<double>(report.lateness_us[1]), static_cast<double>(report.lateness_us[2]),
      static_cast<double>(report.lateness_us[3]), static_cast<unsigned long long>(report.overruns),
      report.scheduling.c_str());
}

// What a person may type at the console while it runs.
class Console {
 public:
  explicit Console(ViewerProcess* viewer) : viewer_(viewer), thread_([this] { Listen(); }) {}
  ~Console() {
    done_.store(true);
    thread_.join();
  }

 private:
  void Listen() {
    std::string line;
    while (!done_) {
      pollfd ready{STDIN_FILENO, POLLIN, 0};
      if (poll(&ready, 1, 200) <= 0) continue;
      char byte = 0;
      if (read(STDIN_FILENO, &byte, 1) <= 0) return;
      if (byte != '\n') {
        if (line.size() < 80) line.push_back(byte);
        continue;
      }
      Obey(line);
      line.clear();
    }
  }
  void Obey(const std::string& line) {
    if (line == "pin look" || line == "pin operator" || line == "pin control")
      viewer_->AskPin(line.substr(4));
    else if (line == "revoke operator" || line == "revoke control")
      viewer_->Revoke(line.substr(7));
    else if (line == "foxglove")
      viewer_->AskFoxglove();
    else if (line == "status")
      viewer_->AskStatus();
    else if (!line.empty())
      std::fputs(
          "Known: pin look, pin operator, pin control, revoke operator, revoke control, "
          "foxglove, status; Ctrl-C ends.\n",
          stderr);
  }

  ViewerProcess* viewer_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace

int RunCommand(const ScenarioOptions& options, const ServeOptions& serve) {
  // Whatever asks the program to end brings the arms to rest first; a closed pipe ends nothing.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, OnSignal);
  std::signal(SIGPIPE, SIG_IGN);
  const Scenario scenario = options.Load();
  Emulator emulator(scenario);
  PrintSetup(emulator, options.quiet);
  Shared<RunBoard> board;
  Shared<RunMailbox> mailbox;
  const RosTopics topics(scenario, emulator.setup().cobot_joints, emulator.setup().object_start);
  std::optional<RosTcpProcess> ros;  // before there are threads
  if (serve.ros_tcp) {
    ros.emplace(serve.ros, topics, board, mailbox);
    std::fprintf(stderr, "ROS-TCP   port %u, %s\n", ros->port(), Name(serve.ros.dialect));
  }
  std::optional<ViewerProcess> viewer;
  std::optional<Console> console;
  const bool terminal = isatty(STDIN_FILENO) == 1;
  if (serve.viewer) {
    ViewerOptions page = serve.page;
    page.object_start = emulator.setup().object_start;
    viewer.emplace(scenario, page, board, mailbox,
                   [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); });
    if (terminal) console.emplace(&*viewer);
  }
  const RealTimeOptions loop{scenario.duration, terminal, &*mailbox, !emulator.setup().simulated};
  Follower follower(board->records, scenario, options.quiet,
                    loop.stay ? "Press Ctrl-C to end." : "");
  RealTimeReport report;
  const auto start = std::chrono::steady_clock::now();
  const RunEnd end = RunRealTime(&emulator, loop, quit, &board->records, &report);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  Summary& summary = follower.Finish().summary();
  if (end == RunEnd::kNotStarted && quit) {
    std::fprintf(stderr, "Ended on request, before the run began.\n");
    return kFinished;
  }
  summary.overruns = report.overruns;
  const int code = Report(emulator, end, wall.count(), options, &summary);
  if (!options.quiet) PrintLoop(report);
  return code;
}

}  // namespace predictor
