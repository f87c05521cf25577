// Passes arbitrary bytes to the driver as the data of a UR controller, from the first answer on.
// The data are those of RTDE, the dashboard, and the script port.
#include "devices/ur/ur_arm.h"

#include "fuzz/arm_session.h"
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  predictor::AnyPeer network(std::as_bytes(std::span(data, size)).subspan(1));
  predictor::UrOptions options{.host = "192.0.2.10"};
  options.listen = (data[0] & 1) != 0;
  if ((data[0] & 2) != 0) options.dashboard_port = 0;
  try {
    const auto arm = predictor::ConnectUr(options, &network);
    predictor::RunArm(arm.get(), !options.listen, &network);
  } catch (const predictor::DeviceError&) {
  }
  return 0;
}
