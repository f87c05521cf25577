// Sets up a Universal Robots arm before the driver can control it.
#pragma once

#include <memory>

#include "devices/arm.h"
#include "devices/ur/rtde_connection.h"
#include "devices/ur/ur_arm.h"
#include "devices/ur/ur_state.h"

namespace predictor {

struct UrSetup {
  std::unique_ptr<rtde::Connection> connection;
  std::unique_ptr<Stream> dashboard;  // null if the robot has none
  DeviceFacts facts;
  int outputs = 0, inputs = 0;  // IDs of the recipes
  UrExtras extras;              // optional fields of the outputs
  double write_period = 0;      // [s]
  std::int32_t counter = 0;     // last counter value that our program has received
  UrState state;                // the last state
};

// The parameters and the errors are the same as for ConnectUr.
UrSetup SetUpUr(const UrOptions& options, Network* network);

// Encodes the packet that sends UrInputs, without using the heap.
std::span<const std::byte> UrCommand(rtde::PacketWriter* writer, int recipe, const UrVector& qd,
                                     std::int32_t counter, bool follow) noexcept;

}  // namespace predictor
