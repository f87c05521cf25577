#include "devices/ur/rtde_connection.h"

namespace predictor::rtde {
namespace {

constexpr double kAnswerTimeout = 2;  // maximum wait when connecting, and for each answer [s]

}  // namespace

Connection::Connection(Network* network, const Address& peer)
    : network_(network), peer_(peer), stream_(network->Connect(peer, kAnswerTimeout)) {}

std::vector<std::byte> Connection::Ask(std::span<const std::byte> request, PacketType answer) {
  if (!Send(request)) throw DeviceError(peer_, "has closed the connection.");
  std::vector<std::byte> payload;
  bool answered = false;
  std::string said;
  const auto take = [&](const Packet& packet) {
    TextMessage text;
    if (packet.type == answer) {
      payload.assign(packet.payload.begin(), packet.payload.end());
      answered = true;
    } else if (packet.type == PacketType::kText && Decode(packet.payload, &text)) {
      said = " Its message: " + std::string(text.text);
    }
    return true;
  };
  WaitUntil(network_, kAnswerTimeout, [&] { return Drain(take) != State::kOpen || answered; });
  if (answered) return payload;
  if (state_ == State::kMalformed)
    throw DeviceError(peer_,
                      "sends an answer that is not RTDE. Check that this is the RTDE port of a "
                      "Universal Robots robot (usually 30004).");
  throw DeviceError(
      peer_,
      state_ == State::kClosed
          ? "closes the connection instead of answering." + said
          : "accepts the connection but does not answer. Restart the robot's controller." + said);
}

}  // namespace predictor::rtde
