// A driver, a fake controller, and an arm that follows without delay, in virtual time.
#pragma once

#include <memory>
#include <string>

#include "devices/ur/ur_arm.h"
#include "devices/ur_proxy.h"
#include "fakes/memory_network.h"
#include "fakes/ur/fake_ur.h"

namespace predictor {

inline constexpr const char* kUrHost = "192.0.2.10";

inline FakeUrOptions Cb3(int phase = 0) { return {{3, 14, 3, 1025}, phase}; }
inline FakeUrOptions ESeries(int phase = 0) { return {{5, 12, 0, 1101319}, phase}; }

struct UrBench {
  FakeUr fake;
  Mechanics mechanics;
  MemoryNetwork network;
  ProxyNetwork proxy{&network};
  std::unique_ptr<Arm> arm;
  ArmReading reading;
  Status read, written;

  explicit UrBench(const FakeUrOptions& options = {}) : fake(options) {
    mechanics.sample.q = JointVector::Zero(kUrJoints);
    mechanics.sample.v = JointVector::Zero(kUrJoints);
    network.Add(kUrHost, &fake, &mechanics);
    network.SetWorld([this] {
      mechanics.sample.q += 0.001 * mechanics.command;
      mechanics.sample.v = mechanics.command;
    });
  }
  UrBench(const UrBench&) = delete;

  UrBench& Connect(const UrOptions& options = {.host = kUrHost}) {
    arm = ConnectUr(options, &network);
    return *this;
  }
  UrBench& ConnectThroughProxy() {
    arm = ConnectUr({.host = kUrHost}, &proxy);
    through_proxy_ = true;
    return *this;
  }

  // Performs a tick and then waits for the millisecond until the next one.
  void Tick(const JointVector& v, bool motion) {
    read = arm->Read(&reading);
    written = arm->Write(v, motion);
    Pass();
  }
  void Tick(double v, bool motion = true) { Tick(JointVector::Constant(kUrJoints, v), motion); }
  void Ticks(int n, double v, bool motion = true) {
    for (int i = 0; i < n; ++i) Tick(v, motion);
  }
  void Pass() { through_proxy_ ? proxy.Wait(0.001) : network.Pass(0.001); }
  double speed() const { return mechanics.command[0]; }

 private:
  bool through_proxy_ = false;
};

}  // namespace predictor
