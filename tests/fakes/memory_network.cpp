#include "fakes/memory_network.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace predictor {
namespace {

// The two directions of one connection.
struct Pipe {
  std::deque<std::byte> to_client;
  bool open = true;
};

struct Port {
  std::deque<Bytes> to_client;
  std::uint16_t number = 0;
  std::uint16_t peer = 0;
};

int Take(std::deque<std::byte>* from, std::span<std::byte> to) {
  const std::size_t n = std::min(from->size(), to.size());
  std::copy_n(from->begin(), n, to.begin());
  from->erase(from->begin(), from->begin() + static_cast<std::ptrdiff_t>(n));
  return static_cast<int>(n);
}

}  // namespace

struct MemoryNetwork::Host final : Wire {
  FakeDevice* device = nullptr;
  Mechanics* mechanics = nullptr;
  std::map<int, std::shared_ptr<Pipe>> links;
  std::map<std::uint16_t, std::shared_ptr<Port>> ports;  // ports of clients
  int next = 1;

  void Send(int link, std::span<const std::byte> bytes) override {
    if (const auto it = links.find(link); it != links.end())
      it->second->to_client.insert(it->second->to_client.end(), bytes.begin(), bytes.end());
  }
  void Close(int link) override {
    if (const auto it = links.find(link); it != links.end()) it->second->open = false;
    links.erase(link);
  }
  void SendDatagram(std::uint16_t from, std::uint16_t to,
                    std::span<const std::byte> bytes) override {
    const auto it = ports.find(to);
    if (it == ports.end()) return;
    Port& port = *it->second;
    if (port.peer == 0) port.peer = from;
    if (port.peer == from) port.to_client.emplace_back(bytes.begin(), bytes.end());
  }
};

namespace {

class MemoryStream final : public Stream {
 public:
  MemoryStream(MemoryNetwork::Host* host, int link, std::shared_ptr<Pipe> pipe)
      : host_(host), link_(link), pipe_(std::move(pipe)) {}
  ~MemoryStream() override {
    if (!pipe_->open) return;
    host_->links.erase(link_);
    host_->device->Closed(link_);
  }

  int Read(std::span<std::byte> to) noexcept override {
    if (!pipe_->to_client.empty()) return Take(&pipe_->to_client, to);
    return pipe_->open ? 0 : kClosed;
  }
  bool Write(std::span<const std::byte> from) noexcept override {
    if (!pipe_->open) return false;
    host_->device->Received(link_, from);
    return true;
  }

 private:
  MemoryNetwork::Host* host_;
  int link_;
  std::shared_ptr<Pipe> pipe_;
};

class MemoryDatagrams final : public Datagrams {
 public:
  MemoryDatagrams(MemoryNetwork::Host* host, std::shared_ptr<Port> port)
      : host_(host), port_(std::move(port)) {}
  ~MemoryDatagrams() override { host_->ports.erase(port_->number); }

  int Receive(std::span<std::byte> to) noexcept override {
    if (port_->to_client.empty()) return 0;
    const Bytes bytes = std::move(port_->to_client.front());
    port_->to_client.pop_front();
    std::copy_n(bytes.begin(), std::min(bytes.size(), to.size()), to.begin());
    return static_cast<int>(bytes.size());
  }
  bool Send(std::span<const std::byte> from) noexcept override {
    host_->device->ReceivedDatagram(port_->peer, port_->number, from);
    return true;
  }
  std::uint16_t port() const noexcept override { return port_->number; }
  std::uint64_t strangers() const noexcept override { return 0; }

 private:
  MemoryNetwork::Host* host_;
  std::shared_ptr<Port> port_;
};

}  // namespace

MemoryNetwork::MemoryNetwork() = default;
MemoryNetwork::~MemoryNetwork() = default;

void MemoryNetwork::Add(const std::string& host, FakeDevice* device, Mechanics* mechanics) {
  auto entry = std::make_unique<Host>();
  entry->device = device;
  entry->mechanics = mechanics;
  device->Attach(entry.get());
  hosts_[host] = std::move(entry);
}

void MemoryNetwork::Pass(double time) {
  for (long steps = std::max(1L, std::lround(time * 1e3)); steps > 0; --steps) {
    now_ += 1'000'000;
    for (auto& [name, host] : hosts_) host->device->Step(host->mechanics);
    if (world_) world_();
  }
}

std::unique_ptr<Stream> MemoryNetwork::Connect(const Address& peer, double timeout) {
  const auto it = hosts_.find(peer.host);
  if (it == hosts_.end()) {
    Pass(timeout);
    throw DeviceError(
        peer, "does not answer. Check that the device is on and that the address is correct.");
  }
  Host& host = *it->second;
  const auto ports = host.device->tcp_ports();
  if (std::find(ports.begin(), ports.end(), peer.port) == ports.end())
    throw DeviceError(peer, "refuses. Check that the device is on and offers this port.");
  const int link = host.next++;
  auto pipe = std::make_shared<Pipe>();
  host.links[link] = pipe;
  host.device->Opened(link, peer.port);
  return std::make_unique<MemoryStream>(&host, link, std::move(pipe));
}

std::unique_ptr<Datagrams> MemoryNetwork::Open(const Address& peer, std::uint16_t port) {
  const auto it = hosts_.find(peer.host);
  if (it == hosts_.end()) throw DeviceError(peer, "is not in a network of this machine.");
  auto entry = std::make_shared<Port>();
  entry->number = port != 0 ? port : next_port_++;
  entry->peer = peer.port;
  it->second->ports[entry->number] = entry;
  return std::make_unique<MemoryDatagrams>(it->second.get(), std::move(entry));
}

}  // namespace predictor
