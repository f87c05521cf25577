// Transports bytes between this program and a device, and provides the time. There are two
// implementations: one uses sockets and the real clock, the other (for tests and fault tests) uses
// memory and a simulated clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace predictor {

struct Address {
  std::string host;
  std::uint16_t port = 0;
  // Returns "192.0.2.10:30004", for example.
  std::string ToString() const { return host + ":" + std::to_string(port); }
};

// Thrown before anything moves if a device does not answer, gives an invalid answer, or refuses a
// request. The function what() returns one or more sentences for the user that state the device,
// the error and the remedy.
class DeviceError : public std::runtime_error {
 public:
  explicit DeviceError(const std::string& sentence) : std::runtime_error(sentence) {}
  DeviceError(const Address& who, const std::string& what)
      : std::runtime_error(who.ToString() + " " + what) {}
};

// An ordered byte stream (TCP). The functions never block, allocate or throw.
class Stream {
 public:
  static constexpr int kClosed = -1;

  virtual ~Stream() = default;
  // Copies received data to `to` and returns the size, which is 0 if there is no data at present.
  // The value kClosed means that the peer has closed the connection or that the connection is
  // permanently broken.
  virtual int Read(std::span<std::byte> to) noexcept = 0;
  // Writes all bytes. Returns false if the peer has gone or reads so slowly that the buffer is
  // full. If the stream accepts only a part of the data, the stream is closed, because it can no
  // longer be used.
  virtual bool Write(std::span<const std::byte> from) noexcept = 0;
};

// Datagrams to and from one peer (UDP). Datagrams from other senders are dropped and counted. The
// functions of this class never block, allocate or throw.
class Datagrams {
 public:
  virtual ~Datagrams() = default;
  // Copies the next datagram to `to` and returns its size, or 0 if no datagram is available. If the
  // datagram was truncated, the returned size exceeds the size of `to`.
  virtual int Receive(std::span<std::byte> to) noexcept = 0;
  virtual bool Send(std::span<const std::byte> from) noexcept = 0;
  virtual std::uint16_t port() const noexcept = 0;  // our port number
  // Returns the number of dropped datagrams from other senders.
  virtual std::uint64_t strangers() const noexcept = 0;
};

class Network {
 public:
  virtual ~Network() = default;
  // Throws DeviceError if there is no answer within `timeout` [s] or the connection is refused.
  virtual std::unique_ptr<Stream> Connect(const Address& peer, double timeout) = 0;
  // `port` is the port on this computer, or 0 for any port. If peer.port is 0, the port from which
  // the peer's first datagram arrives is used. Throws DeviceError.
  virtual std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) = 0;
  // Returns the monotonic clock [ns].
  virtual std::uint64_t Now() const noexcept = 0;
  // Lets time pass [s]. Call this only before the first tick.
  virtual void Wait(double time) = 0;
};

// Returns this computer's sockets and clock. TCP streams send without delay (without Nagle's
// algorithm), and each peer is identified by its address.
std::unique_ptr<Network> SocketNetwork();

// Waits until `done()` returns true. The function calls `done()` every millisecond. Returns false
// after `timeout` [s]. Call this only before the first tick.
template <class Done>
bool WaitUntil(Network* network, double timeout, const Done& done) {
  const std::uint64_t end = network->Now() + static_cast<std::uint64_t>(1e9 * timeout);
  while (!done()) {
    if (network->Now() >= end) return false;
    network->Wait(0.001);
  }
  return true;
}

}  // namespace predictor
