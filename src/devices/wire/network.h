// The bytes between us and a device, and the time at which they pass: over sockets by the clock, or
// through memory by a clock of its own (tests, faults).
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
  // "192.0.2.10:30004".
  std::string ToString() const { return host + ":" + std::to_string(port); }
};

// A device that does not answer, answers what it must not, or refuses; found before anything moves.
// what() is a sentence or more for a person: who, what, and what to do.
class DeviceError : public std::runtime_error {
 public:
  explicit DeviceError(const std::string& sentence) : std::runtime_error(sentence) {}
  DeviceError(const Address& who, const std::string& what)
      : std::runtime_error(who.ToString() + " " + what) {}
};

// Bytes in order (TCP). Nothing here blocks, allocates or throws.
class Stream {
 public:
  static constexpr int kClosed = -1;

  virtual ~Stream() = default;
  // What has arrived, into `to`: its size; 0: nothing now; kClosed: the peer has closed, or the
  // connection is broken, for good.
  virtual int Read(std::span<std::byte> to) noexcept = 0;
  // All of it, or false: the peer is gone, or reads so slowly that there is no room. A stream that
  // could take a part only is of no use any more: it is closed.
  virtual bool Write(std::span<const std::byte> from) noexcept = 0;
};

// Datagrams to and from one peer (UDP); what others send is dropped and counted. Nothing here
// blocks, allocates or throws.
class Datagrams {
 public:
  virtual ~Datagrams() = default;
  // The next one, into `to`: its size, which is larger than `to` if it was cut; 0: none now.
  virtual int Receive(std::span<std::byte> to) noexcept = 0;
  virtual bool Send(std::span<const std::byte> from) noexcept = 0;
  virtual std::uint16_t port() const noexcept = 0;       // ours
  virtual std::uint64_t strangers() const noexcept = 0;  // datagrams of others, dropped
};

class Network {
 public:
  virtual ~Network() = default;
  // Throws DeviceError: nobody answers there within `timeout` [s], or refuses.
  virtual std::unique_ptr<Stream> Connect(const Address& peer, double timeout) = 0;
  // port: ours; 0: any. peer.port 0: whichever port the peer's first datagram comes from. Throws
  // DeviceError.
  virtual std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) = 0;
  // Monotonic [ns].
  virtual std::uint64_t Now() const noexcept = 0;
  // Lets time pass [s]. Before the first tick only.
  virtual void Wait(double time) = 0;
};

// This machine's sockets and its clock. TCP without delay; each peer is pinned by its address.
std::unique_ptr<Network> SocketNetwork();

// Waits, before the first tick, until `done()` is true, looking every millisecond. False if it is
// not within `timeout` [s].
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
