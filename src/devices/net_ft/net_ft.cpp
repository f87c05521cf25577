#include "devices/net_ft/net_ft.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "devices/net_ft/rdt.h"

namespace predictor {
namespace {

constexpr double kTimeout = 1.0;  // for the first record [s]
// Datagrams that one tick reads: a sensor of 7 kHz sends seven, the rest is a flood.
constexpr int kMostAtOnce = 32;

std::string Hex(std::uint32_t status) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08X", static_cast<unsigned>(status));
  return text;
}

class NetFt final : public WrenchSensor {
 public:
  NetFt(const NetFtOptions& options, Network* network);
  ~NetFt() override { Ask({rdt::Command::kStop, 0}); }

  const DeviceFacts& facts() const override { return facts_; }
  Status Read(WrenchReading* reading) noexcept override;
  std::string Trouble() const override;

 private:
  void Ask(const rdt::Request& request) { datagrams_->Send(rdt::Encode(request)); }
  void Start();
  void Take(const rdt::Record& record) noexcept;

  NetFtOptions options_;
  Network* network_;
  std::unique_ptr<Datagrams> datagrams_;
  DeviceFacts facts_;
  WrenchReading reading_;
  std::uint64_t arrived_ = 0;    // [ns]
  std::uint32_t last_ = 0;       // sequence of the newest record taken
  std::uint32_t status_ = 0;     // of it
  std::uint64_t malformed_ = 0;  // datagrams dropped for their size
};

NetFt::NetFt(const NetFtOptions& options, Network* network)
    : options_(options), network_(network), datagrams_(network_->Open(options.address, 0)) {
  facts_.name = std::string(options.make == NetFtMake::kAti ? "ATI Net F/T" : "OnRobot F/T") +
                " at " + options.address.ToString() + " (driver never run on hardware)";
  facts_.rate = options.rate;
  facts_.own_wrench = true;
  Start();
}

void NetFt::Start() {
  if (options_.make == NetFtMake::kOnRobot)
    Ask({rdt::Command::kPeriod, static_cast<std::uint32_t>(std::lround(1e3 / options_.rate))});
  Ask({rdt::Command::kStream, 0});
  WrenchReading first;
  const bool heard = WaitUntil(network_, kTimeout, [&] {
    (void)Read(&first);
    return reading_.sequence > 0;
  });
  if (!heard && malformed_ > 0)
    throw DeviceError(
        options_.address,
        "sends datagrams that are no RDT records (36 bytes). Is it an ATI Net F/T, an "
        "Axia, or an OnRobot sensor?");
  if (!heard)
    throw DeviceError(options_.address,
                      "sends no force readings. Is the sensor on, RDT enabled in its settings, and "
                      "no other client connected?");
  if (status_ != 0)
    throw DeviceError(options_.address, "reports status " + Hex(status_) +
                                            "; its manual says what is wrong. Clear it first.");
}

Status NetFt::Read(WrenchReading* reading) noexcept {
  std::array<std::byte, rdt::kRecordBytes + 1> bytes;
  for (int i = 0; i < kMostAtOnce; ++i) {
    const int size = datagrams_->Receive(bytes);
    if (size <= 0) break;
    const auto record = static_cast<std::size_t>(size) == rdt::kRecordBytes
                            ? rdt::DecodeRecord(std::span(bytes).first(rdt::kRecordBytes))
                            : std::nullopt;
    if (record)
      Take(*record);
    else
      ++malformed_;
  }
  reading_.link.refused = malformed_ + datagrams_->strangers();
  if (reading_.sequence > 0)
    reading_.age = 1e-9 * static_cast<double>(network_->Now() - arrived_) + options_.delay;
  *reading = reading_;
  const bool usable = (status_ & ~rdt::kSaturated & ~rdt::kAnyError) == 0;
  return usable ? Status::Ok() : Status{StopCause::kSensor};
}

// Counted in the circle of 2³² numbers: what is not newer than the last is old or given twice, and
// makes nothing young.
void NetFt::Take(const rdt::Record& record) noexcept {
  const std::uint32_t ahead = record.sequence - last_;
  if (reading_.sequence > 0 && (ahead == 0 || ahead > 0x8000'0000U)) return;
  if (reading_.sequence > 0) reading_.link.lost += ahead - 1;
  reading_.sequence += reading_.sequence > 0 ? ahead : 1;
  ++reading_.link.taken;
  last_ = record.sequence;
  arrived_ = network_->Now();
  status_ = record.status;
  reading_.saturated = (record.status & rdt::kSaturated) != 0;
  for (int i = 0; i < 6; ++i)
    reading_.F_S[i] = record.counts[static_cast<std::size_t>(i)] /
                      (i < 3 ? options_.counts_per_force : options_.counts_per_torque);
}

std::string NetFt::Trouble() const {
  if (status_ == 0) return "";
  return facts_.name + ": status " + Hex(status_) +
         (reading_.saturated ? ", force or torque beyond its range" : "");
}

}  // namespace

std::unique_ptr<WrenchSensor> ConnectNetFt(const NetFtOptions& options, Network* network) {
  return std::make_unique<NetFt>(options, network);
}

}  // namespace predictor
