#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "devices/wire/network.h"

namespace predictor {
namespace {

// A file descriptor that is closed on destruction.
class Socket {
 public:
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  ~Socket() { Close(); }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&&) = delete;

  void Close() noexcept {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  int get() const noexcept { return descriptor_; }

 private:
  int descriptor_;
};

bool Again(int error) noexcept { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

sockaddr_in Resolve(const Address& who) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(who.host.c_str(), nullptr, &hints, &found); error != 0)
    throw DeviceError("No machine has the name \"" + who.host + "\" (" + gai_strerror(error) +
                      "). Give the device's address as numbers, for example 192.0.2.10.");
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  freeaddrinfo(found);
  address.sin_port = htons(who.port);
  return address;
}

const sockaddr* Generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

class SocketStream final : public Stream {
 public:
  explicit SocketStream(Socket socket) : socket_(std::move(socket)) {}

  int Read(std::span<std::byte> to) noexcept override {
    if (socket_.get() < 0) return kClosed;
    const ssize_t n = recv(socket_.get(), to.data(), to.size(), MSG_DONTWAIT);
    if (n > 0) return static_cast<int>(n);
    if (n < 0 && Again(errno)) return 0;
    socket_.Close();
    return kClosed;
  }

  bool Write(std::span<const std::byte> from) noexcept override {
    if (socket_.get() < 0) return false;
    const ssize_t n = send(socket_.get(), from.data(), from.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n == static_cast<ssize_t>(from.size())) return true;
    if (n >= 0 || !Again(errno)) socket_.Close();
    return false;
  }

 private:
  Socket socket_;
};

class SocketDatagrams final : public Datagrams {
 public:
  SocketDatagrams(Socket socket, const sockaddr_in& peer, std::uint16_t port)
      : socket_(std::move(socket)), peer_(peer), port_(port) {}

  int Receive(std::span<std::byte> to) noexcept override {
    // A flood of foreign datagrams must not delay the tick.
    for (int tries = 0; tries < kMaxStrangers; ++tries) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const ssize_t n = recvfrom(socket_.get(), to.data(), to.size(), MSG_DONTWAIT | MSG_TRUNC,
                                 reinterpret_cast<sockaddr*>(&from), &size);
      if (n < 0) return 0;
      if (from.sin_addr.s_addr == peer_.sin_addr.s_addr &&
          (peer_.sin_port == 0 || from.sin_port == peer_.sin_port)) {
        peer_.sin_port = from.sin_port;
        return static_cast<int>(n);
      }
      ++strangers_;
    }
    return 0;
  }

  bool Send(std::span<const std::byte> from) noexcept override {
    return sendto(socket_.get(), from.data(), from.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                  Generic(peer_), sizeof peer_) == static_cast<ssize_t>(from.size());
  }

  std::uint16_t port() const noexcept override { return port_; }
  std::uint64_t strangers() const noexcept override { return strangers_; }

 private:
  static constexpr int kMaxStrangers = 16;

  Socket socket_;
  sockaddr_in peer_;
  std::uint16_t port_;
  std::uint64_t strangers_ = 0;
};

std::string Reason(int error) { return std::strerror(error); }

class Sockets final : public Network {
 public:
  std::unique_ptr<Stream> Connect(const Address& peer, double timeout) override {
    const sockaddr_in address = Resolve(peer);
    Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (socket.get() < 0) throw DeviceError("A socket could not be opened: " + Reason(errno) + ".");
    if (connect(socket.get(), Generic(address), sizeof address) != 0) {
      if (errno != EINPROGRESS) throw DeviceError(peer, "refuses: " + Reason(errno) + ".");
      pollfd ready{socket.get(), POLLOUT, 0};
      if (poll(&ready, 1, static_cast<int>(1e3 * timeout)) <= 0)
        throw DeviceError(
            peer, "does not answer. Check that the device is on and that the address is correct.");
      int error = 0;
      socklen_t size = sizeof error;
      getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
      if (error != 0)
        throw DeviceError(peer, "refuses: " + Reason(error) +
                                    ". Check that the device is on and offers this port.");
    }
    const int at_once = 1;
    setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
    return std::make_unique<SocketStream>(std::move(socket));
  }

  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) override {
    const sockaddr_in address = Resolve(peer);
    Socket socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (socket.get() < 0) throw DeviceError("A socket could not be opened: " + Reason(errno) + ".");
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_port = htons(port);
    // The socket is bound only to the interface that leads to the device.
    own.sin_addr = OwnAddress(address);
    if (bind(socket.get(), Generic(own), sizeof own) != 0)
      throw DeviceError("This computer's UDP port " + std::to_string(port) + ", to which " +
                        peer.host + " sends, is not available: " + Reason(errno) +
                        ". Check whether another program uses this port.");
    socklen_t size = sizeof own;
    getsockname(socket.get(), reinterpret_cast<sockaddr*>(&own), &size);
    return std::make_unique<SocketDatagrams>(std::move(socket), address, ntohs(own.sin_port));
  }

  std::uint64_t Now() const noexcept override {
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::uint64_t>(t.tv_sec) * 1'000'000'000ULL +
           static_cast<std::uint64_t>(t.tv_nsec);
  }

  void Wait(double time) override {
    const auto ns = static_cast<long>(1e9 * time);
    const timespec t{static_cast<time_t>(ns / 1'000'000'000L), ns % 1'000'000'000L};
    nanosleep(&t, nullptr);
  }

 private:
  // Returns the address of this computer as the peer sees it. Connecting a datagram socket sends no
  // packet.
  static in_addr OwnAddress(sockaddr_in peer) {
    const Socket probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (peer.sin_port == 0) peer.sin_port = htons(9);  // any port
    sockaddr_in own{};
    socklen_t size = sizeof own;
    if (connect(probe.get(), Generic(peer), sizeof peer) != 0 ||
        getsockname(probe.get(), reinterpret_cast<sockaddr*>(&own), &size) != 0)
      throw DeviceError("This computer has no network route to the device: " + Reason(errno) + ".");
    return own.sin_addr;
  }
};

}  // namespace

std::unique_ptr<Network> SocketNetwork() { return std::make_unique<Sockets>(); }

}  // namespace predictor
