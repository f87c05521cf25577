// A Franka arm's driver in front of its fake, by virtual time.
#pragma once

#include <memory>
#include <vector>

#include "devices/franka/franka_arm.h"
#include "fakes/franka/fake_franka.h"
#include "fakes/memory_network.h"

namespace predictor {

class FrankaRig {
 public:
  explicit FrankaRig(const FakeFrankaOptions& options = {}) : fake(options) {
    mechanics.sample.q.resize(7);
    mechanics.sample.q << 0.1, -0.6, 0.2, -2.0, 0.1, 1.8, 0.3;
    mechanics.sample.v.setZero(7);
    mechanics.sample.F_S_raw << 1, 2, 3, 0.1, 0.2, 0.3;
    network.Add(kHost, &fake, &mechanics);
    // Joints that do at once what they are told.
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

  // A tick of the run: a millisecond, then Read and Write. What they reported.
  bool Tick(bool motion = true) {
    network.Pass(1e-3);
    read = arm->Read(&reading);
    written = arm->Write(v, motion);
    return read.ok() && written.ok();
  }
  // The last that was reported.
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
