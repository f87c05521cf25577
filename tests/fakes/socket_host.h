// Connects a fake device to sockets of this computer. Each device has a loopback address of its
// own.
#pragma once

#include <netinet/in.h>

#include <map>
#include <string>
#include <vector>

#include "fakes/far_end.h"

namespace predictor {

class SocketHost final : public Wire {
 public:
  // `address` lies in 127.0.0.0/8. Throws std::runtime_error if a port at that address is not
  // available.
  SocketHost(const std::string& address, FakeDevice* device);
  ~SocketHost() override;
  SocketHost(const SocketHost&) = delete;
  SocketHost& operator=(const SocketHost&) = delete;

  // Passes received data to the device without waiting. Returns whether any data was received.
  bool Receive();

  void Send(int link, std::span<const std::byte> bytes) override;
  void Close(int link) override;
  void SendDatagram(std::uint16_t from, std::uint16_t to,
                    std::span<const std::byte> bytes) override;

 private:
  struct Link {
    int socket;
    Bytes unsent;
  };
  void Accept(int listener, std::uint16_t port);
  void Flush(int link);
  bool ReadFrom(int link, bool* heard);

  FakeDevice* device_;
  in_addr own_{}, client_{};
  std::map<std::uint16_t, int> listeners_, datagrams_;
  std::map<int, Link> links_;
  int next_ = 1;
};

}  // namespace predictor
