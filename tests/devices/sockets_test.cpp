// Tests behaviour that only real sockets have. A driver must not accept a datagram from a sender
// other than the device.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <vector>

#include "devices/net_ft/net_ft.h"
#include "devices/net_ft/rdt.h"
#include "devices/wire/network.h"

namespace predictor {
namespace {

// Simulates another sender in the network, which has an address of this computer.
class Sender {
 public:
  explicit Sender(const char* host, std::uint16_t at = 0)
      : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_port = htons(at);
    inet_pton(AF_INET, host, &own.sin_addr);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&own), sizeof own), 0);
    socklen_t size = sizeof own;
    getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size);
    port = ntohs(own.sin_port);
  }
  ~Sender() { close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void Send(std::uint16_t to, std::span<const std::byte> bytes) const {
    sockaddr_in peer{};
    peer.sin_family = AF_INET;
    peer.sin_port = htons(to);
    peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&peer),
                     sizeof peer),
              static_cast<ssize_t>(bytes.size()));
  }
  std::uint16_t port = 0;

 private:
  int socket_;
};

TEST(Sockets, DropAndCountDatagramsFromAnotherSender) {
  const Sender device("127.0.0.2"), stranger("127.0.0.3"), neighbour("127.0.0.2");
  const Sender namesake("127.0.0.4", device.port);
  const auto network = SocketNetwork();
  const auto datagrams = network->Open({"127.0.0.2", device.port}, 0);
  const std::array<std::byte, 3> word = {std::byte{1}, std::byte{2}, std::byte{3}};
  std::array<std::byte, 16> got{};
  stranger.Send(datagrams->port(), word);
  namesake.Send(datagrams->port(), word);   // correct port, but another computer
  neighbour.Send(datagrams->port(), word);  // correct computer, but another program
  device.Send(datagrams->port(), std::span(word).first(2));
  int size = 0;
  for (int k = 0; k < 1000 && size == 0; ++k) {
    size = datagrams->Receive(got);
    if (size == 0) network->Wait(0.001);
  }
  EXPECT_EQ(size, 2);
  EXPECT_EQ(datagrams->strangers(), 3U);
  EXPECT_EQ(datagrams->Receive(got), 0);
}

// If a peer has accepted only a part of a packet, the stream is invalid and the socket must close
// it.
TEST(Sockets, AStreamThatCouldTakeAPartOnlyIsClosed) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&own), size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  getsockname(listener, reinterpret_cast<sockaddr*>(&own), &size);
  const auto stream = SocketNetwork()->Connect({"127.0.0.1", ntohs(own.sin_port)}, 1);
  const std::vector<std::byte> much(std::size_t{1} << 22);
  bool written = true;
  for (int k = 0; k < 100 && written; ++k) written = stream->Write(much);
  EXPECT_FALSE(written);
  std::array<std::byte, 16> got{};
  EXPECT_EQ(stream->Read(got), Stream::kClosed);
  EXPECT_FALSE(stream->Write(std::span(much).first(1)));
  close(listener);
}

}  // namespace
}  // namespace predictor
