#include "fakes/faulty_network.h"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

namespace predictor {
namespace {

struct Due {
  std::uint64_t at;  // [ns]
  Bytes bytes;
};

std::uint64_t Nanoseconds(double time) { return static_cast<std::uint64_t>(1e9 * time); }

class FaultyStream final : public Stream {
 public:
  FaultyStream(std::unique_ptr<Stream> stream, const std::string& host, const WireFaults* faults,
               const FaultyNetwork* network, RandomStream* random)
      : stream_(std::move(stream)),
        host_(host),
        faults_(faults),
        clock_(network),
        random_(random) {}

  int Read(std::span<std::byte> to) noexcept override {
    if (faults_->closed) return kClosed;
    const bool open = Pull();
    if (faults_->silent) return 0;
    while (!coming_.empty() && coming_.front().at <= clock_->Now()) {
      ready_.insert(ready_.end(), coming_.front().bytes.begin(), coming_.front().bytes.end());
      coming_.pop_front();
    }
    if (ready_.empty()) return open ? 0 : kClosed;
    const std::size_t n = std::min({to.size(), ready_.size(), faults_->split ? 1 : ready_.size()});
    std::copy_n(ready_.begin(), n, to.begin());
    ready_.erase(ready_.begin(), ready_.begin() + static_cast<std::ptrdiff_t>(n));
    return static_cast<int>(n);
  }

  bool Write(std::span<const std::byte> from) noexcept override {
    clock_->Observe(host_, from);
    if (faults_->closed) return false;
    return faults_->deaf || stream_->Write(from);
  }

 private:
  bool Pull() {
    std::array<std::byte, 4096> bytes;
    for (;;) {
      const int n = stream_->Read(bytes);
      if (n <= 0) return n == 0;
      Bytes part(bytes.begin(), bytes.begin() + n);
      if (faults_->corrupt) faults_->corrupt(&part);
      const double late = faults_->delay + faults_->jitter * random_->Uniform();
      const std::uint64_t last = coming_.empty() ? 0 : coming_.back().at;
      coming_.push_back({std::max(last, clock_->Now() + Nanoseconds(late)), std::move(part)});
    }
  }

  std::unique_ptr<Stream> stream_;
  std::string host_;
  const WireFaults* faults_;
  const FaultyNetwork* clock_;
  RandomStream* random_;
  std::deque<Due> coming_;
  std::deque<std::byte> ready_;
};

class FaultyDatagrams final : public Datagrams {
 public:
  FaultyDatagrams(std::unique_ptr<Datagrams> datagrams, const std::string& host,
                  const WireFaults* faults, const FaultyNetwork* network, RandomStream* random)
      : datagrams_(std::move(datagrams)),
        host_(host),
        faults_(faults),
        clock_(network),
        random_(random) {}

  int Receive(std::span<std::byte> to) noexcept override {
    Pull();
    if (faults_->silent || faults_->closed) return 0;
    const auto next = std::find_if(coming_.begin(), coming_.end(),
                                   [&](const Due& due) { return due.at <= clock_->Now(); });
    if (next == coming_.end()) return 0;
    const Bytes bytes = std::move(next->bytes);
    coming_.erase(next);
    std::copy_n(bytes.begin(), std::min(bytes.size(), to.size()), to.begin());
    return static_cast<int>(bytes.size());
  }
  bool Send(std::span<const std::byte> from) noexcept override {
    clock_->Observe(host_, from);
    return faults_->deaf || faults_->closed || datagrams_->Send(from);
  }
  std::uint16_t port() const noexcept override { return datagrams_->port(); }
  std::uint64_t strangers() const noexcept override { return strangers_; }

 private:
  void Pull() {
    if (faults_->spoofed) ++strangers_;
    std::array<std::byte, 4096> bytes;
    for (int n; (n = datagrams_->Receive(bytes)) > 0;) {
      Bytes one(bytes.begin(), bytes.begin() + std::min<long>(n, static_cast<long>(bytes.size())));
      if (random_->Uniform() < faults_->loss) continue;
      if (faults_->corrupt) faults_->corrupt(&one);
      const double late = faults_->delay + faults_->jitter * random_->Uniform();
      Due due{clock_->Now() + Nanoseconds(late), std::move(one)};
      // This datagram is delayed, so that the next one overtakes it.
      if (overtaken_.empty() && random_->Uniform() < faults_->reorder) {
        overtaken_ = std::move(due.bytes);
        continue;
      }
      if (random_->Uniform() < faults_->duplicate) coming_.push_back(due);
      coming_.push_back(due);
      if (!overtaken_.empty()) coming_.push_back({due.at, std::exchange(overtaken_, {})});
    }
  }

  std::unique_ptr<Datagrams> datagrams_;
  std::string host_;
  const WireFaults* faults_;
  const FaultyNetwork* clock_;
  RandomStream* random_;
  std::deque<Due> coming_;
  Bytes overtaken_;
  std::uint64_t strangers_ = 0;
};

}  // namespace

FaultyNetwork::FaultyNetwork(Network* network, std::uint64_t seed)
    : network_(network), random_(seed, "faults") {}

std::unique_ptr<Stream> FaultyNetwork::Connect(const Address& peer, double timeout) {
  return std::make_unique<FaultyStream>(network_->Connect(peer, timeout), peer.host, Of(peer.host),
                                        this, &random_);
}

std::unique_ptr<Datagrams> FaultyNetwork::Open(const Address& peer, std::uint16_t port) {
  return std::make_unique<FaultyDatagrams>(network_->Open(peer, port), peer.host, Of(peer.host),
                                           this, &random_);
}

}  // namespace predictor
