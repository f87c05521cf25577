#include "devices/net_ft/net_ft.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "devices/net_ft/rdt.h"
#include "devices/wire/device_clock.h"

namespace predictor {
namespace {

constexpr double kTimeout = 1.0;   // longest wait for the first record [s]
constexpr double kAgain = 0.1;     // time after which a lost request is repeated [s]
constexpr double kObey = 0.005;    // time in which an OnRobot sensor executes a request [s]
constexpr double kRateTime = 2;    // time over which a rate is measured [s]
constexpr double kMaxRate = 7000;  // maximum rate of a Net F/T [Hz]
// The maximum number of datagrams that are read in one tick. A sensor with a rate of 7 kHz sends
// seven datagrams per tick. A much larger number is an error.
constexpr int kMaxAtOnce = 32;
// After this time without reading [s], for example while other devices are being connected, the
// buffer contains old records. In this case, all buffered records are read, and the records that
// did not fit into the buffer do not count as lost.
constexpr double kPause = 0.05;
constexpr int kMaxBuffered = 4096;
// If this many consecutive records are old or too far ahead, the sensor has restarted its counter.
constexpr int kRestarted = 16;
// A record may be ahead of the last record by at most the number of records that the sensor can
// have sent since then. This number includes this additional time [s], and a factor because the
// actual rate may differ from the rate in the file.
constexpr double kRateRoom = 2, kMaxClockLead = 0.010;

// Returns the interval between records that must be set in an OnRobot sensor for this rate [ms], or
// 0 if no interval gives this rate.
std::uint32_t PeriodOf(double rate) {
  const double period = std::round(1e3 / rate);
  return period >= 1 && std::abs(rate * period / 1e3 - 1) < kRateError
             ? static_cast<std::uint32_t>(period)
             : 0;
}

void CheckRate(const NetFtOptions& options) {
  const bool onrobot = options.make == NetFtMake::kOnRobot;
  if (onrobot ? PeriodOf(options.rate) > 0 : options.rate > 0 && options.rate <= kMaxRate) return;
  throw DeviceError(
      options.address,
      Formatted("cannot send %g readings per second (arm.sensor.sample_rate): %s.", options.rate,
                onrobot ? "the interval of an OnRobot sensor is a whole number of milliseconds. "
                          "Choose 1000, 500, 250 or 125"
                        : "a Net F/T sends at most 7000"));
}

// Describes the meaning of a status.
struct Health {
  bool usable, saturated;
};

Health HealthOf(NetFtMake make, std::uint32_t status) noexcept {
  const std::uint32_t range = make == NetFtMake::kAti ? rdt::kSaturated : rdt::kOverload;
  const std::uint32_t harmless = make == NetFtMake::kAti ? range | rdt::kAnyError : range;
  return {(status & ~harmless) == 0, (status & range) != 0};
}

std::string OnRobotWords(std::uint32_t status) {
  constexpr const char* kAxes[] = {"Tz", "Ty", "Tx", "Fz", "Fy", "Fx"};
  std::string words;
  for (unsigned i = 0; i < 6; ++i)
    if ((status & 0x10U << i) != 0) words += std::string(", ") + kAxes[i] + " outside its range";
  const std::uint32_t sensor = status >> rdt::kSensorErrorShift & 7U;
  const std::uint32_t daq = status >> rdt::kDaqErrorShift & 7U;
  if ((sensor & 1U) != 0) words += ", sensor not detected";
  if ((sensor & 2U) != 0) words += ", sensor failure";
  if ((sensor & 4U) != 0) words += ", sensor too hot or too cold";
  if ((daq & 1U) != 0) words += ", fault of its electronics";
  if ((daq & 2U) != 0) words += ", its electronics cannot reach the sensor";
  return words;
}

// Returns, for example, "status 0x00000010, Tz beyond its range".
std::string StatusWords(NetFtMake make, std::uint32_t status) {
  std::string words = Formatted("status 0x%08X", static_cast<unsigned>(status));
  if (make == NetFtMake::kOnRobot) return words + OnRobotWords(status);
  return (status & rdt::kSaturated) != 0 ? words + ", force or torque outside its range" : words;
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
  void Request();
  void Start();
  void Take(const rdt::Record& record) noexcept;
  bool IsNext(std::uint32_t ahead) const noexcept;
  void MeasureRate() noexcept;
  void Resume() noexcept {
    resumes_ = true;
    first_time_ = 0;
  }

  NetFtOptions options_;
  Network* network_;
  std::unique_ptr<Datagrams> datagrams_;
  DeviceFacts facts_;
  WrenchReading reading_;
  DeviceClock clock_{kRateError};
  std::uint64_t now_ = 0, first_time_ = 0;  // [ns]
  std::uint64_t taken_time_ = 0;            // time of the newest accepted record [ns]
  std::uint64_t first_ = 0;                 // reading at the first time
  std::uint32_t last_ = 0;                  // sequence number of the newest accepted record
  std::uint64_t malformed_ = 0;             // datagrams dropped because of their size or number
  bool resumes_ = false;                    // only buffered records have arrived since a pause
  // Other threads may call Trouble.
  std::atomic<std::uint32_t> status_ = 0;  // status of the newest record
  std::atomic<int> behind_ = 0;   // records since the newest one whose numbers were rejected
  std::atomic<double> rate_ = 0;  // measured rate [Hz]; 0: not measured yet
};

NetFt::NetFt(const NetFtOptions& options, Network* network) : options_(options), network_(network) {
  CheckRate(options);
  datagrams_ = network_->Open(options.address, 0);
  facts_.name = std::string(options.make == NetFtMake::kAti ? "ATI Net F/T" : "OnRobot F/T") +
                " at " + options.address.ToString() + " (driver never run on hardware)";
  facts_.rate = options.rate;
  facts_.own_wrench = true;
  Start();
}

void NetFt::Request() {
  if (options_.make == NetFtMake::kOnRobot) {
    Ask({rdt::Command::kPeriod, PeriodOf(options_.rate)});
    network_->Wait(kObey);
  }
  Ask({rdt::Command::kStream, 0});
}

void NetFt::Start() {
  WrenchReading first;
  const std::uint64_t end = network_->Now() + static_cast<std::uint64_t>(1e9 * kTimeout);
  bool heard = false;
  while (!heard && network_->Now() < end) {
    Request();
    heard = WaitUntil(network_, kAgain, [&] {
      (void)Read(&first);
      return reading_.sequence > 0;
    });
  }
  if (!heard && malformed_ > 0)
    throw DeviceError(options_.address,
                      "sends datagrams that are not RDT records (36 bytes). Check that it is an "
                      "ATI Net F/T, an Axia or an OnRobot sensor.");
  if (!heard)
    throw DeviceError(options_.address,
                      "sends no force readings. Check that the sensor is on, that RDT is enabled "
                      "in its settings, and that no other client is connected.");
  if (status_ != 0)
    throw DeviceError(options_.address, "reports " + StatusWords(options_.make, status_) +
                                            ". Clear this error first. See the sensor's manual.");
}

Status NetFt::Read(WrenchReading* reading) noexcept {
  const std::uint64_t before = std::exchange(now_, network_->Now());
  const bool paused = now_ - before > static_cast<std::uint64_t>(1e9 * kPause);
  if (paused) Resume();
  const std::uint64_t taken = reading_.link.taken;
  std::array<std::byte, rdt::kRecordBytes + 1> bytes;
  for (int i = 0; i < (paused ? kMaxBuffered : kMaxAtOnce); ++i) {
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
  resumes_ = resumes_ && (paused || reading_.link.taken == taken);
  reading_.link.refused = malformed_ + datagrams_->strangers();
  if (reading_.sequence > 0) reading_.age = clock_.Age(now_);
  *reading = reading_;
  return HealthOf(options_.make, status_).usable ? Status::Ok() : Status{StopCause::kSensor};
}

// A record that is further ahead is forged or damaged. If such a record were accepted as the
// newest, all later records would count as old. If records were buffered for a long time, their
// counters lag behind by the age of the records.
bool NetFt::IsNext(std::uint32_t ahead) const noexcept {
  const double since = 1e-9 * static_cast<double>(now_ - taken_time_);
  return ahead <=
         1 + options_.rate * (kRateRoom * std::max(since, clock_.Age(now_)) + kMaxClockLead);
}

// Compares numbers modulo 2³². A record that is not newer than the last one is old or repeated and
// does not reset the age.
void NetFt::Take(const rdt::Record& record) noexcept {
  const std::uint32_t ahead = record.sequence - last_;
  if (reading_.sequence > 0 && (ahead == 0 || ahead > 0x8000'0000U)) {
    if (ahead != 0) ++behind_;
    return;
  }
  if (reading_.sequence > 0 && !IsNext(ahead)) {
    ++behind_;
    ++malformed_;
    return;
  }
  behind_ = 0;
  taken_time_ = now_;
  if (reading_.sequence > 0 && !resumes_) reading_.link.lost += ahead - 1;
  reading_.sequence += reading_.sequence > 0 ? ahead : 1;
  ++reading_.link.taken;
  last_ = record.sequence;
  clock_.Arrived(static_cast<double>(reading_.sequence) / options_.rate, now_);
  MeasureRate();
  status_ = record.status;
  reading_.saturated = HealthOf(options_.make, record.status).saturated;
  for (int i = 0; i < 6; ++i)
    reading_.F_S[i] = record.counts[static_cast<std::size_t>(i)] /
                      (i < 3 ? options_.counts_per_force : options_.counts_per_torque);
}

// Measures the rate over the last seconds.
void NetFt::MeasureRate() noexcept {
  if (first_time_ == 0) {
    first_time_ = now_;
    first_ = reading_.sequence;
  }
  const double time = 1e-9 * static_cast<double>(now_ - first_time_);
  if (time < kRateTime) return;
  rate_ = static_cast<double>(reading_.sequence - first_) / time;
  first_time_ = now_;
  first_ = reading_.sequence;
}

std::string NetFt::Trouble() const {
  if (status_ != 0) return facts_.name + ": " + StatusWords(options_.make, status_) + ".";
  if (behind_ >= kRestarted)
    return facts_.name +
           ": has restarted its counter, as after a reboot, so its later readings cannot be "
           "trusted. Restart this program.";
  if (rate_ == 0 || std::abs(rate_ / options_.rate - 1) <= kRateError) return "";
  return facts_.name + Formatted(
                           ": sends %.1f readings per second, but the machine file says %g "
                           "(arm.sensor.sample_rate). The age of the readings is computed from "
                           "this rate. Correct the rate in the sensor or in the machine file. If "
                           "readings are delayed, check the network.",
                           rate_.load(), options_.rate);
}

}  // namespace

std::unique_ptr<WrenchSensor> ConnectNetFt(const NetFtOptions& options, Network* network) {
  return std::make_unique<NetFt>(options, network);
}

}  // namespace predictor
