// A second way to stop an arm, which a process other than the loop can use.
#pragma once

#include <memory>
#include <string>

#include "devices/wire/network.h"
#include "scenario/machine.h"

namespace predictor {

class StopChannel {
 public:
  // kSilent means that the peer has stopped sending, although it may still receive. kLost means
  // that the connection is permanently lost.
  enum class Link { kTalks, kSilent, kLost };

  virtual ~StopChannel() = default;
  // Keeps the connection alive. Call this at least ten times per second.
  virtual Link Tend() noexcept = 0;
  // Returns false if the connection is lost.
  virtual bool Stop() noexcept = 0;
};

// Opens a stop channel to a UR at its program port. To stop the arm, the channel sends a program
// that only brakes. This program replaces the running program. Returns null for a robot that
// accepts only one client (Franka), because such a robot stops by itself when its client is silent.
// Throws DeviceError. `network` must outlive the channel.
std::unique_ptr<StopChannel> OpenStopChannel(const ArmConnection& arm, Network* network);

}  // namespace predictor
