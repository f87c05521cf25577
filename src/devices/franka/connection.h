// The beginning of a Franka arm's connection: blocks, and throws what a person can act on.
#pragma once

#include <memory>

#include "devices/franka/franka_arm.h"

namespace predictor::fci {

struct Connection {
  std::uint16_t version = 0;
  std::unique_ptr<Stream> stream;
  std::unique_ptr<Datagrams> datagrams;
  std::uint32_t next_id = 0;   // of requests
  std::size_t state_size = 0;  // of datagrams
  RobotState state;            // the first one
};

// Throws DeviceError.
Connection Connect(const FrankaOptions& options, Network* network);

}  // namespace predictor::fci
