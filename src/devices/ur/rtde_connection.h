// A connection to a controller's RTDE server.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/ur/rtde.h"
#include "devices/wire/network.h"

namespace predictor::rtde {

class Connection {
 public:
  enum class State { kOpen, kClosed, kMalformed };

  // Throws DeviceError.
  Connection(Network* network, const Address& peer);

  // Sends a request, waits for an answer of this type, and returns the payload of the answer. Call
  // this only before the first tick. Throws DeviceError, whose text includes the messages that the
  // controller sent meanwhile.
  std::vector<std::byte> Ask(std::span<const std::byte> request, PacketType answer);

  bool Send(std::span<const std::byte> packet) noexcept { return stream_->Write(packet); }

  // Passes all received packets to `take`. The function `take` returns whether a packet is valid. A
  // malformed packet ends the connection. Never blocks, even if many bytes arrive.
  template <class Take>
  State Drain(const Take& take) noexcept {
    for (int reads = 0; state_ == State::kOpen && reads < kMaxReads; ++reads) {
      const int bytes = stream_->Read(parser_.Room());
      if (bytes == 0) break;
      if (bytes < 0) {
        state_ = State::kClosed;
      } else {
        parser_.Filled(static_cast<std::size_t>(bytes));
        TakePackets(take);
      }
    }
    return state_;
  }

  const Address& peer() const { return peer_; }

 private:
  static constexpr int kMaxReads = 512;  // sufficient even for a stream that arrives byte by byte

  template <class Take>
  void TakePackets(const Take& take) noexcept {
    Packet packet;
    while (state_ == State::kOpen && parser_.Next(&packet))
      if (!take(packet)) state_ = State::kMalformed;
    if (parser_.broken()) state_ = State::kMalformed;
  }

  Network* network_;
  Address peer_;
  std::unique_ptr<Stream> stream_;
  PacketParser parser_;
  State state_ = State::kOpen;
};

}  // namespace predictor::rtde
