// Passes arbitrary bytes to the driver as the answers and states of a Franka controller, from the
// first answer on.
#include "devices/franka/franka_arm.h"

#include "fuzz/arm_session.h"
#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  predictor::AnyPeer network(std::as_bytes(std::span(data, size)).subspan(1));
  predictor::FrankaOptions options;
  options.host = "192.0.2.10";
  options.listen = (data[0] & 1) != 0;
  if ((data[0] & 2) != 0) options.collision.emplace();
  try {
    const auto arm = predictor::ConnectFranka(options, &network);
    predictor::RunArm(arm.get(), !options.listen, &network);
  } catch (const predictor::DeviceError&) {
  }
  return 0;
}
