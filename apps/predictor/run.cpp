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
#include "scenario/catalogue.h"
#include "scenario/scenario_io.h"
#include "viewer/admission.h"
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
        if (record.tick % 64 == 0 && !is_held_)
          progress_.Update(record.run_time, Name(record.state));
        TellWhenHeld(record);
      }
      if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  void TellWhenHeld(const TickRecord& record) {
    const bool held = record.state == RunState::kHeld || record.state == RunState::kUnpowered;
    if (held && !is_held_ && !held_.empty()) {
      progress_.Finish();
      if (record.cause == StopCause::kNone)
        std::fprintf(stderr, "Done. %s\n", held_.c_str());
      else
        std::fprintf(stderr, "%s after the stop '%s'. %s\n", Name(record.state), Name(record.cause),
                     held_.c_str());
    }
    is_held_ = held;
  }

  RingReader<TickRecord, kRecordRing> reader_;
  std::string held_;
  bool is_held_ = false;
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

// One scenario's run, from its first tick to its table.
class Run {
 public:
  Run(const Scenario& scenario, const ScenarioOptions& options, const ServeOptions& serve)
      : scenario_(scenario), options_(options), serve_(serve), emulator_(scenario) {
    PrintSetup(emulator_, options.quiet);
    if (serve.ros_tcp) {  // before there are threads
      const EmulatorSetup& setup = emulator_.setup();
      ros_.emplace(serve.ros, RosTopics(scenario, setup.cobot_joints, setup.object_start), board_,
                   mailbox_);
      std::fprintf(stderr, "ROS-TCP   port %u, %s\n", ros_->port(), Name(serve.ros.dialect));
    }
    if (!serve.viewer) return;
    ViewerOptions page = serve.page;
    page.object_start = emulator_.setup().object_start;
    viewer_.emplace(scenario, page, board_, mailbox_,
                    [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); });
  }

  // Returns an exit code. `next`: the scenario that somebody chose instead, by its place.
  int Go(bool by_itself, std::optional<std::size_t>* next) {
    std::optional<Console> console;
    if (viewer_ && isatty(STDIN_FILENO) == 1) console.emplace(&*viewer_);
    RealTimeOptions loop;
    loop.duration = scenario_.duration;
    loop.stay = serve_.stay;
    loop.mailbox = &*mailbox_;
    loop.by_itself = by_itself;
    loop.watch_headsets = !emulator_.setup().simulated;
    Follower follower(board_->records, scenario_, options_.quiet,
                      loop.stay ? "Press Ctrl-C to end." : "");
    RealTimeReport report;
    const auto start = std::chrono::steady_clock::now();
    const RunEnd end = RunRealTime(&emulator_, loop, quit, &board_->records, &report);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    Summary& summary = follower.Finish().summary();
    *next = report.scenario;
    if (end == RunEnd::kNotStarted && (quit || report.scenario) && summary.ticks == 0) {
      if (quit) std::fprintf(stderr, "Ended on request, before the run began.\n");
      return kFinished;
    }
    summary.overruns = report.overruns;
    const RunEnd how = report.scenario && !summary.stop ? RunEnd::kFinished : end;
    const int code = Report(emulator_, how, wall.count(), options_, &summary);
    if (!options_.quiet) PrintLoop(report);
    return code;
  }

  std::uint16_t ros_port() const { return ros_ ? ros_->port() : 0; }
  std::uint16_t page_port() const { return viewer_ ? viewer_->port() : 0; }

 private:
  const Scenario& scenario_;
  const ScenarioOptions& options_;
  const ServeOptions& serve_;
  Emulator emulator_;
  Shared<RunBoard> board_;
  Shared<RunMailbox> mailbox_;
  std::optional<RosTcpProcess> ros_;
  std::optional<ViewerProcess> viewer_;
};

}  // namespace

int RunCommand(const ScenarioOptions& options, ServeOptions serve) {
  // Whatever asks the program to end brings the arms to rest first; a closed pipe ends nothing.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, OnSignal);
  std::signal(SIGPIPE, SIG_IGN);
  Scenario scenario = options.Load();
  const std::filesystem::path folder = std::filesystem::absolute(scenario.file).parent_path();
  serve.stay |= isatty(STDIN_FILENO) == 1;
  serve.page.secret = NewAdmissionSecret();
  if (serve.viewer) serve.page.scenarios = ScenariosIn(folder);
  std::optional<Run> run(std::in_place, scenario, options, serve);
  for (bool by_itself = true;; by_itself = false) {
    std::optional<std::size_t> next;
    const int code = run->Go(by_itself, &next);
    if (!next || *next >= serve.page.scenarios.size()) return code;
    // Pages that are in stay in: the same ports, the same secret.
    serve.page.port = run->page_port();
    serve.ros.port = run->ros_port();
    run.reset();
    const std::string name = serve.page.scenarios[*next].name;
    const Scenario before = scenario;
    serve.page.notice.clear();
    try {
      scenario = LoadScenario(folder / (name + ".yaml"), {});
      run.emplace(scenario, options, serve);
    } catch (const InputError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      serve.page.notice = "The scenario " + name + " cannot be run: " + error.what();
      scenario = before;
      run.emplace(scenario, options, serve);
    }
  }
}

}  // namespace predictor
