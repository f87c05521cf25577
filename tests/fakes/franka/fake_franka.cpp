#include "fakes/franka/fake_franka.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "devices/standstill.h"

namespace predictor {
namespace {

using fci::RobotMode;

// Longest time for which a robot with the option `patient` waits for a command [ms].
constexpr int kPatience = 10'000;
// The joint impedance control pulls a joint to its commanded position with this gain [1/s].
constexpr double kStiffness = 20;
constexpr double kMillisecond = 1e-3;
// The arm brakes on its own with this deceleration [rad/s²].
constexpr double kBraking = kFrankaStandstill.deceleration;

// The numbers of the commands and of the answers to Move, as in
// research_interface/robot/service_types.h.
struct Numbers {
  std::uint32_t set_collision, last_setter, recover, model;
  int not_possible, reflex, emergency, input, aborted;
};
constexpr Numbers kPandaNumbers = {4, 11, 12, 13, 3, 6, 7, 8, 9};
constexpr Numbers kResearch3Numbers = {3, 9, 10, 11, 5, 8, 9, 10, 11};
constexpr int kStarted = 1, kPreempted = 2;

const Numbers& NumbersOf(std::uint16_t version) {
  return version == fci::kPandaVersion ? kPandaNumbers : kResearch3Numbers;
}

// Finds an error by its number or by the driver's name for it. Third-party clients verify these
// names. The default is the reflex to a hard push.
int ErrorPlace(const std::string& name) {
  if (name.empty()) return ErrorPlace("cartesian_reflex");
  for (int i = 0; i < fci::kErrors; ++i)
    if (name == std::to_string(i) || name == fci::ErrorName(i)) return i;
  return -1;
}

}  // namespace

FakeFranka::FakeFranka(const FakeFrankaOptions& options)
    : options_(options),
      message_id_(options.first_message),
      motion_(FrankaLimitsOf(options.version)) {}

void FakeFranka::Opened(int link, std::uint16_t) {
  // Only one client is accepted at a time.
  if (link_ != 0) return wire().Close(link);
  link_ = link;
  received_.clear();
}

void FakeFranka::Closed(int link) {
  if (link != link_) return;
  link_ = 0;
  client_port_ = 0;
  if (phase_ != Phase::kIdle) Log("client left while moving");
  if (phase_ == Phase::kMoving) braking_ = obeyed_;  // a moving arm cannot stop instantly
  phase_ = Phase::kIdle;
  if (mode_ == RobotMode::kMove) mode_ = RobotMode::kIdle;
}

void FakeFranka::Received(int link, std::span<const std::byte> bytes) {
  if (link != link_) return;
  received_.insert(received_.end(), bytes.begin(), bytes.end());
  fci::Header header;
  while (received_.size() >= sizeof header) {
    std::memcpy(&header, received_.data(), sizeof header);
    if (header.size < sizeof header || header.size > 4096) {
      Log("invalid data on the stream");
      wire().Close(link);
      return Closed(link);
    }
    if (received_.size() < header.size) return;
    const Bytes request(received_.begin(), received_.begin() + header.size);
    received_.erase(received_.begin(), received_.begin() + header.size);
    Handle(header, std::span(request).subspan(sizeof header));
  }
}

void FakeFranka::Handle(const fci::Header& header, std::span<const std::byte> body) {
  const Numbers& n = NumbersOf(options_.version);
  if (header.command == 0) return Greet(header, body);
  if (header.command == 1) return Move(header, body);
  if (header.command == 2) return Stop(header);
  if (header.command == n.recover) return Recover(header);
  if (header.command == n.model && !panda()) {
    const std::string text = FrankaDescription();
    Bytes answer(1);
    const auto raw = std::as_bytes(std::span(text));
    answer.insert(answer.end(), raw.begin(), raw.end());
    return Answer(header, answer);
  }
  // The model of a Panda is a shared library, which this fake does not provide.
  if (header.command == n.model) return AnswerStatus(header, 1);
  if (header.command >= n.set_collision && header.command <= n.last_setter) {
    if (header.command == n.set_collision && !SetCollision(body)) return AnswerStatus(header, 2);
    return AnswerStatus(header, phase_ == Phase::kIdle ? 0 : 1);
  }
  Log("unknown command " + std::to_string(header.command));
  AnswerStatus(header, 1);
}

bool FakeFranka::SetCollision(std::span<const std::byte> body) {
  fci::CollisionRequest request;
  if (body.size() != sizeof request) return false;
  std::memcpy(&request, body.data(), sizeof request);
  if (!(request.upper_force_nominal[0] > 0)) return false;
  collision_force_ = request.upper_force_nominal[0];
  return true;
}

void FakeFranka::Answer(const fci::Header& header, std::span<const std::byte> body) {
  Bytes bytes = AsBytes(fci::Header{header.command, header.id,
                                    static_cast<std::uint32_t>(sizeof header + body.size())});
  bytes.insert(bytes.end(), body.begin(), body.end());
  if (link_ != 0) wire().Send(link_, bytes);
}

void FakeFranka::AnswerStatus(const fci::Header& header, int status) {
  const std::byte byte{static_cast<unsigned char>(status)};
  Answer(header, std::span(&byte, 1));
}

void FakeFranka::Greet(const fci::Header& header, std::span<const std::byte> body) {
  fci::ConnectRequest request{};
  if (body.size() == sizeof request) std::memcpy(&request, body.data(), sizeof request);
  const bool fits = request.version == options_.version;
  Answer(header,
         AsBytes(fci::ConnectResponse{static_cast<std::uint8_t>(fits ? 0 : 1), options_.version}));
  if (fits) client_port_ = request.udp_port;
}

void FakeFranka::Move(const fci::Header& header, std::span<const std::byte> body) {
  const Numbers& n = NumbersOf(options_.version);
  fci::PandaMove move{};
  const std::size_t size = panda() ? sizeof(fci::PandaMove) : sizeof(fci::Research3Move);
  if (body.size() != size) {
    Log("Move of " + std::to_string(body.size()) + " bytes");
    return AnswerStatus(header, n.aborted);
  }
  std::memcpy(&move, body.data(), sizeof move);
  const bool can = move.generator == fci::MoveGenerator::kJointVelocity &&
                   move.controller == fci::MoveController::kJointImpedance;
  if (!can || mode_ != RobotMode::kIdle || phase_ != Phase::kIdle)
    return AnswerStatus(header, n.not_possible);
  move_ = header;
  phase_ = Phase::kStarting;
  starting_ = start_delay_;
  AnswerStatus(header, kStarted);
  Log("motion asked for");
}

void FakeFranka::Stop(const fci::Header& header) {
  if (phase_ != Phase::kIdle) EndMove(kPreempted);
  if (mode_ == RobotMode::kMove) mode_ = RobotMode::kIdle;
  AnswerStatus(header, 0);
}

void FakeFranka::Recover(const fci::Header& header) {
  Log("automatic error recovery");
  if (mode_ == RobotMode::kUserStopped) return AnswerStatus(header, 1);
  errors_.reset();
  if (mode_ == RobotMode::kReflex) mode_ = RobotMode::kIdle;
  AnswerStatus(header, 0);
}

void FakeFranka::EndMove(int status) {
  AnswerStatus(move_, status);
  phase_ = Phase::kIdle;
  braking_ = obeyed_;
  Log("motion ended with status " + std::to_string(status));
}

void FakeFranka::Abort(std::bitset<41> errors) {
  errors_ = reflex_reason_ = errors;
  Log("reflex " + fci::ErrorWords(errors));
  Enter(RobotMode::kReflex, NumbersOf(options_.version).reflex);
}

void FakeFranka::Enter(RobotMode mode, int move_status) {
  mode_ = mode;
  if (phase_ != Phase::kIdle) EndMove(move_status);
}

void FakeFranka::ReceivedDatagram(std::uint16_t, std::uint16_t, std::span<const std::byte> bytes) {
  const std::size_t size = panda() ? sizeof(fci::PandaCommand) : sizeof(fci::Research3Command);
  if (bytes.size() != size) return Log("command of " + std::to_string(bytes.size()) + " bytes");
  if (lose_commands_ > 0) {
    --lose_commands_;
    return;
  }
  fci::PandaCommand command;
  std::memcpy(&command, bytes.data(), sizeof command);
  // The robot ignores a command that is too late for its millisecond.
  if (command.message_id != message_id_) return;
  if (has_command_) return Log("two commands for one state");
  command_ = command;
  has_command_ = true;
  if (phase_ == Phase::kMoving && on_command) on_command(command);
}

bool FakeFranka::Waits() {
  if (!options_.patient || phase_ != Phase::kMoving || has_command_) return false;
  // Before its first command, a client reads one or two states.
  if (!heard_command_) return false;
  return ++waited_ < kPatience;
}

void FakeFranka::Step(Mechanics* mechanics) {
  ++steps_;
  if (frozen_) {
    mechanics->command.setZero(7);
    return;
  }
  const FrankaJoints q = FrankaJointsOf(mechanics->sample.q);
  const bool waits = Waits();
  if (!waits) {
    waited_ = 0;
    Advance(q);
  }
  FrankaJoints v = phase_ == Phase::kMoving ? motion_.v() : Braked();
  if (waits) v = {};
  mechanics->command.resize(7);
  for (std::size_t i = 0; i < 7; ++i) {
    const double pull =
        phase_ == Phase::kMoving ? kStiffness * (motion_.q()[i] - v[i] * kMillisecond - q[i]) : 0;
    mechanics->command[static_cast<int>(i)] = obeyed_[i] = v[i] + pull;
  }
  if (client_port_ == 0) return;
  if (!waits) SendState(mechanics->sample);
  for (; !queue_.empty() && queue_.front().first <= steps_; queue_.pop_front())
    wire().SendDatagram(fci::kPort, client_port_, queue_.front().second);
}

// Lets one millisecond of the robot's time pass.
void FakeFranka::Advance(const FrankaJoints& q) {
  if (phase_ == Phase::kMoving) TakeCommand();
  if (phase_ == Phase::kStarting && !forget_start_ && --starting_ <= 0) {
    phase_ = Phase::kMoving;
    mode_ = RobotMode::kMove;
    motion_.Begin(q);
    heard_command_ = false;
    successes_.set();
    Log("motion begins");
  }
  has_command_ = false;
  ++message_id_;
}

void FakeFranka::TakeCommand() {
  if (!has_command_ && !heard_command_ && options_.patient) return;
  successes_ <<= 1;
  successes_[0] = has_command_;
  if (!has_command_) {
    ++lost_;
    if (const auto wrong = motion_.Miss(); wrong.any()) Abort(wrong);
    return;
  }
  heard_command_ = true;
  FrankaJoints v;
  std::memcpy(v.data(), command_.dq_c, sizeof v);
  if (!std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); })) {
    Log("not a number");
    mode_ = RobotMode::kIdle;
    return EndMove(NumbersOf(options_.version).input);
  }
  if (const auto wrong = motion_.Take(v); wrong.any()) return Abort(wrong);
  if (command_.motion_generation_finished == 0 || forget_end_) return;
  // The arm must be able to stop in a single step.
  if (const auto wrong = motion_.Take({}); wrong.any()) return Abort(wrong);
  mode_ = RobotMode::kIdle;
  EndMove(0);
}

FrankaJoints FakeFranka::Braked() {
  for (double& v : braking_)
    v = std::copysign(std::max(0.0, std::abs(v) - kBraking * kMillisecond), v);
  return braking_;
}

bool FakeFranka::Do(const std::string& what) {
  std::istringstream words(what);
  std::string verb, object;
  int count = 1;
  words >> verb >> object >> count;
  const Numbers& n = NumbersOf(options_.version);
  if (what == "user stop") return Enter(RobotMode::kUserStopped, n.emergency), true;
  if (what == "emergency stop") return Enter(RobotMode::kOther, n.emergency), braking_ = {}, true;
  if (what == "release") return errors_.reset(), mode_ = RobotMode::kIdle, true;
  if (what == "guide") return Enter(RobotMode::kGuiding, n.aborted), true;
  if (what == "freeze") return frozen_ = true;
  if (what == "say it moves") return says_it_moves_ = true;
  if (what == "continue") return frozen_ = false, true;
  if (what == "patient") return options_.patient = true;
  if (what == "repeat state") return repeat_ = true;
  if (what == "replay state") return replay_ = true;
  if (what == "swap states") return swap_ = true;
  if (what == "cut state") return cut_ = true;
  if (what == "spoil state") return spoil_ = true;
  if (what == "leap") return leap_ = true;
  if (what == "no start") return forget_start_ = true;
  if (what == "no end") return forget_end_ = true;
  if (verb == "lose" && object == "states") return lose_states_ = count, true;
  if (verb == "lose" && object == "commands") return lose_commands_ = count, true;
  if (verb == "start" && object == "late") return start_delay_ = count, true;
  if (verb == "delay" && object == "states") return delay_ = static_cast<unsigned>(count), true;
  if (what == "moved") return mode_ = RobotMode::kMove, true;
  if (what == "forget") return phase_ = Phase::kIdle, mode_ = RobotMode::kIdle, true;
  if (what == "babble") return wire().Send(link_, Bytes(sizeof(fci::Header))), true;
  if (what == "answer another") {
    fci::Header another = move_;
    another.id += 1000;
    return AnswerStatus(another, 0), true;
  }
  if (verb == "answer") return EndMove(std::stoi(object)), true;
  if (what == "drop link" && link_ != 0) {
    const int link = link_;
    wire().Close(link);
    return Closed(link), true;
  }
  if (verb == "error" && ErrorPlace(object) >= 0)
    return errors_.set(static_cast<std::size_t>(ErrorPlace(object))), true;
  if (verb != "reflex" || ErrorPlace(object) < 0) return false;
  Abort(std::bitset<41>().set(static_cast<std::size_t>(ErrorPlace(object))));
  return true;
}

}  // namespace predictor
