// A whole system in virtual time that transfers bytes only between ticks, so that a tick contains
// only the program's own work and allocations. The system consists of fakes on a rig, faults on the
// wires, drivers, an emulator, and a person who holds the key.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "emulator/emulator.h"
#include "fakes/far_rig.h"
#include "fakes/faulty_network.h"
#include "fakes/held_network.h"
#include "fakes/memory_network.h"
#include "scenario/machine.h"

namespace predictor {

struct HeldSystemOptions {
  std::string scenario;             // file name
  std::array<std::string, 2> arms;  // kinds of fakes
  std::array<bool, 2> net_ft{};     // whether the sensors are separate ones
};

class HeldSystem {
 public:
  // Throws the same exceptions as ConnectMachine.
  explicit HeldSystem(const HeldSystemOptions& options);

  // Lets the millisecond before a tick pass, and also the milliseconds of the ticks that were
  // missed before it.
  void Between(int missed = 0);
  void Tick(int missed = 0) {
    Between(missed);
    emulator_->Tick(memory_.Now(), missed);
  }
  // Goes through ALIGN and ARMED to RUN. Returns false if RUN is not reached.
  bool Start();

  Emulator& emulator() { return *emulator_; }
  FakeDevice& arm(int hand) { return *arms_[static_cast<std::size_t>(hand)]; }
  FakeDevice& sensor(int hand) { return *sensors_[static_cast<std::size_t>(hand)]; }
  WireFaults& wire(int hand) { return *faulty_.Of(Host(10 + hand)); }
  WireFaults& sensor_wire(int hand) { return *faulty_.Of(Host(20 + hand)); }
  FarRig& rig() { return *rig_; }
  std::uint64_t now() const { return memory_.Now(); }

 private:
  static std::string Host(int last) { return "192.0.2." + std::to_string(last); }
  MachineArm Hang(const ArmSpec& arm, int hand, const HeldSystemOptions& options);
  bool Await(RunState state, int ticks);

  std::unique_ptr<FarRig> rig_;
  MemoryNetwork memory_;
  std::array<std::unique_ptr<FakeDevice>, 2> arms_, sensors_;
  FaultyNetwork faulty_{&memory_, 1};
  HeldNetwork* held_ = nullptr;  // owned by the emulator's device
  std::unique_ptr<Emulator> emulator_;
  int ticks_ = 0;
};

}  // namespace predictor
