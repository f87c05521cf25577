// Parses any datagram as a reading of a force/torque sensor. An accepted datagram must be
// reproduced when it is written again.
#include "devices/net_ft/rdt.h"

#include <cstdlib>

#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto same = [&](const auto& again) {
    if (!std::equal(bytes.begin(), bytes.end(), again.begin(), again.end())) std::abort();
  };
  if (const auto record = predictor::rdt::DecodeRecord(bytes))
    same(predictor::rdt::Encode(*record));
  if (const auto request = predictor::rdt::DecodeRequest(bytes))
    same(predictor::rdt::Encode(*request));
  return 0;
}
