// Passes arbitrary datagrams to the driver as if a force/torque sensor of either manufacturer had
// sent them.
#include "devices/net_ft/net_ft.h"

#include <cmath>
#include <cstdlib>

#include "devices/net_ft/rdt.h"
#include "fuzz/any_peer.h"
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  predictor::AnyPeer network(std::as_bytes(std::span(data, size)).subspan(1));
  predictor::NetFtOptions options;
  options.make = (data[0] & 1) != 0 ? predictor::NetFtMake::kOnRobot : predictor::NetFtMake::kAti;
  options.address = {"192.0.2.20", predictor::rdt::kPort};
  try {
    const auto sensor = predictor::ConnectNetFt(options, &network);
    predictor::WrenchReading reading;
    std::uint64_t last = 0;
    for (int tick = 0; tick < 60; ++tick) {
      network.Wait(0.001);
      (void)sensor->Read(&reading);
      if (!reading.F_S.allFinite() || !(reading.age >= 0) || reading.sequence < last) std::abort();
      last = reading.sequence;
    }
    (void)sensor->Trouble();
  } catch (const predictor::DeviceError&) {
  }
  return 0;
}
