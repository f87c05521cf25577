// Everything that comes before an arm of Universal Robots can be followed.
#pragma once

#include <memory>

#include "devices/arm.h"
#include "devices/ur/rtde_connection.h"
#include "devices/ur/ur_arm.h"
#include "devices/ur/ur_state.h"

namespace predictor {

struct UrSetup {
  std::unique_ptr<rtde::Connection> connection;
  std::unique_ptr<Stream> dashboard;  // null if there is none
  DeviceFacts facts;
  int outputs = 0, inputs = 0;  // numbers of the recipes
  UrExtras extras;              // of the outputs
  double write_period = 0;      // [s]
  std::int32_t counter = 0;     // as our program has seen it last
  UrState state;                // the last
};

// As ConnectUr.
UrSetup SetUpUr(const UrOptions& options, Network* network);

// A package of UrInputs. Takes nothing from the heap.
std::span<const std::byte> UrCommand(rtde::PacketWriter* writer, int recipe, const UrVector& qd,
                                     std::int32_t counter, bool follow) noexcept;

}  // namespace predictor
