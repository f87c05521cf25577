// A network that transfers bytes only between ticks, so that a test can count the driver's own
// allocations in a tick.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <utility>

#include "devices/wire/network.h"

namespace predictor {

class HeldNetwork final : public Network {
 public:
  explicit HeldNetwork(Network* inner) : inner_(inner) {}

  // From now on, only Exchange transfers data. Exchange makes received data readable and sends
  // written data.
  void Hold() { holding_ = true; }
  void Exchange() {
    for (Held* held : held_) held->Exchange();
  }

  std::unique_ptr<predictor::Stream> Connect(const Address& peer, double timeout) override {
    return std::make_unique<Stream>(this, inner_->Connect(peer, timeout));
  }
  std::unique_ptr<predictor::Datagrams> Open(const Address& peer, std::uint16_t port) override {
    return std::make_unique<Datagrams>(this, inner_->Open(peer, port));
  }
  std::uint64_t Now() const noexcept override { return inner_->Now(); }
  void Wait(double time) override { inner_->Wait(time); }

 private:
  struct Held {
    explicit Held(HeldNetwork* all) : network(all) { network->held_.insert(this); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    virtual ~Held() { network->held_.erase(this); }
    virtual void Exchange() = 0;
    HeldNetwork* network;
  };

  struct Buffer {
    std::array<std::byte, 8192> bytes{};
    std::size_t size = 0;

    bool Put(std::span<const std::byte> from) noexcept {
      if (from.size() > bytes.size() - size) return false;
      std::copy(from.begin(), from.end(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      size += from.size();
      return true;
    }
    std::span<const std::byte> written() const noexcept { return std::span(bytes).first(size); }
    std::size_t Take(std::span<std::byte> to) noexcept {
      const std::size_t n = std::min(size, to.size());
      std::copy_n(bytes.begin(), n, to.begin());
      std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(n),
                bytes.begin() + static_cast<std::ptrdiff_t>(size), bytes.begin());
      size -= n;
      return n;
    }
  };

  class Stream final : public predictor::Stream, Held {
   public:
    Stream(HeldNetwork* all, std::unique_ptr<predictor::Stream> inner)
        : Held(all), inner_(std::move(inner)) {}
    int Read(std::span<std::byte> to) noexcept override {
      if (!network->holding_) return inner_->Read(to);
      if (in_.size == 0 && closed_) return kClosed;
      return static_cast<int>(in_.Take(to));
    }
    bool Write(std::span<const std::byte> from) noexcept override {
      if (!network->holding_) return inner_->Write(from);
      return !closed_ && out_.Put(from);
    }
    void Exchange() override {
      std::array<std::byte, 1024> piece;
      int n = 0;
      while ((n = inner_->Read(piece)) > 0)
        in_.Put(std::span(piece).first(static_cast<unsigned>(n)));
      closed_ = n == kClosed;
      if (out_.size > 0) inner_->Write(out_.written());
      out_.size = 0;
    }

   private:
    std::unique_ptr<predictor::Stream> inner_;
    Buffer in_, out_;
    bool closed_ = false;
  };

  class Datagrams final : public predictor::Datagrams, Held {
   public:
    Datagrams(HeldNetwork* all, std::unique_ptr<predictor::Datagrams> inner)
        : Held(all), inner_(std::move(inner)) {}
    int Receive(std::span<std::byte> to) noexcept override {
      if (!network->holding_) return inner_->Receive(to);
      if (next_ == in_count_) return 0;
      const std::span<const std::byte> bytes = in_[next_++].written();
      std::copy_n(bytes.begin(), std::min(bytes.size(), to.size()), to.begin());
      return static_cast<int>(bytes.size());
    }
    bool Send(std::span<const std::byte> from) noexcept override {
      if (!network->holding_) return inner_->Send(from);
      if (out_count_ == out_.size()) return false;
      out_[out_count_].size = 0;
      return out_[out_count_++].Put(from);
    }
    std::uint16_t port() const noexcept override { return inner_->port(); }
    std::uint64_t strangers() const noexcept override { return inner_->strangers(); }
    void Exchange() override {
      in_count_ = next_ = 0;
      std::array<std::byte, 4096> bytes;
      while (in_count_ < in_.size()) {
        const int n = inner_->Receive(bytes);
        if (n <= 0) break;
        in_[in_count_].size = 0;
        in_[in_count_++].Put(std::span(bytes).first(static_cast<unsigned>(n)));
      }
      for (std::size_t i = 0; i < out_count_; ++i) inner_->Send(out_[i].written());
      out_count_ = 0;
    }

   private:
    std::unique_ptr<predictor::Datagrams> inner_;
    std::array<Buffer, 8> in_, out_;
    std::size_t in_count_ = 0, next_ = 0, out_count_ = 0;
  };

  Network* inner_;
  bool holding_ = false;
  std::set<Held*> held_;
};

}  // namespace predictor
