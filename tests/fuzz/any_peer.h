// A device that sends arbitrary data. Each connection of a driver receives the next piece of the
// input.
#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "devices/wire/network.h"

namespace predictor {

// The input consists of pieces. A piece is a size of two bytes (little-endian), followed by that
// number of bytes, which the next read receives. After size 0, one byte gives the number of reads
// that receive nothing. Size 0xFFFF closes the connection. After the end of the input, the device
// is silent.
class AnyPeer final : public Network {
 public:
  explicit AnyPeer(std::span<const std::byte> input) : rest_(input) {}

  std::unique_ptr<Stream> Connect(const Address&, double) override {
    return std::make_unique<AnyStream>(this);
  }
  std::unique_ptr<Datagrams> Open(const Address&, std::uint16_t port) override {
    return std::make_unique<AnyDatagrams>(this, port);
  }
  std::uint64_t Now() const noexcept override { return now_; }
  void Wait(double time) override { now_ += static_cast<std::uint64_t>(1e9 * time); }

 private:
  static constexpr std::size_t kEnd = 0xFFFF;

  class AnyStream final : public Stream {
   public:
    explicit AnyStream(AnyPeer* peer) : peer_(peer) {}
    int Read(std::span<std::byte> to) noexcept override {
      closed_ = closed_ || peer_->Ends();
      return closed_ ? kClosed : peer_->Give(to, false);
    }
    bool Write(std::span<const std::byte>) noexcept override { return !closed_; }

   private:
    AnyPeer* peer_;
    bool closed_ = false;
  };

  class AnyDatagrams final : public Datagrams {
   public:
    AnyDatagrams(AnyPeer* peer, std::uint16_t port) : peer_(peer), port_(port) {}
    int Receive(std::span<std::byte> to) noexcept override { return peer_->Give(to, true); }
    bool Send(std::span<const std::byte>) noexcept override { return true; }
    std::uint16_t port() const noexcept override { return port_; }
    std::uint64_t strangers() const noexcept override { return 0; }

   private:
    AnyPeer* peer_;
    std::uint16_t port_;
  };

  std::size_t Byte() noexcept {
    if (rest_.empty()) return 0;
    const auto byte = std::to_integer<std::size_t>(rest_[0]);
    rest_ = rest_.subspan(1);
    return byte;
  }
  // Returns whether the current read receives data.
  bool Something() noexcept {
    if (silent_ > 0) {
      --silent_;
      return false;
    }
    if (left_ > 0) return true;
    left_ = Byte();
    left_ += 256 * Byte();
    if (left_ == 0 && !rest_.empty()) silent_ = Byte();
    if (left_ != kEnd) left_ = std::min(left_, rest_.size());
    return left_ > 0 && left_ != kEnd;
  }
  bool Ends() noexcept {
    if (left_ == 0 && silent_ == 0 && rest_.size() >= 2 && rest_[0] == std::byte{0xFF} &&
        rest_[1] == std::byte{0xFF}) {
      rest_ = rest_.subspan(2);
      return true;
    }
    return false;
  }
  // Bytes of a stream that do not fit remain for the next read, but the rest of a datagram is lost.
  int Give(std::span<std::byte> to, bool whole) noexcept {
    if (!Something()) {
      if (left_ == kEnd) left_ = 0;
      return 0;
    }
    const std::size_t size = left_, n = std::min(size, to.size());
    std::copy_n(rest_.begin(), n, to.begin());
    const std::size_t gone = whole ? size : n;
    rest_ = rest_.subspan(gone);
    left_ -= gone;
    return static_cast<int>(whole ? size : n);
  }

  std::span<const std::byte> rest_;
  std::size_t left_ = 0;               // bytes left of the piece
  std::size_t silent_ = 0;             // reads that will receive nothing
  std::uint64_t now_ = 1'000'000'000;  // [ns]
};

}  // namespace predictor
