#include "devices/stop_channel.h"

#include <array>
#include <span>

namespace predictor {
namespace {

constexpr std::uint16_t kPrimaryPort = 30001;
constexpr double kTimeout = 2;  // [s]
constexpr const char* kBrake = "def predictor_watchdog():\n  stopj(10.0)\nend\n";

class UrStopChannel final : public StopChannel {
 public:
  UrStopChannel(const std::string& host, Network* network)
      : stream_(network->Connect({host, kPrimaryPort}, kTimeout)) {}

  // The controller tells its state here all the time; what nobody reads would close the connection.
  void Tend() noexcept override {
    std::array<std::byte, 4096> unread;
    for (int i = 0; i < kMostReads && stream_->Read(unread) > 0; ++i) {
    }
  }
  bool Stop() noexcept override {
    return stream_->Write(std::as_bytes(std::span(kBrake, std::char_traits<char>::length(kBrake))));
  }

 private:
  static constexpr int kMostReads = 16;

  std::unique_ptr<Stream> stream_;
};

}  // namespace

std::unique_ptr<StopChannel> OpenStopChannel(const ArmConnection& arm, Network* network) {
  if (arm.make != ArmMake::kUr) return nullptr;
  return std::make_unique<UrStopChannel>(arm.host, network);
}

}  // namespace predictor
