// Parses any datagram as a state of a Franka arm, in each version of the interface.
#include "devices/franka/fci.h"

#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  for (const std::uint16_t version :
       {predictor::fci::kPandaVersion, predictor::fci::kResearch3Version, std::uint16_t{7}}) {
    predictor::fci::RobotState state;
    (void)predictor::fci::Decode(version, bytes, &state);
  }
  return 0;
}
