// Faults on the way between a driver and its device: a network around another, memory's or
// sockets'.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "core/random.h"
#include "devices/wire/network.h"
#include "fakes/far_end.h"

namespace predictor {

// What happens to the bytes of one host from now on. Each may be set and taken back at any time.
struct WireFaults {
  double loss = 0;                      // share of the datagrams to us that are lost
  double duplicate = 0;                 // that come twice
  double reorder = 0;                   // that are overtaken by the next one
  double delay = 0;                     // of all that comes [s]
  double jitter = 0;                    // added to it, uniform [s]; a stream stays in order
  bool silent = false;                  // nothing comes any more, though the connection stands
  bool deaf = false;                    // what we send vanishes
  bool split = false;                   // a stream comes a byte a read
  bool closed = false;                  // the connection breaks
  bool spoofed = false;                 // somebody else sends datagrams too, which sockets drop
  std::function<void(Bytes*)> corrupt;  // of what comes: a datagram, or what a stream gives at once
};

class FaultyNetwork final : public Network {
 public:
  // `network` outlives this. seed: of what is left to chance.
  FaultyNetwork(Network* network, std::uint64_t seed);

  // Lives as long as this.
  WireFaults* Of(const std::string& host) { return &faults_[host]; }

  // Called with what is written to a host, whether it arrives or not: a piece of a stream, or a
  // datagram.
  using Heard = std::function<void(const std::string& host, std::span<const std::byte> bytes)>;
  void SetHeard(Heard heard) { heard_ = std::move(heard); }
  void Tell(const std::string& host, std::span<const std::byte> bytes) const {
    if (heard_) heard_(host, bytes);
  }

  std::unique_ptr<Stream> Connect(const Address& peer, double timeout) override;
  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) override;
  std::uint64_t Now() const noexcept override { return network_->Now(); }
  void Wait(double time) override { network_->Wait(time); }

 private:
  Network* network_;
  RandomStream random_;
  std::map<std::string, WireFaults> faults_;
  Heard heard_;
};

}  // namespace predictor
