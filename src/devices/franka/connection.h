// Opens the connection to a Franka arm. The function blocks, and the errors that it throws state a
// remedy.
#pragma once

#include <memory>

#include "devices/franka/franka_arm.h"

namespace predictor::fci {

struct Connection {
  std::uint16_t version = 0;
  std::unique_ptr<Stream> stream;
  std::unique_ptr<Datagrams> datagrams;
  std::uint32_t next_id = 0;   // next ID of a request
  std::size_t state_size = 0;  // size of a state datagram
  RobotState state;            // the first state received
};

// Throws DeviceError.
Connection Connect(const FrankaOptions& options, Network* network);

}  // namespace predictor::fci
