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
#include "commissioning/kinematics_check.h"
#include "commissioning/payload_check.h"
#include "core/error.h"
#include "core/loaded_hands.h"
#include "core/text.h"
#include "core/words.h"
#include "devices/connect.h"
#include "devices/real_device.h"
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "models/arm_model.h"
#include "progress.h"
#include "raw_keys.h"
#include "real_arms.h"
#include "report.h"
#include "rig_console.h"
#include "ros_tcp/ros_tcp_process.h"
#include "run_recording.h"
#include "safety/console_words.h"
#include "scenario/catalogue.h"
#include "scenario/machine.h"
#include "screen.h"
#include "viewer/admission.h"
#include "viewer/scene_description.h"
#include "viewer/viewer_process.h"
#include "watchdog/watchdog_process.h"

namespace predictor {
namespace {

std::atomic<bool> quit{false};

void OnSignal(int) { quit.store(true); }

// Follows the records as any reader does: it may be slow, and counts what it lost.
class Follower {
 public:
  // held: a line to print when the arms have come to rest, or none. recording, device: or none;
  // with real arms the person at the console, who holds a key or an enabling device, is told each
  // step.
  Follower(const RecordRing& ring, const Scenario& scenario, bool quiet, std::string held,
           RunRecording* recording, const RealDevice* device, bool enabling_device)
      : reader_(ring),
        recording_(recording),
        device_(device),
        words_(enabling_device, scenario.rate),
        scenario_(scenario),
        held_(std::move(held)),
        loaded_(kFreeForce, scenario.rate, enabling_device),
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
      if (recording_) recording_->Look();
      TickRecord record;
      while (reader_.Next(&record)) {
        builder_.Add(record);
        MarkWhatPagesMark(record);
        if (record.tick % 64 == 0 && !is_held_)
          progress_.Update(record.run_time, Name(record.state));
        TellWhenHeld(record);
        if (device_) TellThePersonBeside(record);
      }
      if (!last) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  void MarkWhatPagesMark(const TickRecord& record) {
    for (std::size_t i = 0; recording_ && i < record.input_count; ++i)
      if (record.inputs[i].kind == InputKind::kMarker)
        recording_->Mark("marker of page " + std::to_string(record.inputs[i].client));
  }

  void TellWhenHeld(const TickRecord& record) {
    const bool held = record.state == RunState::kHeld || record.state == RunState::kUnpowered;
    if (is_held_ && !held)
      if (const std::string kept = KeptThresholds(scenario_, record); !kept.empty())
        TheScreen().Tell(kept);
    if (held && !is_held_) progress_.Finish();
    if (held && !is_held_ && !held_.empty())
      TheScreen().Tell(record.cause == StopCause::kNone
                           ? "Done. " + held_
                           : std::string(Name(record.state)) + " after the stop '" +
                                 Name(record.cause) + "'. " + StopCauseWords(record) + " " + held_);
    is_held_ = held;
  }

  void TellThePersonBeside(const TickRecord& record) {
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      for (const std::string& words : NewWarnings(warnings_[hand], record.hands[hand], hand))
        TheScreen().Tell(words);
      warnings_[hand] = record.hands[hand].warnings;
    }
    for (const std::string& words : words_.See(record, [this] { return device_->Trouble(); }))
      TheScreen().Tell(words);
    for (const std::string& words : loaded_.See(record)) TheScreen().Tell(words);
  }

  RingReader<TickRecord, kRecordRing> reader_;
  RunRecording* recording_;
  const RealDevice* device_;
  std::array<std::uint8_t, kHands> warnings_ = {};  // as told
  ConsoleWords words_;
  const Scenario& scenario_;
  std::string held_;
  LoadedHands loaded_;
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
class Commands {
 public:
  // Either may be null.
  Commands(ViewerProcess* viewer, RunRecording* recording)
      : viewer_(viewer), recording_(recording) {}

  void Obey(const std::string& line) {
    if (line == "mark" || line.starts_with("mark ")) return Mark(line.substr(4));
    if (!viewer_) {
      if (!line.empty()) TheScreen().Tell("Known without a page: mark [TEXT]; Ctrl-C ends.");
      return;
    }
    if (line == "pin look" || line == "pin operator" || line == "pin control")
      viewer_->AskPin(line.substr(4));
    else if (line == "revoke operator" || line == "revoke control")
      viewer_->Revoke(line.substr(7));
    else if (const unsigned long client = ClientOf(line); client != 0)
      viewer_->Kick(static_cast<std::uint32_t>(client));
    else if (line == "kick foxglove")
      viewer_->KickFoxglove();
    else if (line == "foxglove")
      viewer_->AskFoxglove();
    else if (line == "status")
      viewer_->AskStatus();
    else if (!line.empty())
      TheScreen().Tell(
          "Known: pin look, pin operator, pin control, revoke operator, revoke control, "
          "kick N (a client's number), kick foxglove, mark [TEXT], foxglove, status; Ctrl-C "
          "ends.");
  }

 private:
  void Mark(const std::string& text) {
    if (recording_)
      recording_->Mark("marker:" + (text.empty() ? " console" : text));
    else
      TheScreen().Tell("This run is not recorded.");
  }
  // N of "kick N"; 0 if it is something else.
  static unsigned long ClientOf(const std::string& line) {
    const std::string kick = "kick ";
    if (!line.starts_with(kick) || line.size() == kick.size() || line.size() > kick.size() + 9 ||
        line.find_first_not_of("0123456789", kick.size()) != std::string::npos)
      return 0;
    return std::stoul(line.substr(kick.size()));
  }

  ViewerProcess* viewer_;
  RunRecording* recording_;
};

// Lines of standard input, where no real arm moves. In the background nobody types any.
class Console {
 public:
  explicit Console(Commands* commands) : commands_(commands) {
    const pid_t in_front = tcgetpgrp(STDIN_FILENO);  // −1: it is not the terminal that we belong to
    if (in_front != -1 && in_front != getpgrp()) return;
    keys_.emplace(false);
    thread_ = std::thread([this] { Listen(); });
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

  Commands* commands_;
  std::optional<RawKeys> keys_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

// For the pages.
std::string HowItEnded(RunEnd end, const Summary& summary) {
  if (quit) return "The run was ended at its console.";
  if (summary.stop_count > 0) return "The run was stopped, and has ended.";
  return end == RunEnd::kFinished ? "The run is finished." : "The run has ended.";
}

// One scenario's run, from its first tick to its table.
class Run {
 public:
  // device, machine: the real arms, or null.
  Run(const Scenario& scenario, const ScenarioOptions& options, const ServeOptions& serve,
      const RecordOptions& record, std::unique_ptr<RealDevice> device = nullptr,
      const Machine* machine = nullptr)
      : scenario_(scenario),
        options_(options),
        serve_(serve),
        device_(device.get()),
        emulator_(scenario, std::move(device)) {
    PrintSetup(emulator_, options.quiet);
    if (!record.off) recording_.emplace(emulator_, record, &*board_);
    const auto tell = [](const std::string& text) { TheScreen().Tell(text); };
    if (machine) {
      watchdog_.emplace(*machine, std::array{scenario.Has(0), scenario.Has(1)}, board_, tell);
      std::fprintf(stderr, "Watchdog  %s\n", watchdog_->Describe().c_str());
      enabling_device_ = machine->enabling.has_value();
    }
    const EmulatorSetup& setup = emulator_.setup();
    if (serve.ros_tcp) {
      ros_.emplace(serve.ros, scenario, setup.cobot_joints, setup.object_start, board_, stops_,
                   tell);
      std::fprintf(stderr, "ROS-TCP   port %u, %s, %s\n", ros_->port(), Name(serve.ros.dialect),
                   serve.ros.allow.empty()
                       ? "this machine only"
                       : ("also for " + Join(serve.ros.allow, ", ") +
                          ": not encrypted, no code, and whoever connects may stop")
                             .c_str());
    }
    if (!serve.viewer) return;
    ViewerOptions page = serve.page;
    page.object_start = setup.object_start;
    viewer_.emplace(scenario, page, board_, mailbox_, tell);
  }

  // Returns an exit code. `next`: the scenario that somebody chose instead, by its place.
  int Go(bool by_itself, std::optional<std::size_t>* next) {
    Commands commands(viewer_ ? &*viewer_ : nullptr, recording_ ? &*recording_ : nullptr);
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
    loop.stay = serve_.stay;
    loop.mailbox = &*mailbox_;
    loop.stops = &*stops_;
    loop.by_itself = by_itself;
    loop.watch_headsets = !emulator_.setup().simulated;
    loop.states = recording_ ? &*recording_ : nullptr;
    loop.choose = emulator_.setup().simulated;
    Follower follower(board_->records, scenario_, options_.quiet,
                      loop.stay && !device_ ? "Press Ctrl-C to end." : "",
                      recording_ ? &*recording_ : nullptr, device_, enabling_device_);
    RealTimeReport report;
    const auto start = std::chrono::steady_clock::now();
    const RunEnd end = RunRealTime(&emulator_, loop, quit, &board_->records, &report);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    Summary& summary = follower.Finish().summary();
    *next = report.scenario;
    if (viewer_ && !report.scenario) viewer_->EndRun(HowItEnded(end, summary));
    if (end == RunEnd::kNotStarted && (quit || report.scenario) && summary.ticks == 0 &&
        summary.stop_count == 0) {
      if (quit) std::fprintf(stderr, "Ended on request, before the run began.\n");
      return kFinished;
    }
    summary.overruns = report.overruns;
    summary.by_the_clock = true;
    const bool recorded = !recording_ || recording_->Close(options_.quiet);
    const RunEnd how = report.scenario && summary.stop_count == 0 ? RunEnd::kFinished : end;
    const int code = Report(emulator_, how, wall.count(), options_, &summary);
    if (!options_.quiet) PrintLoop(report);
    return code == kFinished && !recorded ? kDeviceFailure : code;
  }

  // What the next run of this program takes over: ports, and who was thrown out.
  void HandOn(ServeOptions* next) const {
    if (ros_) next->ros.port = ros_->port();
    if (!viewer_) return;
    next->page.port = viewer_->port();
    next->page.revoked = viewer_->revoked();
  }

 private:
  const Scenario& scenario_;
  const ScenarioOptions& options_;
  const ServeOptions& serve_;
  const RealDevice* device_;  // the emulator's, if its arms are real
  bool enabling_device_ = false;
  Emulator emulator_;
  Shared<RunBoard> board_;
  Shared<RunMailbox> mailbox_;  // of pages
  Shared<StopMailbox> stops_;   // of ROS-TCP's clients
  std::optional<RunRecording> recording_;
  std::optional<WatchdogProcess> watchdog_;
  std::optional<RosTcpProcess> ros_;
  std::optional<ViewerProcess> viewer_;
};

// "out.json", "out-2.json", ... for the first run, the second, ...; standard output takes them all.
std::string SummaryOf(const std::string& file, int run) {
  if (file.empty() || file == "-" || run == 1) return file;
  const std::filesystem::path path(file);
  std::filesystem::path name = path.stem();
  name += "-" + std::to_string(run);
  name += path.extension();
  return (path.parent_path() / name).string();
}

// The command line's options for a scenario that a page chose: what was set of the first one's
// values need not exist in another.
ScenarioOptions OptionsFor(const std::filesystem::path& file, const ScenarioOptions& first,
                           int run) {
  ScenarioOptions options = first;
  options.file = file.string();
  options.set.clear();
  options.summary = SummaryOf(first.summary, run);
  if (!first.set.empty())
    std::fprintf(stderr, "%s is run without --set %s, which was meant for %s.\n",
                 options.file.c_str(), Join(first.set, " --set ").c_str(), first.file.c_str());
  if (options.summary != first.summary)
    std::fprintf(stderr, "Its summary goes to %s.\n", options.summary.c_str());
  return options;
}

}  // namespace

// With real arms: one scenario, a person at the console, and nothing chosen from a page.
namespace {

// What is known of the arms' own settings; throws DeviceError where they contradict the file.
void CheckArms(const Machine& machine, const RealDevice& device) {
  for (int hand = 0; hand < kHands; ++hand) {
    const DeviceFacts* facts = device.arm_facts(hand);
    if (facts == nullptr) continue;
    for (const std::string& remark : facts->remarks)
      std::fprintf(stderr, "%s: %s\n", facts->name.c_str(), remark.c_str());
    const MachineArm& side = *machine.arm(hand);
    const auto model = LoadArmModel(
        side.arm, {}, std::string("arms.") + kHandNames[static_cast<std::size_t>(hand)] + ".arm");
    for (const std::string& refusal :
         {KinematicsRefusal(*facts, side.arm, *model), PayloadRefusal(*facts, side)})
      if (!refusal.empty()) throw DeviceError(facts->name + ": " + refusal);
  }
}

int RunOnMachine(const ScenarioOptions& options, ServeOptions serve, RecordOptions record) {
  if (isatty(STDIN_FILENO) != 1)
    throw InputError(
        "With real arms a person must be at the console: standard input is no terminal.");
  const Machine machine = LoadMachine(options.machine);
  Scenario scenario = options.Load(&machine);
  RequirePushTests(machine, scenario);
  RequireRealTime(machine);
  for (const std::string& line : UnmeasuredLoops(machine, scenario))
    std::fprintf(stderr, "%s\n", line.c_str());
  RequireStability(machine, scenario);
  std::fputs(
      "Connecting to the arms. These drivers have never run on hardware by us: keep the "
      "emergency stop within reach, and hands off the handles until IDLE: the sensors are tared.\n",
      stderr);
  std::unique_ptr<RealDevice> device = ConnectMachine(machine, &scenario, SocketNetwork());
  CheckArms(machine, *device);
  record.machine = SaveMachine(machine);
  serve.stay = true;
  serve.page.secret = NewAdmissionSecret();
  Run run(scenario, options, serve, record, std::move(device), &machine);
  std::optional<std::size_t> none;
  return run.Go(false, &none);
}

}  // namespace

int RunCommand(const ScenarioOptions& first, ServeOptions serve, RecordOptions record) {
  // Whatever asks the program to end brings the arms to rest first; a closed pipe ends nothing.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, OnSignal);
  std::signal(SIGPIPE, SIG_IGN);
  ScenarioOptions options = first;
  if (!first.machine.empty()) return RunOnMachine(first, serve, record);
  Scenario scenario = options.Load();
  const std::filesystem::path folder = std::filesystem::absolute(scenario.file).parent_path();
  serve.stay |= isatty(STDIN_FILENO) == 1;
  serve.page.secret = NewAdmissionSecret();
  if (serve.viewer) serve.page.scenarios = ScenariosIn(folder);
  std::optional<Run> run(std::in_place, scenario, options, serve, record);
  for (int count = 1;; ++count) {
    std::optional<std::size_t> next;
    const int code = run->Go(count == 1, &next);
    if (!next || *next >= serve.page.scenarios.size()) return code;
    // Pages that are in stay in: the same ports, the same secret.
    run->HandOn(&serve);
    run.reset();
    record.file.clear();  // the one that was named is of the first run
    const std::string name = serve.page.scenarios[*next].name;
    const Scenario before = scenario;
    const ScenarioOptions options_before = options;
    serve.page.notice.clear();
    try {
      options = OptionsFor(folder / (name + ".yaml"), first, count + 1);
      scenario = options.Load();
      run.emplace(scenario, options, serve, record);
    } catch (const InputError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      serve.page.notice = "The scenario " + name + " cannot be run: " + error.what();
      scenario = before;
      options = options_before;
      options.summary = SummaryOf(first.summary, count + 1);
      run.emplace(scenario, options, serve, record);
    }
  }
}

}  // namespace predictor
