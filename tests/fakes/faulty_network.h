// Wraps a network, in memory or with sockets, and adds faults between a driver and its device.
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

// Faults of the connection with one host. A test may set and clear each one at any time.
struct WireFaults {
  double loss = 0;                      // fraction of lost datagrams to us
  double duplicate = 0;                 // fraction of duplicated datagrams
  double reorder = 0;                   // fraction that the next datagram overtakes
  double delay = 0;                     // of all received data [s]
  double jitter = 0;                    // additional uniform delay [s]; a stream stays in order
  bool silent = false;                  // no more data arrives, but the connection remains open
  bool deaf = false;                    // data that we send is lost
  bool split = false;                   // each read of a stream returns one byte
  bool closed = false;                  // the connection is closed
  bool spoofed = false;                 // another host also sends datagrams, which sockets discard
  std::function<void(Bytes*)> corrupt;  // changes received data: a datagram, or one chunk of a
                                        // stream
};

class FaultyNetwork final : public Network {
 public:
  // `network` must outlive this object. `seed` determines the random faults.
  FaultyNetwork(Network* network, std::uint64_t seed);

  // Returns the faults of a host. The returned faults are valid as long as this object exists.
  WireFaults* Of(const std::string& host) { return &faults_[host]; }

  // A function that receives all data written to a host, whether the data arrives or not. The data
  // is a piece of a stream or a datagram.
  using Heard = std::function<void(const std::string& host, std::span<const std::byte> bytes)>;
  void SetHeard(Heard heard) { heard_ = std::move(heard); }
  void Observe(const std::string& host, std::span<const std::byte> bytes) const {
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
