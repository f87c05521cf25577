// The controller of a Franka arm, as its client sees it. The arm is a Research 3 (interface version
// 10) or a Panda (interface version 5). The packets are defined in src/devices/franka/packets.h.
// The behaviour, limits and errors are defined independently of the driver. Some tests also connect
// third-party clients to this fake.
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
  bool early = false;  // a Research 3 without accelerometers
  Pose X_FS;           // pose of the sensor in the flange
  std::uint64_t first_message = 1;
  // If true, the robot's time stops during a motion until the next command has arrived. This option
  // is for use with sockets. With this option, a client on a busy computer loses no command.
  bool patient = false;
  double payload = 0;                   // mass of the end-effector in Desk [kg]
  std::array<double, 3> payload_cog{};  // in the flange [m]
  double flange = 0.107;                // from the last joint to the flange [m]
};

inline FakeFrankaOptions FrankaOfVersion(std::uint16_t version) {
  FakeFrankaOptions options;
  options.version = version;
  return options;
}

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

  // General: "user stop", "emergency stop", "release", "guide", "reflex NAME" (libfranka's name, or
  //   the index in a state's errors), "error NAME" (without a change of mode), "moved" (by another
  //   program), "freeze" and "continue", "drop link", "patient", "say it moves".
  // States: "lose states N", "delay states N" (by N ms, from now on), "repeat state", "replay
  //   state" (the same one permanently), "swap states" (the next two), "cut state", "spoil state"
  //   (NaN), "leap" (a number far ahead).
  // Commands: "lose commands N".
  // Motions: "start late N" (N ms after the request, from now on); "no start" and "no end" (the arm
  // does not begin or end motions); "forget" (a motion ends without an answer); "answer BYTE" (an
  // end
  //   without a request); "answer another" (the answer to a different request); "babble" (an
  //   invalid answer).
  bool Do(const std::string& what) override;

  fci::RobotMode mode() const { return mode_; }
  const MotionCheck& motion() const { return motion_; }
  std::uint64_t lost_commands() const { return lost_; }
  double collision_force() const { return collision_force_; }  // latest setting [N]
  // Receives each joint velocity command that arrived in time.
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
  Bytes received_;                 // start of an incomplete request from the stream
  std::uint16_t client_port_ = 0;  // 0: no client

  std::uint64_t message_id_;
  fci::RobotMode mode_ = fci::RobotMode::kIdle;
  std::bitset<41> errors_, reflex_reason_;
  Phase phase_ = Phase::kIdle;
  int start_delay_ = 3;  // from Move to the first state in motion [ms]
  int starting_ = 0;     // milliseconds until a motion begins
  fci::Header move_{};   // current request
  MotionCheck motion_;
  bool heard_command_ = false;  // in the current motion
  bool has_command_ = false;    // for the latest state
  fci::PandaCommand command_{};
  std::bitset<100> successes_;
  std::uint64_t lost_ = 0;
  double collision_force_ = 0;
  int waited_ = 0;
  FrankaJoints obeyed_{};   // latest velocities of the joints
  FrankaJoints braking_{};  // velocities while no motion is active

  bool says_it_moves_ = false, frozen_ = false, forget_start_ = false, forget_end_ = false;
  bool repeat_ = false, replay_ = false, swap_ = false, cut_ = false, spoil_ = false, leap_ = false;
  int lose_states_ = 0, lose_commands_ = 0;
  std::uint64_t delay_ = 0, steps_ = 0;
  Bytes last_state_, held_back_;
  std::deque<std::pair<std::uint64_t, Bytes>> queue_;  // each with the step at which it is due
};

}  // namespace predictor
