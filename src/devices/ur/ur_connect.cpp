#include "devices/ur/ur_connect.h"

#include <array>
#include <cmath>
#include <utility>

#include "devices/ur/ur_script.h"

namespace predictor {
namespace {

constexpr double kTimeout = 2;  // longest wait for an immediate response of the controller [s]
constexpr double kLaunch = 5;   // longest wait for our program to start [s]
constexpr int kHalf = 24;       // number of registers of each kind

struct Version {
  std::uint32_t major = 0, minor = 0, bugfix = 0, build = 0;

  bool IsCb3() const { return major == 3; }
  bool AtLeast(std::uint32_t a, std::uint32_t b) const {
    return major > a || (major == a && minor >= b);
  }
  std::string ToString() const {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(bugfix) +
           "." + std::to_string(build);
  }
};

void Check(const UrOptions& options) {
  const auto positive = [&options](const char* what, double value) {
    if (!(value >= 0.1 && value <= 100))
      throw DeviceError("The " + std::string(what) + " of the arm at " + options.host +
                        " is not between 0.1 and 100 rad/s².");
  };
  positive("acceleration", options.acceleration);
  positive("deceleration", options.deceleration);
  const int r = options.first_register;
  if (r < 0 || r % kHalf > kHalf - kUrJoints || r >= 2 * kHalf)
    throw DeviceError("The first register of the arm at " + options.host + " is " +
                      std::to_string(r) + ". Choose 24, or 0 if another client uses that half.");
}

// Converts a position [m] and a rotation vector [rad] to a pose.
Pose PoseOf(const UrVector& x) {
  return {{x[0], x[1], x[2]}, RotationFromVector({x[3], x[4], x[5]})};
}

// A client of the dashboard server. This server controls the robot as a whole. The server answers
// each line with one line. An arm can also move without this server. PolyScope X does not have one.
class Dashboard {
 public:
  explicit Dashboard(Network* network) : network_(network) {}
  // Returns false if no greeting arrives.
  bool Open(const Address& peer) try {
    stream_ = network_->Connect(peer, kTimeout);
    if (Line().empty()) stream_.reset();
    return stream_ != nullptr;
  } catch (const DeviceError&) {
    return false;
  }
  // Returns "" if there is no answer.
  std::string Ask(const std::string& question) {
    const std::string line = question + "\n";
    if (!stream_ || !stream_->Write(std::as_bytes(std::span(line)))) return "";
    return Line();
  }
  std::unique_ptr<Stream> Release() { return std::move(stream_); }

 private:
  std::string Line() {
    std::string line;
    WaitUntil(network_, kTimeout, [&] {
      std::byte byte{};
      int n = 0;
      while ((n = stream_->Read({&byte, 1})) == 1 && byte != std::byte{'\n'})
        line += static_cast<char>(byte);
      return n != 0;
    });
    return line;
  }

  Network* network_;
  std::unique_ptr<Stream> stream_;
};

// The steps of the setup, in order. Each throws DeviceError.
class Setup {
 public:
  Setup(const UrOptions& options, Network* network)
      : options_(options),
        network_(network),
        peer_{options.host, options.rtde_port},
        dashboard_(network) {
    Check(options);
    setup_.connection = std::make_unique<rtde::Connection>(network, peer_);
  }

  UrSetup Run() && {
    AgreeOnVersion();
    AgreeOnRecipes();
    OpenDashboard();
    Start();
    TakeFacts();
    if (options_.listen) return std::move(setup_);
    CheckArm();
    ClearRegisters();
    LaunchProgram();
    return std::move(setup_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const { throw DeviceError(peer_, why); }

  void AgreeOnVersion() {
    if (!Accepts(rtde::kProtocolVersion))
      Refuse(std::string(Accepts(1) ? "answers RTDE version 1" : "refuses RTDE version 2") +
             ", but version 2 is needed. Update PolyScope to 3.4 or newer.");
    const auto numbers = Ask(rtde::AskControllerVersion(), rtde::PacketType::kControllerVersion);
    BigEndianReader reader(numbers);
    for (std::uint32_t* part : {&version_.major, &version_.minor, &version_.bugfix})
      reader.Get(part);
    if (!reader.ok()) Refuse("does not report its version.");
    reader.Get(&version_.build);
    if (version_.major != 3 && version_.major < 5)
      Refuse("answers PolyScope version " + version_.ToString() +
             ", but version 3 (CB3), or 5 (e-Series) or newer, is needed. This program cannot "
             "drive older controllers.");
    const bool cb3 = version_.IsCb3();
    cycle_ = cb3 ? 0.008 : 0.002;
    setup_.write_period = cb3 ? 0.004 : 0.002;
    setup_.facts = {.name = "Universal Robots " + std::string(cb3 ? "CB3" : "e-Series") +
                            ", PolyScope " + version_.ToString() + ", at " + peer_.host +
                            " (driver never run on hardware)",
                    .joints = kUrJoints,
                    .rate = 1 / cycle_,
                    .own_wrench = version_.AtLeast(5, 9),
                    .watchdog = UrWatchdog(cycle_)};
  }

  // Returns whether the controller supports this version of RTDE.
  bool Accepts(std::uint16_t version) {
    const auto answer = Ask(rtde::AskVersion(version), rtde::PacketType::kVersion);
    return !answer.empty() && answer[0] != std::byte{0};
  }

  std::vector<std::byte> Ask(const std::vector<std::byte>& request, rtde::PacketType answer) {
    return setup_.connection->Ask(request, answer);
  }

  int Agree(const std::vector<std::byte>& request, rtde::PacketType type,
            std::span<const rtde::Field> recipe) {
    rtde::RecipeAnswer answer;
    if (!rtde::Decode(Ask(request, type), &answer)) Refuse("sends an empty answer to a recipe.");
    if (const std::string why = rtde::Refusal(recipe, answer); !why.empty()) Refuse(why);
    return answer.id;
  }

  // Older controllers report neither the payload nor the pose of the tool on the flange. For such
  // controllers, the check of the payload is omitted, and the pose of the flange is checked without
  // a tool.
  void AgreeOnRecipes() {
    setup_.extras.wrench = setup_.facts.own_wrench;
    setup_.extras.payload = Offers({{"payload", "DOUBLE"}, {"payload_cog", "VECTOR3D"}});
    setup_.extras.tool_offset = Offers({{"tcp_offset", "VECTOR6D"}});
    const auto outputs = UrOutputs(options_.first_register, setup_.extras);
    setup_.outputs =
        Agree(rtde::AskOutputs(setup_.facts.rate, outputs), rtde::PacketType::kOutputs, outputs);
    if (options_.listen) return;
    const auto inputs = UrInputs(options_.first_register);
    setup_.inputs = Agree(rtde::AskInputs(inputs), rtde::PacketType::kInputs, inputs);
  }

  bool Offers(const std::vector<rtde::Field>& fields) {
    rtde::RecipeAnswer answer;
    return rtde::Decode(
               Ask(rtde::AskOutputs(setup_.facts.rate, fields), rtde::PacketType::kOutputs),
               &answer) &&
           rtde::Refusal(fields, answer).empty();
  }

  void OpenDashboard() {
    const Address peer{peer_.host, options_.dashboard_port};
    if (peer.port != 0 && dashboard_.Open(peer)) return;
    setup_.facts.remarks.emplace_back(
        "The robot's dashboard server (port 29999) does not answer, as on PolyScope X. This "
        "program therefore cannot switch the robot's power off. After a stop with power-off, the "
        "arm holds its position with power on. In that case, use the emergency stop of the arm.");
  }

  void Start() {
    const auto accepted = Ask(rtde::AskStart(), rtde::PacketType::kStart);
    if (accepted.empty() || accepted[0] == std::byte{0}) Refuse("refuses to send its state.");
    if (!WaitUntil(network_, kTimeout, [this] { return Hear(1); }))
      Refuse("accepts the recipes but does not send its state.");
  }

  // Returns true if at least `packages` states have arrived since this function last returned true.
  bool Hear(int packages) {
    using State = rtde::Connection::State;
    const State state = setup_.connection->Drain([this](const rtde::Packet& packet) {
      if (packet.type != rtde::PacketType::kData) return packet.type == rtde::PacketType::kText;
      ++heard_;
      return Decode(packet.payload, setup_.outputs, setup_.extras, &setup_.state) &&
             Plausible(setup_.state);
    });
    if (state == State::kClosed) Refuse(Sentence(UrFault::kClosed));
    if (state == State::kMalformed) Refuse(Sentence(UrFault::kMalformed));
    if (heard_ < packages) return false;
    heard_ = 0;
    return true;
  }

  void TakeFacts() {
    const UrState& state = setup_.state;
    if (setup_.extras.payload)
      setup_.facts.payload = ReportedPayload{
          state.payload, {state.payload_cog[0], state.payload_cog[1], state.payload_cog[2]}};
    if (ArmFault(state) != UrFault::kUnpowered)  // otherwise its joints are unknown
      setup_.facts.flange = ReportedFlange{Eigen::Map<const Vector6>(state.q.data()),
                                           PoseOf(state.tool) * PoseOf(state.tool_offset).Inverse(),
                                           "tool0", setup_.extras.tool_offset};
    if (SlowedDown(state))
      setup_.facts.remarks.push_back(
          "Its speed slider is at " + std::to_string(std::lround(100 * state.slider)) +
          " %. Set the speed slider to 100 %. Until then, this program does not move the arm.");
  }

  void CheckArm() {
    if (const UrFault fault = ArmFault(setup_.state); fault != UrFault::kNone)
      Refuse(Sentence(fault));
    if (SlowedDown(setup_.state)) Refuse(Sentence(UrFault::kSpeedSlider));
    if (setup_.state.runtime != kUrStopped)
      Refuse(
          "is running or pausing a program. Stop this program at the pendant. (A program that an "
          "earlier run of this software left waiting ends by itself within half a minute.)");
    // Older controllers and the CB3 do not support this query.
    if (dashboard_.Ask("is in remote control").starts_with("false"))
      Refuse("is in local control. Choose Remote Control at the top right of the pendant.");
    setup_.dashboard = dashboard_.Release();
  }

  // Values that an earlier program left in the registers must not move the arm.
  void ClearRegisters() {
    setup_.counter = static_cast<std::int32_t>(network_->Now() / 1000 & 0x3fffffff);
    rtde::PacketWriter writer(rtde::PacketType::kData);
    const auto zeros = UrCommand(&writer, setup_.inputs, {}, setup_.counter, false);
    heard_ = 0;
    if (!setup_.connection->Send(zeros) ||
        !WaitUntil(network_, kTimeout, [this] { return Hear(3); }))
      Refuse("has stopped sending its state.");
  }

  void LaunchProgram() {
    const Address peer{peer_.host, options_.script_port};
    const auto stream = network_->Connect(peer, kTimeout);
    const std::string script = UrScript({.cycle = cycle_,
                                         .acceleration = options_.acceleration,
                                         .deceleration = options_.deceleration,
                                         .first_register = options_.first_register});
    if (!stream->Write(std::as_bytes(std::span(script))))
      throw DeviceError(peer, "does not accept the program.");
    // The connection stays open until the program runs. If the connection were closed with unread
    // data, it would be reset, and data that the controller has not read yet would be lost.
    const bool runs = WaitUntil(network_, kLaunch, [&] {
      std::array<std::byte, 4096> unused;
      while (stream->Read(unused) > 0) {
      }
      return Hear(1) && ProgramRuns();
    });
    if (runs) return;
    if (const UrFault fault = ArmFault(setup_.state); fault != UrFault::kNone)
      Refuse(Sentence(fault));
    throw DeviceError(
        peer,
        "does not start the program that receives our commands. On an e-Series, choose Remote "
        "Control at the pendant. Otherwise, read the log at the pendant.");
  }

  bool ProgramRuns() const {
    return RunFault(setup_.state) == UrFault::kNone && setup_.state.echo == setup_.counter &&
           setup_.state.script == static_cast<std::int32_t>(UrScriptState::kReady);
  }

  const UrOptions& options_;
  Network* network_;
  Address peer_;
  Dashboard dashboard_;
  Version version_;
  double cycle_ = 0;  // cycle of the controller [s]
  int heard_ = 0;     // packages since the last call of Hear
  UrSetup setup_;
};

}  // namespace

UrSetup SetUpUr(const UrOptions& options, Network* network) {
  return Setup(options, network).Run();
}

std::span<const std::byte> UrCommand(rtde::PacketWriter* writer, int recipe, const UrVector& qd,
                                     std::int32_t counter, bool follow) noexcept {
  writer->Put(static_cast<std::uint8_t>(recipe));
  for (const double v : qd) writer->Put(v);
  writer->Put(counter).Put(std::int32_t{follow ? 1 : 0});
  return writer->Finish();
}

}  // namespace predictor
