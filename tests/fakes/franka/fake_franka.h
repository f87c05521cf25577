// A Franka arm's control as its client sees it: Research 3 (interface version 10) or Panda (5).
// What passes is that of src/devices/franka/packets.h; what it does with it, its limits and its
// errors are written down apart from the driver, and other makers' clients drive it in tests.
#pragma once

#include <bitset>
#include <cstring>
#include <deque>
#include <functional>

#include "devices/franka/fci.h"
#include "fakes/far_end.h"
#include "fakes/franka/motion_check.h"

namespace predictor {

struct FakeFrankaOptions {
  std::uint16_t version = fci::kResearch3Version;
  bool early = false;  // Research 3 before accelerometers
  Pose X_FS;           // of the sensor in the flange
  std::uint64_t first_message = 1;
  // Beside sockets: the robot's time stands still until a motion's next command is there, so that a
  // client that the machine does not let run in time loses none.
  bool patient = false;
  double payload = 0;                   // that Desk was told of the end-effector [kg]
  std::array<double, 3> payload_cog{};  // in the flange [m]
  double flange = 0.107;                // from its last joint to its flange [m]
};

template <class T>
Bytes AsBytes(const T& value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

class FakeFranka final : public FakeDevice {
 public:
  explicit FakeFranka(const FakeFrankaOptions& options = {});

  std::vector<std::uint16_t> tcp_ports() const override { return {fci::kPort}; }
  std::vector<std::uint16_t> udp_ports() const override { return {fci::kPort}; }
  void Opened(int link, std::uint16_t port) override;
  void Received(int link, std::span<const std::byte> bytes) override;
  void Closed(int link) override;
  void ReceivedDatagram(std::uint16_t port, std::uint16_t from,
                        std::span<const std::byte> bytes) override;
  void Step(Mechanics* mechanics) override;

  // "user stop", "emergency stop", "release", "guide", "reflex NAME" (as libfranka names it, or its
  // place in a state's errors), "error NAME" (that changes no mode), "moved" (by another program),
  // "freeze" and "go on", "drop link", "patient", "say it moves". Of states to come: "lose states
  // N", "delay states N" (by N ms, from now on), "repeat state", "replay state" (the same for
  // ever), "swap states" (the next two), "cut state", "spoil state" (not a number), "leap" (its
  // number is far off). Of commands: "lose commands N". Of motions: "start late N" (N ms after it
  // was asked for, from now on); "no start" and "no end": it forgets to begin or end them;
  // "forget": one ends without an answer; "answer BYTE": an end that nobody asked for; "answer
  // another": to a request that nobody made; "babble": no answer at all.
  bool Do(const std::string& what) override;

  fci::RobotMode mode() const { return mode_; }
  const MotionCheck& motion() const { return motion_; }
  std::uint64_t lost_commands() const { return lost_; }
  double collision_force() const { return collision_force_; }  // as it was told last [N]
  // Called with each joint velocity command that it heard in time.
  std::function<void(const fci::PandaCommand&)> on_command;

 private:
  enum class Phase { kIdle, kStarting, kMoving };

  bool panda() const { return options_.version == fci::kPandaVersion; }
  void Handle(const fci::Header& header, std::span<const std::byte> body);
  void Answer(const fci::Header& header, std::span<const std::byte> body);
  bool SetCollision(std::span<const std::byte> body);
  void AnswerStatus(const fci::Header& header, int status);
  void Greet(const fci::Header& header, std::span<const std::byte> body);
  void Move(const fci::Header& header, std::span<const std::byte> body);
  void Stop(const fci::Header& header);
  void Recover(const fci::Header& header);
  void EndMove(int status);
  void Abort(std::bitset<41> errors);
  void Enter(fci::RobotMode mode, int move_status);
  bool Waits();
  void Advance(const FrankaJoints& q);
  void TakeCommand();
  FrankaJoints Braked();
  void SendState(const ArmSample& sample);
  template <class Packet>
  Bytes State(const ArmSample& sample) const;
  template <class Real>
  void FillWrench(const ArmSample& sample, fci::Signals<Real>* signals) const;
  void Queue(Bytes state);

  FakeFrankaOptions options_;
  int link_ = 0;
  Bytes received_;                 // of the stream, not yet a whole request
  std::uint16_t client_port_ = 0;  // 0: no client

  std::uint64_t message_id_;
  fci::RobotMode mode_ = fci::RobotMode::kIdle;
  std::bitset<41> errors_, reflex_reason_;
  Phase phase_ = Phase::kIdle;
  int start_delay_ = 3;  // between Move and the state that says that it moves [ms]
  int starting_ = 0;     // milliseconds until a motion begins
  fci::Header move_{};   // the request that goes on
  MotionCheck motion_;
  bool heard_command_ = false;  // in this motion
  bool has_command_ = false;    // for the last state
  fci::PandaCommand command_{};
  std::bitset<100> successes_;
  std::uint64_t lost_ = 0;
  double collision_force_ = 0;
  int waited_ = 0;
  FrankaJoints obeyed_{};   // velocities that the joints were told last
  FrankaJoints braking_{};  // the same while no motion goes on

  bool says_it_moves_ = false, frozen_ = false, forget_start_ = false, forget_end_ = false;
  bool repeat_ = false, replay_ = false, swap_ = false, cut_ = false, spoil_ = false, leap_ = false;
  int lose_states_ = 0, lose_commands_ = 0;
  std::uint64_t delay_ = 0, steps_ = 0;
  Bytes last_state_, held_back_;
  std::deque<std::pair<std::uint64_t, Bytes>> queue_;  // due at a step
};

}  // namespace predictor
