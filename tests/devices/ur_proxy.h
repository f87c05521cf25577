// A network between a driver and another network. It cuts the streams into pieces. Read and Write
// of this network do not allocate memory, so all counted allocations are the driver's own.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "devices/wire/network.h"

namespace predictor {

class ProxyNetwork final : public Network {
 public:
  explicit ProxyNetwork(Network* inner) : inner_(inner) {}

  // From now on, the newest `bytes` bytes arrive one millisecond later.
  void HoldBack(std::size_t bytes) { held_back_ = bytes; }

  std::unique_ptr<Stream> Connect(const Address& peer, double timeout) override {
    auto pipe = std::make_shared<Pipe>();
    pipe->inner = inner_->Connect(peer, timeout);
    pipes_.push_back(pipe);
    return std::make_unique<ProxyStream>(std::move(pipe));
  }
  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t port) override {
    return inner_->Open(peer, port);
  }
  std::uint64_t Now() const noexcept override { return inner_->Now(); }
  void Wait(double time) override {
    for (double t = 0; t < time - 1e-9; t += 0.001) {
      for (const auto& pipe : pipes_) pipe->Forward();
      inner_->Wait(0.001);
      for (const auto& pipe : pipes_) pipe->Fetch(held_back_);
    }
  }

 private:
  struct Pipe {
    std::unique_ptr<Stream> inner;
    std::array<std::byte, 1 << 16> in{}, out{};
    std::size_t arrived = 0, readable = 0, written = 0;
    bool open = true;

    void Forward() {
      if (inner && written > 0) open = inner->Write(std::span(out).first(written)) && open;
      written = 0;
    }
    void Fetch(std::size_t held_back) {
      // Makes the delayed bytes readable.
      const std::size_t before = arrived;
      const int bytes = inner ? inner->Read(std::span(in).subspan(arrived)) : 0;
      if (bytes < 0) open = false;
      if (bytes > 0) arrived += static_cast<std::size_t>(bytes);
      readable = std::max(before, arrived - std::min(arrived, held_back));
    }
  };

  class ProxyStream final : public Stream {
   public:
    explicit ProxyStream(std::shared_ptr<Pipe> pipe) : pipe_(std::move(pipe)) {}
    ~ProxyStream() override {
      pipe_->Forward();
      pipe_->inner.reset();
    }
    int Read(std::span<std::byte> to) noexcept override {
      Pipe& p = *pipe_;
      const std::size_t n = std::min(p.readable, to.size());
      if (n == 0) return p.open ? 0 : kClosed;
      std::copy_n(p.in.begin(), n, to.begin());
      std::copy(p.in.begin() + static_cast<std::ptrdiff_t>(n),
                p.in.begin() + static_cast<std::ptrdiff_t>(p.arrived), p.in.begin());
      p.arrived -= n;
      p.readable -= n;
      return static_cast<int>(n);
    }
    bool Write(std::span<const std::byte> from) noexcept override {
      Pipe& p = *pipe_;
      if (!p.open || p.written + from.size() > p.out.size()) return false;
      std::copy(from.begin(), from.end(), p.out.begin() + static_cast<std::ptrdiff_t>(p.written));
      p.written += from.size();
      return true;
    }

   private:
    std::shared_ptr<Pipe> pipe_;
  };

  Network* inner_;
  std::vector<std::shared_ptr<Pipe>> pipes_;
  std::size_t held_back_ = 0;
};

}  // namespace predictor
