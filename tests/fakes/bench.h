// A whole system in virtual time: the emulator with its drivers, fakes on their rig, faults on the
// wires between them, and a person at the console.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "devices/real_device.h"
#include "emulator/emulator.h"
#include "fakes/far_rig.h"
#include "fakes/faulty_network.h"
#include "fakes/kinds.h"
#include "fakes/memory_network.h"
#include "scenario/machine.h"

namespace predictor {

struct BenchOptions {
  std::string scenario;                                 // file name
  std::array<std::string, kHands> arms = {"ur", "ur"};  // kinds of fakes; "" for an absent side
  std::array<std::string, kHands> sensors;              // kinds of fakes; "" for the arm's sensor
  std::array<FakeOptions, kHands> arm_options, sensor_options;
  std::uint64_t seed = 1;
  std::function<void(Scenario*)> change;  // changes the scenario on both sides of the wire
  std::function<void(Scenario*)> truth;   // changes the fakes' side alone, unknown to the program
  std::function<void(Machine*)> machine;  // changes the machine file for the fakes
  // changes the pose in which the arms are parked
  std::function<void(std::array<JointVector, kHands>*)> start;
};

// Bytes that were written to an arm's controller. The bytes are a part of a stream or a datagram.
struct Sent {
  std::uint64_t time;  // [ns]
  int hand;
  Bytes bytes;
};

// The state of the run and the joint angles at one time. A stage is added at each change of state
// and at regular intervals.
struct RunStage {
  std::uint64_t time;  // [ns]
  RunState state;
  std::array<JointVector, kHands> q;  // [rad]
};

// The result of a stop on the bench.
struct BenchStop {
  StopCause cause = StopCause::kNone;
  RunState end = RunState::kInit;  // HELD or UNPOWERED
  int ticks = -1;                  // from the fault to the decision
  int off = -1;                    // from the fault to the power-off request; -1: none
  double time = 0;                 // from the decision until the true handles rest [s]
  double distance = 0;             // distance of the handle that moved farther [m]
  double drift = 0, turn = 0;      // change of the handles' relative pose until rest [m], [rad]
  double apart = 0;                // largest change of their distance during the stop [m]
  std::uint64_t decided = 0, rested = 0;  // times of decision and rest; 0: not yet [ns]
  std::array<JointVector, kHands> q;      // at the decision [rad]
};

class Bench {
 public:
  static std::string HostOf(int hand) { return hand == 0 ? "192.0.2.10" : "192.0.2.11"; }
  static std::string SensorHostOf(int hand) { return hand == 0 ? "192.0.2.20" : "192.0.2.21"; }

  // Throws the same exceptions as ConnectMachine.
  explicit Bench(const BenchOptions& options);

  // Performs one tick. `missed` is the number of ticks that the loop missed immediately before.
  void Tick(int missed = 0);
  void Pass(double time);
  // Lets time pass for the devices while the loop hangs [s].
  void Hang(double time) { memory_->Pass(time); }
  // Registers a function that receives each later record.
  void Watch(std::function<void(const TickRecord&)> look) { look_ = std::move(look); }
  // Sets whether the person holds the key from now on.
  void Hold(bool key) { holds_ = key; }
  // Performs ticks until the run is in this state. Returns false if the run does not reach this
  // state within `patience` [s].
  bool Await(RunState state, double patience);
  // Goes through ALIGN and ARMED to RUN, as a person requests these states. Returns false if the
  // run does not reach RUN.
  bool Start();
  // Waits at most `patience` [s] until the arms rest after a stop. `fault` is the tick of the
  // fault.
  BenchStop AwaitStop(std::uint64_t fault, double patience);

  Emulator& emulator() { return *emulator_; }
  const RealDevice& device() const { return *device_; }
  FakeDevice& arm(int hand) { return *arms_[static_cast<std::size_t>(hand)]; }
  FakeDevice& sensor(int hand) { return *sensors_[static_cast<std::size_t>(hand)]; }
  WireFaults& wire(int hand) { return *faulty_->Of(HostOf(hand)); }
  WireFaults& sensor_wire(int hand) { return *faulty_->Of(SensorHostOf(hand)); }
  FarRig& rig() { return *rig_; }
  // Returns the network that another process uses. The faults of the bench's wires do not affect
  // this network.
  Network& network() { return *memory_; }
  std::uint64_t now() const { return memory_->Now(); }  // [ns]
  // From now on, records the bytes that are written to the arms and the stages of the run.
  void Capture() { captures_ = true; }
  const std::vector<Sent>& sent() const { return sent_; }
  const std::vector<RunStage>& stages() const { return stages_; }
  // Discards the bytes that were written more than `time` ago [s].
  void Forget(double time);
  const Scenario& scenario() const { return emulator_->scenario(); }
  const TickRecord& record() const { return emulator_->record(); }

 private:
  class Shared;  // lets the emulator own a network although the bench owns it
  std::unique_ptr<RealDevice> Connect(const Scenario& scenario, const BenchOptions& options);

  std::unique_ptr<FarRig> rig_;
  std::unique_ptr<MemoryNetwork> memory_;
  std::array<std::unique_ptr<FakeDevice>, kHands> arms_, sensors_;
  std::unique_ptr<FaultyNetwork> faulty_;
  const RealDevice* device_ = nullptr;
  std::array<Pose, kHands> Handles() const;
  void FollowStop();
  void FollowStages();

  BenchStop stop_;              // the current stop, or the last one
  std::uint64_t decision_ = 0;  // tick of its decision
  std::uint64_t off_ = 0;       // tick of the power-off request; 0: none
  std::array<Pose, kHands> begin_, last_;
  std::array<double, kHands> way_ = {};  // [m]
  std::vector<Sent> sent_;
  std::vector<RunStage> stages_;
  bool captures_ = false;
  std::function<void(const TickRecord&)> look_;
  bool holds_ = false;
  int ticks_ = 0;
  std::unique_ptr<Emulator> emulator_;  // destroyed first, because its drivers still use the
                                        // members above
};

}  // namespace predictor
