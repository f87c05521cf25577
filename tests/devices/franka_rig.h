// A Franka driver connected to its fake, in virtual time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "devices/franka/franka_arm.h"
#include "devices/franka/packets.h"
#include "fakes/franka/fake_franka.h"
#include "fakes/memory_network.h"

namespace predictor {

// Returns the name of the controller with this protocol version, for test names.
inline std::string ControllerName(std::uint16_t version) {
  return version == fci::kPandaVersion ? "Panda" : "Research3";
}

class FrankaRig {
 public:
  explicit FrankaRig(const FakeFrankaOptions& options = {}) : fake(options) {
    mechanics.sample.q.resize(7);
    mechanics.sample.q << 0.1, -0.6, 0.2, -2.0, 0.1, 1.8, 0.3;
    mechanics.sample.v.setZero(7);
    mechanics.sample.F_S_raw << 1, 2, 3, 0.1, 0.2, 0.3;
    network.Add(kHost, &fake, &mechanics);
    // The joints follow commands without delay.
    network.SetWorld([this] {
      mechanics.sample.q += 1e-3 * mechanics.command;
      mechanics.sample.v = mechanics.command;
    });
  }

  FrankaOptions options() const {
    FrankaOptions options;
    options.host = kHost;
    return options;
  }
  void Connect() { Connect(options()); }
  void Connect(const FrankaOptions& options) {
    arm = ConnectFranka(options, &network);
    v.setZero(7);
    Tick(false);
  }

  // Performs one tick, which takes a millisecond: Read, then Write. Returns whether both succeeded.
  bool Tick(bool motion = true) {
    network.Pass(1e-3);
    read = arm->Read(&reading);
    written = arm->Write(v, motion);
    return read.ok() && written.ok();
  }
  // Returns the result of the last tick.
  bool Ticks(int count, bool motion = true) {
    bool ok = true;
    for (int i = 0; i < count; ++i) ok = Tick(motion);
    return ok;
  }

  static constexpr const char* kHost = "192.0.2.10";
  FakeFranka fake;
  Mechanics mechanics;
  MemoryNetwork network;
  std::unique_ptr<FrankaArm> arm;
  JointVector v;
  ArmReading reading;
  Status read, written;
};

}  // namespace predictor
