#include "devices/stop_channel.h"

#include <array>
#include <cstdint>
#include <span>

namespace predictor {
namespace {

constexpr std::uint16_t kPrimaryPort = 30001;
constexpr double kConnectTimeout = 2;  // [s]
// Longest times for which the controller may be silent [ns]. The controller sends its state to this
// port ten times per second.
constexpr std::uint64_t kSilence = 500'000'000, kLongSilence = 3'000'000'000;
constexpr const char* kBrake = "def predictor_watchdog():\n  stopj(10.0)\nend\n";

class UrStopChannel final : public StopChannel {
 public:
  UrStopChannel(const std::string& host, Network* network)
      : network_(network),
        stream_(network->Connect({host, kPrimaryPort}, kConnectTimeout)),
        heard_(network->Now()) {}

  // Unread data would eventually close the connection.
  Link Tend() noexcept override {
    if (lost_) return Link::kLost;
    std::array<std::byte, 4096> unread;
    int size = 1;
    for (int i = 0; i < kMaxReads && size > 0; ++i) {
      size = stream_->Read(unread);
      if (size > 0) heard_ = network_->Now();
    }
    const std::uint64_t silent = network_->Now() - heard_;
    lost_ = size == Stream::kClosed || silent > kLongSilence;
    if (lost_) return Link::kLost;
    return silent > kSilence ? Link::kSilent : Link::kTalks;
  }
  bool Stop() noexcept override {
    return stream_->Write(std::as_bytes(std::span(kBrake, std::char_traits<char>::length(kBrake))));
  }

 private:
  static constexpr int kMaxReads = 16;

  Network* network_;
  std::unique_ptr<Stream> stream_;
  std::uint64_t heard_;  // time of the last data [ns]
  bool lost_ = false;
};

}  // namespace

std::unique_ptr<StopChannel> OpenStopChannel(const ArmConnection& arm, Network* network) {
  if (arm.make != ArmMake::kUr) return nullptr;
  return std::make_unique<UrStopChannel>(arm.host, network);
}

}  // namespace predictor
