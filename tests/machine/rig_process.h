// Runs the fakes and the program in separate processes, and simulates a person at the program's
// terminal.
#pragma once

#include <gtest/gtest.h>
#include <pty.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "app/child_process.h"
#include "commissioning/machine_file.h"
#include "devices/standstill.h"
#include "fakes/note_loops.h"
#include "scenario/machine.h"
#include "scenario/scenario_io.h"
#include "support/brisk.h"

namespace predictor {

// Returns an address of this machine that no other test process uses. `last` is from 1 to 254.
inline std::string HostOf(int last) {
  constexpr int kNumbers = 250;
  const int pid = getpid();
  return "127." + std::to_string(1 + pid % kNumbers) + "." +
         std::to_string(pid / kNumbers % kNumbers) + "." + std::to_string(last);
}
constexpr int kLeft = 10, kRight = 11, kLeftSensor = 20, kRightSensor = 21;

inline std::string FileOf(const std::string& scenario) {
  return std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + scenario + ".yaml";
}

// The true arms' motion since the mark, as in FarRig::Motion.
struct RigMotion {
  double rest_after = 0, fastest = 0, hardest = 0, distance = 0, joint = 0, braking = 0;
};

// The longest delays that the process of the fakes measured [ms]. `processor` is the longest delay
// of the highest-priority threads on each processor, and `processor_sum` is the sum of these
// delays. `rig` is the delay of the fakes' loop. `ordinary` is the longest delay of a thread with
// the ordinary priority of the program's console. `silence` is the program's longest silence.
struct RigLateness {
  double processor = 0, processor_sum = 0, rig = 0, silence = 0, ordinary = 0;
};

// The process that runs the fakes and their rig.
class FakeRig {
 public:
  FakeRig(const std::string& scenario, const std::vector<std::string>& fakes) {
    std::array<int, 2> in{}, out{};
    EXPECT_EQ(pipe(in.data()), 0);
    EXPECT_EQ(pipe(out.data()), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], 0);
    posix_spawn_file_actions_adddup2(&actions, out[1], 1);
    for (const int end : {in[0], in[1], out[0], out[1]})
      posix_spawn_file_actions_addclose(&actions, end);
    std::vector<std::string> arguments = {"fake_rig", scenario};
    arguments.insert(arguments.end(), fakes.begin(), fakes.end());
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&pid_, PREDICTOR_FAKE_RIG, &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]);
    close(out[1]);
    to_ = in[1];
    from_ = out[0];
    EXPECT_EQ(Line(), "ready");
  }
  ~FakeRig() {
    close(to_);
    close(from_);
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  std::string Ask(const std::string& line) {
    const std::string text = line + "\n";
    EXPECT_EQ(write(to_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    return Line();
  }
  RigMotion Motion() {
    std::istringstream answer(Ask("motion"));
    RigMotion m;
    answer >> m.rest_after >> m.fastest >> m.hardest >> m.distance >> m.joint >> m.braking;
    EXPECT_TRUE(answer);
    return m;
  }
  // Returns the computer's lateness between two times of the monotonic clock [ns].
  RigLateness Late(std::uint64_t from, std::uint64_t to) {
    std::istringstream answer(Ask("late " + std::to_string(from) + " " + std::to_string(to)));
    RigLateness late;
    answer >> late.processor >> late.processor_sum >> late.rig >> late.silence >> late.ordinary;
    EXPECT_TRUE(answer);
    return late;
  }
  void Kill(int signal) const { kill(pid_, signal); }
  // Returns the log of a fake.
  std::vector<std::string> Log(const std::string& side, int place) {
    std::vector<std::string> lines = {Ask("log " + side + " " + std::to_string(place))};
    while (!lines.back().empty() && lines.back() != ".") lines.push_back(Line());
    return lines;
  }

 private:
  std::string Line() {
    std::string line;
    for (char byte; read(from_, &byte, 1) == 1 && byte != '\n';) line.push_back(byte);
    return line;
  }

  pid_t pid_ = -1;
  int to_ = -1, from_ = -1;
};

// The time to rest and the deceleration that the documents state for the worse of two makes. The
// time and the deceleration apply if the program dies while the fastest joint moves at `speed`
// [rad/s]. A thousandth is added to the deceleration for rounding.
struct Advertised {
  // The program's driver allows this deceleration of a Franka's joints [rad/s²].
  static constexpr double kLetThrough = 0.95 * 10;
  Advertised(const std::array<const char*, 2>& makes, double speed) {
    for (const std::string make : makes) {
      const Standstill& arm = StandstillOf(make == "ur" ? ArmMake::kUr : ArmMake::kFranka);
      rest_after = std::max(rest_after, arm.Within(speed));
      braking = std::max(braking, 1.001 * arm.deceleration);
      // Until a Franka reacts to the silence, it decelerates as the program's driver allowed.
      if (make == "franka") braking = std::max(braking, 1.001 * kLetThrough);
    }
  }
  double rest_after = 0, braking = 0;  // [s], [rad/s²]
};

// The messages that end a run or the measurement of a joint because the computer or the program was
// late.
inline constexpr std::array kLateSigns = {"the stop 'stale'",
                                          "the stop 'deadline'",
                                          "received no command from this",
                                          "communication constraints violation",
                                          "no longer sends states",
                                          "stopped sending its state",
                                          "arrived in time (",
                                          "missed its deadline",
                                          "The control loop hung, and the watchdog"};

// The program at a separate terminal, with a person who reads it and holds keys.
class Terminal {
 public:
  explicit Terminal(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "predictor");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) {
      execv(PREDICTOR_BINARY, argv.data());
      _exit(127);
    }
    person_ = std::thread([this] { Live(); });
  }
  ~Terminal() {
    done_ = true;
    person_.join();
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
    close(terminal_);
  }

  void Hold(char key) { held_ = key; }
  void Let() { held_ = 0; }
  void Type(const std::string& text) const {
    EXPECT_EQ(write(terminal_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  // Returns whether the text appears within `patience` [s] and after the text of the previous wait.
  bool Says(const std::string& text, double patience = 30) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience);
    for (bool over = false; !over && std::chrono::steady_clock::now() < end;) {
      over = silent_;  // the program has ended: there will be no more output
      const std::string said = Screen();
      if (const auto at = said.find(text, read_); at != std::string::npos) {
        read_ = at + text.size();
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  // Waits for a line that starts with `begin`. Returns the rest of this line, or "" if the line
  // does not appear.
  std::string Line(const std::string& begin, double patience = 30) {
    if (!Says(begin, patience)) return "";
    const std::size_t at = read_;
    if (!Says("\r\n", patience)) return "";
    return Screen().substr(at, read_ - 2 - at);
  }
  std::string Screen() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return said_;
  }
  void Kill(int signal) const {
    if (pid_ > 0) kill(pid_, signal);
  }
  int pid() const { return pid_; }
  // Returns the program's exit code, or −signal if a signal killed it. If the program does not end,
  // the simulated person kills it after two minutes.
  int Wait() {
    if (pid_ < 0) return code_;
    int status = 0;
    for (int i = 0; waitpid(pid_, &status, WNOHANG) == 0; ++i) {
      if (i == 12'000) Kill(SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    pid_ = -1;
    // This loop reads all remaining output.
    for (int i = 0; i < 1000 && !silent_; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  // Returns whether the thread that simulates the person repeated a letter too late.
  bool letter_was_late() const { return letter_was_late_; }
  // Returns the time at which the screen first reported a stop, on the monotonic clock [ns], or the
  // current time if it has not reported one.
  std::uint64_t stop_seen() const { return stop_seen_ != 0 ? stop_seen_.load() : Now(); }
  static std::uint64_t Now() {
    return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  }
  // Returns whether the arms become ready before any stop.
  bool IsIdle() { return Comes("Now IDLE"); }
  // Goes through ALIGN and ARMED to RUN. Then notifies the person whom the fakes simulate. Returns
  // false if the run stops.
  bool Start(FakeRig* rig) {
    if (!IsIdle()) return false;
    Hold('a');
    if (!Comes("Now ARMED")) return false;
    Hold('s');
    return Comes("Now RUN") && rig->Ask("run") == "ok";
  }

  // Returns whether the text appears before the run stops.
  bool Comes(const std::string& text) {
    for (int i = 0; i < 1500; ++i) {
      if (Says(text, 0.02)) return true;
      if (Screen().find("Now STOPPING", read_) != std::string::npos) {
        // Once the arms are at rest, the program prints the reason line by line.
        if (Says("after the stop", 2)) std::this_thread::sleep_for(std::chrono::milliseconds(300));
        return false;
      }
    }
    return false;
  }

 private:
  static bool ReportsAStop(const std::string& said) {
    const auto contains = [&](const char* sign) { return said.find(sign) != std::string::npos; };
    return contains("Now STOPPING") || contains("Now UNPOWERED") ||
           std::ranges::any_of(kLateSigns, contains);
  }
  // A terminal repeats a key after half a second, and then every 33 ms.
  void Live() {
    char last = 0;
    auto next = std::chrono::steady_clock::now();
    while (!done_) {
      pollfd ready{terminal_, POLLIN, 0};
      if (poll(&ready, 1, 5) > 0) {
        std::array<char, 4096> bytes;
        const ssize_t n = read(terminal_, bytes.data(), bytes.size());
        silent_ = n <= 0;
        if (n <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        const std::lock_guard<std::mutex> lock(mutex_);
        if (n > 0) said_.append(bytes.data(), static_cast<std::size_t>(n));
        if (stop_seen_ == 0 && ReportsAStop(said_)) stop_seen_ = Now();
      }
      const char key = held_;
      if (key == 0 || (key == last && std::chrono::steady_clock::now() < next)) {
        if (key == 0) last = 0;
        continue;
      }
      const auto now = std::chrono::steady_clock::now();
      letter_was_late_ = key == last && (letter_was_late_ || now > next + kLateLetter);
      next = now + std::chrono::milliseconds(key == last ? 33 : 500);
      last = key;
      if (write(terminal_, &key, 1) != 1) return;
    }
  }

  // With the usual 33 ms, such a delay can reach the 0.1 s after which a key counts as released.
  static constexpr std::chrono::milliseconds kLateLetter{50};

  int terminal_ = -1;
  pid_t pid_ = -1;
  int code_ = 0;
  mutable std::mutex mutex_;
  std::string said_;
  std::atomic<std::uint64_t> stop_seen_{0};
  std::size_t read_ = 0;
  std::atomic<char> held_{0};
  std::atomic<bool> done_{false}, silent_{false}, letter_was_late_{false};
  std::thread person_;
};

// `sensor` is the host of a Net F/T that sends at 1000 Hz, or "" for the arm's own sensor.
inline std::string ArmText(const std::string& make, const std::string& host,
                           const std::string& sensor, bool left) {
  const bool ur = make == "ur";
  std::ostringstream text;
  text << "    connection: {make: " << make << ", host: " << host << "}\n";
  if (!sensor.empty()) text << "    sensor: {make: net_ft, host: " << sensor << "}\n";
  text << "    arm:\n";
  if (ur)
    text << "      model: package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf\n"
         << "      base: {xyz: [0.1, " << (left ? -0.3 : 0.3) << ", 0.0]}\n"
         << "      end_effector: tool0\n"
         << "      handle: {xyz: [0, 0, 0.1], rpy: [3.14159265, 0, 0]}\n"
         << "      posture: [0, -1.2, 1.8, -2.2, -1.57, 0]\n"
         << "      elbow: forearm_link\n      sample_rate: 500\n"
         << (sensor.empty() ? "      sensor: {sample_rate: 500}\n" : "");
  else
    text << "      model: package://example-robot-data/robots/panda_description/urdf/panda.urdf\n"
         << "      remove_links: [panda_hand]\n"
         << "      base: {xyz: [0.1, " << (left ? -0.25 : 0.25) << ", -0.25]}\n"
         << "      end_effector: panda_link8\n"
         << "      handle: {xyz: [0, 0, 0.1], rpy: [3.14159265, 0, -0.78539816]}\n"
         << "      posture: [0, -0.5, 0, -2.3, 0, 1.8, 0.785]\n"
         << "      elbow: panda_link4\n";
  return text.str();
}

// A temporary folder with a machine file that refers to no other file. The destructor deletes the
// folder.
class MachineFolder {
 public:
  // `sensors` contains "net_ft", or "" for the arm's own sensor.
  explicit MachineFolder(const std::array<std::string, 2>& makes,
                         const std::array<std::string, 2>& sensors = {})
      : folder_(std::filesystem::temp_directory_path() /
                ("predictor_machine_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    std::ofstream(file()) << "predictor_machine: 1\narms:\n  left:\n"
                          << ArmText(makes[0], HostOf(kLeft),
                                     sensors[0].empty() ? "" : HostOf(kLeftSensor), true)
                          << "  right:\n"
                          << ArmText(makes[1], HostOf(kRight),
                                     sensors[1].empty() ? "" : HostOf(kRightSensor), false);
  }
  ~MachineFolder() { std::filesystem::remove_all(folder_); }
  MachineFolder(const MachineFolder&) = delete;
  MachineFolder& operator=(const MachineFolder&) = delete;

  std::string file() const { return (folder_ / "lab.yaml").string(); }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  // Writes a copy of the scenario whose person moves the object briskly from side to side.
  std::string Brisk(const std::string& scenario) const {
    Scenario brisk = LoadScenario(FileOf(scenario));
    brisk.operator_.script = BriskScript();
    const std::filesystem::path models = folder_ / "assets", file = folder_ / "brisk" / "it.yaml";
    std::filesystem::create_directories(file.parent_path());
    if (!std::filesystem::exists(models))
      std::filesystem::copy(PREDICTOR_SOURCE_DIR "/assets", models,
                            std::filesystem::copy_options::recursive);
    std::ofstream(file) << SaveScenario(brisk);
    return file.string();
  }
  Machine machine() const { return LoadMachine(file()); }
  void Change(const std::function<void(Machine*)>& change) const {
    commissioning::ChangeMachine(file(), "before", change);
  }
  // Stores the results that `predictor calibrate loop` and `predictor calibrate push` would store.
  void NotePushTests() const {
    Change([](Machine* machine) {
      NoteLoops(machine);
      for (std::optional<MachineArm>* arm : {&machine->left, &machine->right}) {
        if (!*arm) continue;
        (*arm)->commissioned->push_test = "2026-01-02T03-04-05";
        (*arm)->commissioned->of = HashOf(**arm);
      }
    });
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace predictor
