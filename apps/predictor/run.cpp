#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "commands.h"
#include "commissioning/arm_checks.h"
#include "console_commands.h"
#include "core/contained_thread.h"
#include "core/error.h"
#include "core/text.h"
#include "devices/connect.h"
#include "devices/real_device.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "follower.h"
#include "live_evaluation.h"
#include "patient_output.h"
#include "plugin_watch.h"
#include "quit.h"
#include "raw_keys.h"
#include "real_arms.h"
#include "recorded_run.h"
#include "report.h"
#include "results.h"
#include "rig_console.h"
#include "ros_tcp/ros_tcp_process.h"
#include "scenario/catalogue.h"
#include "scenario/formulation.h"
#include "scenario/located.h"
#include "scenario/machine.h"
#include "screen.h"
#include "viewer/admission.h"
#include "viewer/viewer_process.h"
#include "watchdog/watchdog_process.h"

namespace predictor {
namespace {

void PrintLoop(const RealTimeReport& report) {
  std::fprintf(
      stderr,
      "Loop: %llu ticks, %llu missed; wake-up delay %.0f / %.0f / %.0f / %.0f µs (p50 / p99 / "
      "p99.9 / max)\n"
      "Real-time scheduling: %s.\n",
      static_cast<unsigned long long>(report.ticks),
      static_cast<unsigned long long>(report.overruns), static_cast<double>(report.lateness_us[0]),
      static_cast<double>(report.lateness_us[1]), static_cast<double>(report.lateness_us[2]),
      static_cast<double>(report.lateness_us[3]), report.scheduling.c_str());
}

// Reads commands from standard input during runs without real arms. A process in the background
// receives no commands.
class Console {
 public:
  explicit Console(ConsoleCommands* commands) : commands_(commands) {
    // tcgetpgrp returns −1 if standard input is not this process's controlling terminal.
    const pid_t in_front = tcgetpgrp(STDIN_FILENO);
    if (in_front != -1 && in_front != getpgrp()) return;
    keys_.emplace(false);
    thread_ = ContainedThread(
        "console", [this] { Listen(); },
        [](const char* why) {
          TheScreen().Print(std::string("The console no longer accepts commands (") + why +
                            "). Ctrl-C ends the run.");
        });
  }
  ~Console() {
    done_.store(true);
    if (thread_.joinable()) thread_.join();
  }

 private:
  void Listen() {
    TypedLine line;
    while (!done_) {
      pollfd ready{STDIN_FILENO, POLLIN, 0};
      if (poll(&ready, 1, 200) <= 0) continue;
      char key = 0;
      if (read(STDIN_FILENO, &key, 1) <= 0) return;
      if (!line.Type(key) && key == '\n' && !line.empty()) commands_->Obey(line.Take());
      if (line.empty()) TheScreen().Typed("");
    }
  }

  ConsoleCommands* commands_;
  std::optional<RawKeys> keys_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

// Returns the sentence about the end of the run for the pages.
std::string HowItEnded(RunEnd end, const Summary& summary) {
  if (quit) return "The run was ended from the console.";
  if (summary.stop_count > 0) return "The run was stopped before its planned end.";
  return end == RunEnd::kFinished ? "The run ended as planned." : "The run did not start.";
}

// The scenario that a page chose to run next.
struct NextRun {
  std::size_t scenario;  // index in the list
  bool by_itself;        // chosen after a run, so it starts without another button
};

// The run of one scenario, from the first tick to the table of results.
class Run {
 public:
  // `device` and `machine` are the real arms, or null.
  Run(const Scenario& scenario, const ScenarioOptions& options, const ServeOptions& serve,
      const RecordOptions& record, std::unique_ptr<RealDevice> device = nullptr,
      const Machine* machine = nullptr)
      : scenario_(scenario),
        options_(options),
        serve_(serve),
        device_(device.get()),
        emulator_(scenario, std::move(device)) {
    PrintSetup(emulator_, options.quiet);
    const auto show = [](const std::string& text) { TheScreen().Print(text); };
    if (!serve.streams.streams.empty()) streams_.emplace(serve.streams, show);
    const PersonStreams* streams = streams_ ? &*streams_ : nullptr;
    evaluation_.emplace(serve.evaluation, scenario, board_, &mailbox_, streams, show);
    if (!record.off) {
      options.MakeRoom(record.file);
      recording_.emplace(emulator_, record, &*board_, evaluation_->board(), mailbox_->heads,
                         streams);
    }
    if (machine) {
      watchdog_.emplace(*machine, std::array{scenario.Has(0), scenario.Has(1)}, board_, show);
      TheScreen().Print("Watchdog  " + watchdog_->Describe());
      enabling_device_ = machine->enabling.has_value();
    }
    const EmulatorSetup& setup = emulator_.setup();
    if (serve.ros_tcp) {
      ros_.emplace(serve.ros, scenario, setup.cobot_joints, setup.object_start, board_, stops_,
                   show);
      std::fprintf(stderr, "ROS-TCP   port %u, %s, %s\n", ros_->port(), Name(serve.ros.dialect),
                   serve.ros.allow.empty()
                       ? "this machine only"
                       : ("also for " + Join(serve.ros.allow, ", ") +
                          ": not encrypted, no access code; every client can stop the run")
                             .c_str());
    }
    if (!serve.viewer) return;
    viewer::ViewerOptions page = serve.page;
    page.object_start = setup.object_start;
    page.why_not_judged = evaluation_->why_not();
    viewer_.emplace(scenario, page, board_, mailbox_, show, evaluation_->states());
  }

  // Returns an exit code. `next` is the scenario that a page chose to run after the present
  // scenario.
  int Go(bool by_itself, std::optional<NextRun>* next) {
    ConsoleCommands commands(viewer_ ? &*viewer_ : nullptr, recording_ ? &*recording_ : nullptr);
    std::optional<Console> console;
    std::optional<RigConsole> rig;
    RealTimeOptions loop;
    if (device_) {
      rig.emplace([this](RunEvent event) { emulator_.Request(event); },
                  [&commands](const std::string& line) { commands.Obey(line); }, enabling_device_);
      if (!enabling_device_) loop.enabling = &rig->enabling();
      std::fprintf(stderr, "%s\n", rig->Help());
    } else if (isatty(STDIN_FILENO) == 1) {
      console.emplace(&commands);
    }
    loop.duration = scenario_.duration;
    loop.keep_running = serve_.stay.value_or(false);
    loop.mailbox = &*mailbox_;
    loop.stops = &*stops_;
    loop.auto_start = by_itself;
    loop.watch_headsets = emulator_.setup().rules.watches_headsets;
    loop.snapshots = recording_ ? &*recording_ : nullptr;
    if (watchdog_) loop.watchdog = &watchdog_->beats();
    loop.allow_scenario_switch = emulator_.setup().rules.may_switch_scenario && viewer_;
    Follower follower(board_->records, scenario_,
                      {.quiet = options_.quiet,
                       .held = loop.keep_running && !device_ ? "Press Ctrl-C to end." : "",
                       .recording = recording_ ? &*recording_ : nullptr,
                       .device = device_,
                       .enabling_device = enabling_device_},
                      &quit);
    RealTimeReport report;
    const auto start = std::chrono::steady_clock::now();
    const RunEnd end = RunRealTime(&emulator_, loop, quit, &board_->records, &report);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    Summary summary = follower.Finish();
    if (report.scenario) *next = NextRun{*report.scenario, emulator_.state() != RunState::kIdle};
    const bool results = !report.scenario && end != RunEnd::kNotStarted && MayShowResults();
    const std::string how = HowItEnded(end, summary);
    if (viewer_ && !report.scenario) viewer_->EndRun(how, results);
    if (end == RunEnd::kNotStarted && (quit || report.scenario) && summary.ticks() == 0 &&
        summary.stop_count == 0) {
      if (follower.failed()) return kDeviceFailure;
      if (quit) std::fprintf(stderr, "The program was ended on request before the run began.\n");
      return kFinished;
    }
    summary.overruns = report.overruns;
    summary.by_the_clock = true;
    const bool recorded = !recording_ || recording_->Close(options_.quiet, results);
    const RunEnd ended = report.scenario && summary.stop_count == 0 ? RunEnd::kFinished : end;
    const int code = Report(emulator_, ended, wall.count(), options_, &summary);
    if (!options_.quiet) PrintLoop(report);
    if (results) {
      console.reset();  // it sends requests to the viewer, which is about to be replaced
      *next = ShowResults(summary, follower.curves(), how);
    }
    return code == kFinished && (!recorded || follower.failed()) ? kDeviceFailure : code;
  }

  // Copies the ports and the list of removed clients into the options of the program's next run.
  void HandOn(ServeOptions* next) const {
    if (ros_) next->ros.port = ros_->port();
    if (!viewer_) return;
    next->page.port = viewer_->port();
    next->page.generations = viewer_->generations();
  }

 private:
  // Returns whether results may be shown. Results may be shown only with simulated arms, and only
  // if a page is connected or the program should stay.
  bool MayShowResults() {
    return viewer_ && emulator_.setup().rules.may_switch_scenario && !quit &&
           serve_.stay.value_or(mailbox_->clients.load(std::memory_order_relaxed) > 0);
  }

  // Starts a new viewer with the results and the report, which replaces the run's viewer. A new
  // viewer is needed because a viewer can read files only before the viewer begins to serve pages.
  // Returns the scenario that a page chose.
  std::optional<NextRun> ShowResults(const Summary& summary, const ResultCurves& curves,
                                     const std::string& how) {
    std::string remark;
    const std::string recording = recording_ ? recording_->file() : "";
    ServeOptions serve = serve_;
    serve.page.report = WriteRunReport(recording, summary.duration(), options_.force, &remark);
    if (recording_ && !remark.empty() && !options_.quiet) TheScreen().Print(remark);
    serve.page.results = ResultsJson(summary, curves, how, recording, remark).dump();
    serve.page.object_start = emulator_.setup().object_start;
    serve.page.notice.clear();
    serve.page.why_not_judged = evaluation_->why_not();
    HandOn(&serve);
    viewer_.reset();
    for (RunInput stale; mailbox_->inputs.Pop(&stale);) {
    }
    viewer_.emplace(
        scenario_, serve.page, board_, mailbox_,
        [](const std::string& text) { TheScreen().Print(text); }, evaluation_->states());
    ConsoleCommands commands(&*viewer_, nullptr);
    std::optional<Console> console;
    if (isatty(STDIN_FILENO) == 1) console.emplace(&commands);
    return WaitForChoice();
  }

  // Waits until a page chooses a scenario or the user ends the program. Unless the program should
  // stay, the function also returns when no page is connected.
  std::optional<NextRun> WaitForChoice() {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::seconds kPatience{10};  // a page may be reconnecting
    Clock::time_point seen = Clock::now();
    for (RunInput input; !quit; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
      while (mailbox_->inputs.Pop(&input))
        if (input.kind == InputKind::kScenario && input.value >= 0 &&
            input.value < static_cast<double>(serve_.page.scenarios.size()))
          return NextRun{static_cast<std::size_t>(input.value), true};
      if (mailbox_->clients.load(std::memory_order_relaxed) > 0) seen = Clock::now();
      if (!serve_.stay.value_or(false) && Clock::now() - seen > kPatience) break;
    }
    viewer_->EndRun("The program was ended.");
    return {};
  }

  const Scenario& scenario_;
  const ScenarioOptions& options_;
  const ServeOptions& serve_;
  const RealDevice* device_;  // the emulator's device if its arms are real
  bool enabling_device_ = false;
  Emulator emulator_;
  Shared<RunBoard> board_;
  Shared<RunMailbox> mailbox_;  // messages from pages
  Shared<StopMailbox> stops_;   // messages from ROS-TCP clients
  std::optional<PersonStreams> streams_;
  std::optional<LiveEvaluation> evaluation_;
  std::optional<RunRecording> recording_;
  std::optional<watchdog::WatchdogProcess> watchdog_;
  std::optional<ros_tcp::RosTcpProcess> ros_;
  std::optional<viewer::ViewerProcess> viewer_;
};

// Returns the name of a run's JSON file: "out.json" for the first run, "out-2.json" for the second
// run, and so on. Standard output gets the results of all runs.
std::string SummaryOf(const std::string& file, int run) {
  if (file.empty() || file == "-" || run == 1) return file;
  const std::filesystem::path path(file);
  std::filesystem::path name = path.stem();
  name += "-" + std::to_string(run);
  name += path.extension();
  return (path.parent_path() / name).string();
}

// Returns the options for a scenario that a page chose. Values for the first scenario's keys are
// omitted, because the other scenario may not have these keys.
ScenarioOptions OptionsFor(const std::filesystem::path& file, const ScenarioOptions& first,
                           int run) {
  ScenarioOptions options = first;
  options.file = file.string();
  options.json = SummaryOf(first.json, run);
  const bool same = std::filesystem::absolute(first.file) == file;
  if (!same) options.set.clear();
  if (!same && !first.set.empty())
    TheScreen().Print(options.file + " runs without --set " + Join(first.set, " --set ") +
                      ", which applies only to " + first.file + ".");
  if (options.json != first.json)
    TheScreen().Print("Its summary is written to " + options.json + ".");
  return options;
}

// Loads the scenario for a run in real time. The detectors of oscillation and vibration stay
// switched on, because a person may hold the handles. All repairs of the paper's formulation also
// stay switched on.
Scenario LoadForRealTime(const ScenarioOptions& options) {
  Scenario scenario = options.Load();
  if (!scenario.safety.oscillation.enabled)
    throw Located(InputError::At("safety.oscillation.enabled",
                                 "safety.oscillation.enabled is false, which is allowed in virtual "
                                 "time only. Remove this line, or use `predictor simulate`."),
                  scenario);
  if (!RepairsOf(scenario.rendering).HasAll())
    throw Located(InputError::At("rendering.formulation",
                                 "rendering.formulation lacks repairs, which is allowed in virtual "
                                 "time only. Remove this line, or use `predictor simulate`."),
                  scenario);
  if (scenario.simulation.engine != EngineKind::kMujoco)
    throw Located(InputError::At(
                      "simulation.engine",
                      "simulation.engine is dart, which runs in virtual time only. "
                      "DART's steps allocate memory and wait for another process, so a step "
                      "may be late. Set simulation.engine to mujoco, or use `predictor simulate`."),
                  scenario);
  return scenario;
}

// Prints the known settings of the arms. Throws DeviceError if these settings contradict the
// machine file.
void CheckArms(const Machine& machine, const ArmModels& models, const RealDevice& device) {
  for (int hand = 0; hand < kHands; ++hand) {
    const DeviceFacts* facts = device.arm_facts(hand);
    if (facts == nullptr) continue;
    for (const std::string& remark : facts->remarks) TheScreen().Print(facts->name + ": " + remark);
    const MachineArm& side = *machine.arm(hand);
    const RobotModel& model = *models[static_cast<std::size_t>(hand)];
    for (const std::string& refusal : {commissioning::KinematicsRefusal(*facts, side.arm, model),
                                       commissioning::PayloadRefusal(*facts, side)})
      if (!refusal.empty()) throw DeviceError(facts->name + ": " + refusal);
  }
}

// Runs one scenario with real arms and a person at the console. Pages cannot choose scenarios.
// The program reads every file that came from elsewhere before it connects to the arms
// (decisions.md); tests in tests/machine/foreign_file_test.cpp rely on this order.
int RunOnMachine(const ScenarioOptions& options, ServeOptions serve, RecordOptions record) {
  if (isatty(STDIN_FILENO) != 1)
    throw InputError(
        "Real arms need an operator at the console, but standard input is not a terminal. Start "
        "the program from a terminal.");
  const Machine machine = LoadMachine(options.machine);
  Scenario scenario = options.Load(&machine);
  const ArmModels models = LoadArmModels(machine);
  RequirePushTests(machine, scenario);
  RequireRealTime(machine);
  for (const std::string& line : UnmeasuredLoops(machine, scenario)) TheScreen().Print(line);
  RequireStability(machine, scenario);
  ConfirmPerturbation(scenario);
  std::fputs(
      "Connecting to the arms. We have never run these drivers on hardware, so keep the emergency "
      "stop within reach. Keep your hands off the handles until IDLE, because the sensors are "
      "being tared.\n",
      stderr);
  std::unique_ptr<RealDevice> device = ConnectMachine(machine, &scenario, SocketNetwork());
  CheckArms(machine, models, *device);
  record.machine = SaveMachine(machine);
  serve.stay = true;
  serve.page.secret = viewer::NewAdmissionSecret();
  Run run(scenario, options, serve, record, std::move(device), &machine);
  std::optional<NextRun> none;
  return run.Go(false, &none);
}

}  // namespace

int RunCommand(const ScenarioOptions& first, ServeOptions serve, RecordOptions record) {
  // Every signal that ends the program brings the arms to rest first. When a pipe that the program
  // writes to is closed, the program continues.
  QuitOn({SIGINT, SIGTERM, SIGHUP, SIGQUIT});
  BoundOutput();
  ExpectPromptPlugins();
  ScenarioOptions options = first;
  if (!first.machine.empty()) return RunOnMachine(first, serve, record);
  Scenario scenario = LoadForRealTime(options);
  const std::filesystem::path folder = std::filesystem::absolute(scenario.file).parent_path();
  if (isatty(STDIN_FILENO) == 1 && !serve.stay) serve.stay = true;
  serve.page.secret = viewer::NewAdmissionSecret();
  if (serve.viewer) serve.page.scenarios = ScenariosIn(folder);
  std::optional<Run> run(std::in_place, scenario, options, serve, record);
  bool by_itself = true;
  for (int count = 1;; ++count) {
    std::optional<NextRun> next;
    const int code = run->Go(by_itself, &next);
    if (!next || next->scenario >= serve.page.scenarios.size()) return code;
    by_itself = next->by_itself;
    // Admitted pages stay admitted: the next run uses the same ports and the same secret.
    run->HandOn(&serve);
    run.reset();
    record.file.clear();  // the named file belongs to the first run
    const std::string name = serve.page.scenarios[next->scenario].name;
    const Scenario before = scenario;
    const ScenarioOptions options_before = options;
    serve.page.notice.clear();
    try {
      options = OptionsFor(folder / (name + ".yaml"), first, count + 1);
      scenario = LoadForRealTime(options);
      run.emplace(scenario, options, serve, record);
    } catch (const InputError& error) {
      TheScreen().Print(error.what());
      serve.page.notice = "The scenario " + name + " cannot be run: " + error.what();
      scenario = before;
      options = options_before;
      options.json = SummaryOf(first.json, count + 1);
      run.emplace(scenario, options, serve, record);
    }
  }
}

}  // namespace predictor
