#include "fakes/ur/fake_ur.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "fakes/ur/ur_rtde_program.h"
#include "fakes/ur/urscript.h"
#include "fakes/ur/urscript_machine.h"

namespace predictor {
namespace {

constexpr std::uint16_t kDashboard = 29999, kPrimary = 30001, kRtde = 30004;
constexpr long kPrimaryPeriod = 100;  // [ms]
constexpr double kSafetyBrake = 30;   // [rad/s²]
constexpr double kProgramBrake = 10;  // at the end of a program in motion [rad/s²]

class ScriptProgram final : public UrProgram {
 public:
  ScriptProgram(const std::string& text, UrController* controller)
      : program_(urscript::Compile(text)), machine_(&program_, controller) {}
  const std::string& name() const override { return program_.name; }
  bool Cycle() override { return machine_.Cycle(); }

 private:
  urscript::Program program_;
  urscript::Machine machine_;
};

}  // namespace

FakeUr::FakeUr(const FakeUrOptions& options)
    : options_(options),
      rtde_(
          &controller_, options.version,
          [this](int link, std::span<const std::byte> bytes) {
            if (!frozen_) late_.push_back({now_ + delay_, link, Bytes(bytes.begin(), bytes.end())});
          },
          [this](const std::string& line) { Log("RTDE: " + line); }),
      cycle_ms_(options.version.major == 3 ? 8 : 2) {
  controller_.cycle = 1e-3 * cycle_ms_;
  controller_.time = 100;
  controller_.payload = options.payload;
  controller_.payload_cog = options.payload_cog;
  controller_.geometry = options.geometry;
  controller_.tool_offset = options.tool_offset;
}

FakeUr::~FakeUr() = default;

std::vector<std::uint16_t> FakeUr::tcp_ports() const {
  return {kDashboard, kPrimary, 30002, 30003, kRtde};
}

void FakeUr::Opened(int link, std::uint16_t port) {
  if (port == kRtde) return rtde_.Opened(link);
  ports_[link] = port;
  if (port == kDashboard) SendText(link, "Connected: Universal Robots Dashboard Server\n");
}

void FakeUr::Closed(int link) {
  rtde_.Closed(link);
  ports_.erase(link);
  unfinished_.erase(link);
}

void FakeUr::Received(int link, std::span<const std::byte> bytes) {
  if (rtde_.Has(link)) return rtde_.Received(link, bytes);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (ports_.at(link) != kDashboard) return TakeProgram(link, text);
  std::string& line = unfinished_[link];
  for (const char c : text) {
    if (c == '\n') SendText(link, Dashboard(std::exchange(line, "")) + "\n");
    if (c != '\n' && c != '\r') line += c;
  }
}

// Sends a message of the primary interface without content, because RTDE provides the same data.
void FakeUr::SayOnPrimary() {
  static constexpr std::array<std::byte, 5> kRobotState = {std::byte{0}, std::byte{0}, std::byte{0},
                                                           std::byte{5}, std::byte{16}};
  for (const auto& [link, port] : ports_)
    if (port == kPrimary) wire().Send(link, kRobotState);
}

void FakeUr::SendText(int link, const std::string& text) {
  wire().Send(link, std::as_bytes(std::span(text)));
}

void FakeUr::TakeProgram(int link, const std::string& text) {
  std::string& program = unfinished_[link];
  program += text;
  if (!urscript::Complete(program)) return;
  Load(std::exchange(program, ""));
}

void FakeUr::Load(const std::string& text) {
  if (!remote_) return Log("refused: a program, in local control");
  if (controller_.safety_bits != UrController::kNormal ||
      controller_.robot_mode != UrController::kRunning)
    return Log("refused: a program, while the arm cannot move");
  try {
    auto program = RecogniseUrRtde(text, &controller_);
    if (!program) program = std::make_unique<ScriptProgram>(text, &controller_);
    if (program_) EndProgram("replaced");
    program_ = std::move(program);
    controller_.runtime = UrController::kPlaying;
    Log("program " + program_->name());
  } catch (const std::exception& error) {
    Log(std::string("program refused: ") + error.what());
  }
}

void FakeUr::EndProgram(const std::string& why) {
  if (program_) Log("program ended: " + why);
  program_.reset();
  controller_.runtime = UrController::kStoppedProgram;
  controller_.Stopj(kProgramBrake);
}

void FakeUr::RunProgram() {
  if (!program_ || controller_.runtime != UrController::kPlaying) return;
  try {
    if (!program_->Cycle()) EndProgram("by itself");
  } catch (const std::exception& error) {
    EndProgram(error.what());
  }
}

std::string FakeUr::Dashboard(const std::string& line) {
  std::string word = line;
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const UrVersion& v = options_.version;
  if (word == "polyscopeversion")
    return "URSoftware " + std::to_string(v.major) + "." + std::to_string(v.minor) + "." +
           std::to_string(v.bugfix) + "." + std::to_string(v.build) + " (Jan 01 2022)";
  if (word == "is in remote control" && v.AtLeast(5, 6)) return remote_ ? "true" : "false";
  if (word == "running") return std::string("Program running: ") + (program_ ? "true" : "false");
  if (word == "get serial number") return "20225500001";
  if (word == "get robot model") return "UR5";
  if (word == "stop") return Do("stop program") ? "Stopped" : "Failed to execute: stop";
  if (word == "power off" && !remote_) return "Failed to execute: power off";  // in local control
  if (word == "power off") return Do(word) ? "Powering off" : "";
  Log("dashboard: " + line);
  return "could not understand: '" + line + "'";
}

void FakeUr::Sample(const ArmSample& sample) {
  for (std::size_t i = 0; i < kUrJoints; ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    controller_.q[i] = sample.q.size() == kUrJoints ? sample.q[j] : 0;
    controller_.v[i] = sample.v.size() == kUrJoints ? sample.v[j] : 0;
    controller_.wrench[i] = sample.F_S_raw[j];  // force of the tool on the flange
  }
  if (not_a_number_) controller_.q[2] = std::numeric_limits<double>::quiet_NaN();
}

void FakeUr::Cycle() {
  controller_.time += controller_.cycle;
  RunProgram();
  controller_.Advance();
  if (repeats_) return rtde_.Repeat();
  rtde_.Cycle();
}

void FakeUr::Step(Mechanics* mechanics) {
  ++now_;
  Sample(mechanics->sample);
  if ((now_ + options_.phase) % cycle_ms_ == 0) Cycle();
  while (!late_.empty() && late_.front().due <= now_) {
    wire().Send(late_.front().link, late_.front().bytes);
    late_.pop_front();
  }
  if (now_ % kPrimaryPeriod == 0 && !mute_) SayOnPrimary();
  mechanics->command = Eigen::Map<const Vector6>(controller_.set_point().data());
}

void FakeUr::Brake(std::uint32_t safety_bits) {
  controller_.safety_bits = safety_bits;
  if (program_) controller_.runtime = UrController::kPaused;
  controller_.Stopj(kSafetyBrake);
}

bool FakeUr::Do(const std::string& what) {
  return DoToArm(what) || DoToProgram(what) || DoToWire(what);
}

bool FakeUr::DoToArm(const std::string& what) {
  using C = UrController;
  if (what == "protective stop") {
    Brake(C::kProtectiveStop | C::kStopped);
  } else if (what == "safeguard stop") {
    Brake(C::kSafeguardStop | C::kStopped);
  } else if (what == "emergency stop") {
    Brake(C::kRobotEmergencyStop | C::kEmergencyStop | C::kStopped);
    EndProgram(what);
    controller_.robot_mode = C::kPowerOff;
  } else if (what == "power off") {
    EndProgram(what);
    controller_.robot_mode = C::kPowerOff;
  } else if (what == "freedrive" || what == "freedrive off") {
    controller_.freedrive = what == "freedrive";
  } else if (what == "unlock") {
    controller_.safety_bits = C::kNormal;
  } else if (what.starts_with("slider ")) {
    controller_.slider = std::stod(what.substr(7)) / 100;
  } else if (what.starts_with("press ")) {
    controller_.inputs |= std::uint64_t{1} << std::stoi(what.substr(6));
  } else if (what.starts_with("release ")) {
    controller_.inputs &= ~(std::uint64_t{1} << std::stoi(what.substr(8)));
  } else if (what == "not a number") {
    not_a_number_ = true;
  } else {
    return false;
  }
  return true;
}

bool FakeUr::DoToProgram(const std::string& what) {
  if (what == "stop program") {
    EndProgram("stopped");
  } else if (what == "pause program") {
    if (program_) controller_.runtime = UrController::kPaused;
    controller_.Stopj(kProgramBrake);
  } else if (what == "play") {
    if (program_) controller_.runtime = UrController::kPlaying;
  } else if (what == "local control") {
    remote_ = false;
  } else {
    return false;
  }
  return true;
}

void FakeUr::Drop(std::uint16_t port) {
  std::vector<int> links;
  for (const auto& [link, its] : ports_)
    if (its == port) links.push_back(link);
  for (const int link : links) {
    wire().Close(link);
    Closed(link);
  }
}

bool FakeUr::DoToWire(const std::string& what) {
  if (what == "freeze" || what == "thaw") {
    frozen_ = what == "freeze";
  } else if (what == "repeat") {
    repeats_ = true;
  } else if (what == "rewind") {
    controller_.time -= 1;
  } else if (what.rfind("late ", 0) == 0) {
    delay_ = std::stol(what.substr(5));
  } else if (what == "drop link") {
    for (const int link : rtde_.links()) {
      wire().Close(link);
      rtde_.Closed(link);
    }
  } else if (what == "drop primary" || what == "drop dashboard") {
    Drop(what == "drop primary" ? kPrimary : kDashboard);
  } else if (what == "mute primary" || what == "unmute primary") {
    mute_ = what == "mute primary";
  } else if (what == "malformed" || what == "text") {
    static constexpr std::array<std::byte, 3> kMalformed = {std::byte{0}, std::byte{1},
                                                            std::byte{'U'}};
    rtde::PacketWriter text(rtde::PacketType::kText);
    text.Put(std::uint8_t{5}).Put("hello").Put(std::uint8_t{4}).Put("fake").Put(std::uint8_t{3});
    for (const int link : rtde_.links())
      wire().Send(link, what == "text" ? text.Finish() : std::span<const std::byte>(kMalformed));
  } else if (what == "deaf") {
    rtde_.deaf = true;
  } else {
    return false;
  }
  return true;
}

}  // namespace predictor
