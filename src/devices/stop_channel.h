// A second way to stop an arm, for a process that is not the loop.
#pragma once

#include <memory>
#include <string>

#include "devices/wire/network.h"
#include "scenario/machine.h"

namespace predictor {

class StopChannel {
 public:
  // kSilent: it says nothing, though it always does; it may still hear. kLost: for good.
  enum class Link { kTalks, kSilent, kLost };

  virtual ~StopChannel() = default;
  // Keeps the connection alive; from time to time, at least ten times a second.
  virtual Link Tend() noexcept = 0;
  // False if the connection is gone.
  virtual bool Stop() noexcept = 0;
};

// UR: its program port, where a program of ours that only brakes takes the place of the running
// one. Null: the robot takes one client only (Franka), and stops by itself when that is silent.
// Throws DeviceError. `network` outlives it.
std::unique_ptr<StopChannel> OpenStopChannel(const ArmConnection& arm, Network* network);

}  // namespace predictor
