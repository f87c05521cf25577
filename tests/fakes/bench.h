// A whole system in virtual time: emulator and drivers on one side, faults on the wires, fakes and
// their rig on the other, and a person at the console.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "devices/real_device.h"
#include "emulator/emulator.h"
#include "fakes/far_rig.h"
#include "fakes/faulty_network.h"
#include "fakes/memory_network.h"

namespace predictor {

struct BenchOptions {
  std::string scenario;                                 // file
  std::array<std::string, kHands> arms = {"ur", "ur"};  // kinds of fakes; "" an absent side
  std::array<std::string, kHands> sensors;              // the same; "": the arm's own
  std::uint64_t seed = 1;
};

// What a run of the bench shows of a stop.
struct BenchStop {
  StopCause cause = StopCause::kNone;
  RunState end = RunState::kInit;  // HELD, UNPOWERED
  int ticks = -1;                  // from the fault to the decision
  double time = 0;                 // from the decision until the true handles rest [s]
  double distance = 0;             // of the handle that went further meanwhile [m]
  double drift = 0, turn = 0;      // of the handles' relative pose meanwhile [m], [rad]
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
  const TickRecord& record() const { return emulator_->record(); }

 private:
  class Shared;  // the emulator owns its network, the bench keeps it
  std::unique_ptr<RealDevice> Connect(const Scenario& scenario, const BenchOptions& options);

  std::unique_ptr<FarRig> rig_;
  std::unique_ptr<MemoryNetwork> memory_;
  std::array<std::unique_ptr<FakeDevice>, kHands> arms_, sensors_;
  std::unique_ptr<FaultyNetwork> faulty_;
  const RealDevice* device_ = nullptr;
  std::unique_ptr<Emulator> emulator_;
  std::function<void(const TickRecord&)> look_;
  bool holds_ = false;
  int ticks_ = 0;
};

}  // namespace predictor
