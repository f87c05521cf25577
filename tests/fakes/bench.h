// A whole system in virtual time: emulator and drivers on one side, faults on the wires, fakes and
// their rig on the other, and a person at the console.
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
  std::string scenario;                                 // file
  std::array<std::string, kHands> arms = {"ur", "ur"};  // kinds of fakes; "" an absent side
  std::array<std::string, kHands> sensors;              // the same; "": the arm's own
  std::array<FakeOptions, kHands> arm_options, sensor_options;
  std::uint64_t seed = 1;
  std::function<void(Scenario*)> change;  // of the scenario, on both sides of the wire
  std::function<void(Scenario*)> truth;   // of the far end alone: what the program does not know
  std::function<void(Machine*)> machine;  // of the machine that the fakes make up
  std::function<void(std::array<JointVector, kHands>*)> start;  // of where the arms are parked
};

// What was written to an arm's controller: a piece of a stream, or a datagram.
struct Sent {
  std::uint64_t time;  // [ns]
  int hand;
  Bytes bytes;
};

// From when on a run was in a state, and where its arms were then: at each change, and now and
// then.
struct RunStage {
  std::uint64_t time;  // [ns]
  RunState state;
  std::array<JointVector, kHands> q;  // [rad]
};

// What a run of the bench shows of a stop.
struct BenchStop {
  StopCause cause = StopCause::kNone;
  RunState end = RunState::kInit;  // HELD, UNPOWERED
  int ticks = -1;                  // from the fault to the decision
  int off = -1;                    // from the fault until power was asked to be cut; -1: it was not
  double time = 0;                 // from the decision until the true handles rest [s]
  double distance = 0;             // of the handle that went further meanwhile [m]
  double drift = 0, turn = 0;      // of the handles' relative pose, from then to rest [m], [rad]
  double apart = 0;                // the most that they were apart on the way [m]
  std::uint64_t decided = 0, rested = 0;  // times of it; 0: not [ns]
  std::array<JointVector, kHands> q;      // as it was decided [rad]
};

class Bench {
 public:
  static std::string HostOf(int hand) { return hand == 0 ? "192.0.2.10" : "192.0.2.11"; }
  static std::string SensorHostOf(int hand) { return hand == 0 ? "192.0.2.20" : "192.0.2.21"; }

  // Throws what connecting throws.
  explicit Bench(const BenchOptions& options);

  // A millisecond; the loop missed so many before it.
  void Tick(int missed = 0);
  void Pass(double time);
  // The far end goes on, the loop does not [s].
  void Hang(double time) { memory_->Pass(time); }
  // Sees each record from now on.
  void Watch(std::function<void(const TickRecord&)> look) { look_ = std::move(look); }
  // The person keeps the key held from now on, or not.
  void Hold(bool key) { holds_ = key; }
  // Ticks until the run is in this state. False if it is not within `patience` [s].
  bool Await(RunState state, double patience);
  // ALIGN, ARMED, RUN, as a person asks for them. False if it does not come to that.
  bool Start();
  // Until the arms rest after a stop, or `patience` [s]; `fault`: tick of it.
  BenchStop AwaitStop(std::uint64_t fault, double patience);

  Emulator& emulator() { return *emulator_; }
  const RealDevice& device() const { return *device_; }
  FakeDevice& arm(int hand) { return *arms_[static_cast<std::size_t>(hand)]; }
  FakeDevice& sensor(int hand) { return *sensors_[static_cast<std::size_t>(hand)]; }
  WireFaults& wire(int hand) { return *faulty_->Of(HostOf(hand)); }
  WireFaults& sensor_wire(int hand) { return *faulty_->Of(SensorHostOf(hand)); }
  FarRig& rig() { return *rig_; }
  // As a process of its own would reach the devices: without the faults of our wires.
  Network& network() { return *memory_; }
  std::uint64_t now() const { return memory_->Now(); }  // [ns]
  // From now on what is written to arms is kept, and the stages of the run.
  void Capture() { captures_ = true; }
  const std::vector<Sent>& sent() const { return sent_; }
  const std::vector<RunStage>& stages() const { return stages_; }
  // Forgets what was written longer than `time` ago [s].
  void Forget(double time);
  const Scenario& scenario() const { return emulator_->scenario(); }
  const TickRecord& record() const { return emulator_->record(); }

 private:
  class Shared;  // the emulator owns its network, the bench keeps it
  std::unique_ptr<RealDevice> Connect(const Scenario& scenario, const BenchOptions& options);

  std::unique_ptr<FarRig> rig_;
  std::unique_ptr<MemoryNetwork> memory_;
  std::array<std::unique_ptr<FakeDevice>, kHands> arms_, sensors_;
  std::unique_ptr<FaultyNetwork> faulty_;
  const RealDevice* device_ = nullptr;
  std::array<Pose, kHands> Handles() const;
  void FollowStop();
  void FollowStages();

  BenchStop stop_;              // the one under way, or the last
  std::uint64_t decision_ = 0;  // tick of it
  std::uint64_t off_ = 0;       // tick in which power was asked to be cut; 0: it was not
  std::array<Pose, kHands> begin_, last_;
  std::array<double, kHands> way_ = {};  // [m]
  std::vector<Sent> sent_;
  std::vector<RunStage> stages_;
  bool captures_ = false;
  std::function<void(const TickRecord&)> look_;
  bool holds_ = false;
  int ticks_ = 0;
  std::unique_ptr<Emulator> emulator_;  // goes first: its drivers say good-bye to all the above
};

}  // namespace predictor
