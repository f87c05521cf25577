#include "fakes/socket_host.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace predictor {
namespace {

const sockaddr* Generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

int Bound(in_addr own, std::uint16_t port, int type) {
  const int descriptor = socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (type == SOCK_STREAM) setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = own;
  address.sin_port = htons(port);
  if (bind(descriptor, Generic(address), sizeof address) != 0 ||
      (type == SOCK_STREAM && listen(descriptor, 4) != 0))
    throw std::runtime_error("Port " + std::to_string(port) + " of " + inet_ntoa(own) +
                             " is not available: " + std::strerror(errno));
  return descriptor;
}

}  // namespace

SocketHost::SocketHost(const std::string& address, FakeDevice* device) : device_(device) {
  if (inet_aton(address.c_str(), &own_) == 0 || (ntohl(own_.s_addr) >> 24) != 127)
    throw std::runtime_error("\"" + address + "\" is not a loopback address such as 127.0.0.2.");
  client_ = own_;
  for (const std::uint16_t port : device->tcp_ports())
    listeners_[port] = Bound(own_, port, SOCK_STREAM);
  for (const std::uint16_t port : device->udp_ports())
    datagrams_[port] = Bound(own_, port, SOCK_DGRAM);
  device->Attach(this);
}

SocketHost::~SocketHost() {
  for (const auto& [port, descriptor] : listeners_) close(descriptor);
  for (const auto& [port, descriptor] : datagrams_) close(descriptor);
  for (const auto& [number, link] : links_) close(link.socket);
}

void SocketHost::Accept(int listener, std::uint16_t port) {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const int descriptor =
      accept4(listener, reinterpret_cast<sockaddr*>(&from), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (descriptor < 0) return;
  const int yes = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  client_ = from.sin_addr;
  const int link = next_++;
  links_[link] = {descriptor, {}};
  device_->Opened(link, port);
}

// Returns false if the link is closed.
bool SocketHost::ReadFrom(int link, bool* heard) {
  std::array<std::byte, 4096> bytes;
  for (;;) {
    const auto it = links_.find(link);
    if (it == links_.end()) return false;
    const ssize_t n = recv(it->second.socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (n > 0) {
      *heard = true;
      device_->Received(link, std::span(bytes).first(static_cast<std::size_t>(n)));
      continue;
    }
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) return true;
    close(it->second.socket);
    links_.erase(it);
    device_->Closed(link);
    return false;
  }
}

bool SocketHost::Receive() {
  bool heard = false;
  for (const auto& [port, listener] : listeners_) Accept(listener, port);
  std::vector<int> open;
  for (const auto& [number, link] : links_) open.push_back(number);
  for (const int link : open)
    if (ReadFrom(link, &heard)) Flush(link);
  for (const auto& [port, descriptor] : datagrams_) {
    std::array<std::byte, 4096> bytes;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    ssize_t n;
    while ((n = recvfrom(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT,
                         reinterpret_cast<sockaddr*>(&from), &size)) >= 0) {
      client_ = from.sin_addr;
      heard = true;
      device_->ReceivedDatagram(port, ntohs(from.sin_port),
                                std::span(bytes).first(static_cast<std::size_t>(n)));
    }
  }
  return heard;
}

void SocketHost::Flush(int link) {
  const auto it = links_.find(link);
  if (it == links_.end() || it->second.unsent.empty()) return;
  Bytes& unsent = it->second.unsent;
  const ssize_t n =
      send(it->second.socket, unsent.data(), unsent.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (n > 0) unsent.erase(unsent.begin(), unsent.begin() + n);
}

void SocketHost::Send(int link, std::span<const std::byte> bytes) {
  const auto it = links_.find(link);
  if (it == links_.end()) return;
  it->second.unsent.insert(it->second.unsent.end(), bytes.begin(), bytes.end());
  Flush(link);
}

void SocketHost::Close(int link) {
  const auto it = links_.find(link);
  if (it == links_.end()) return;
  Flush(link);
  close(it->second.socket);
  links_.erase(it);
}

void SocketHost::SendDatagram(std::uint16_t from, std::uint16_t to,
                              std::span<const std::byte> bytes) {
  const auto it = datagrams_.find(from);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = client_;
  address.sin_port = htons(to);
  if (it == datagrams_.end()) {  // the device does not listen on this port
    datagrams_[from] = Bound(own_, from, SOCK_DGRAM);
    return SendDatagram(from, to, bytes);
  }
  sendto(it->second, bytes.data(), bytes.size(), MSG_DONTWAIT, Generic(address), sizeof address);
}

}  // namespace predictor
