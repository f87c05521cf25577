#include "devices/net_ft/net_ft.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "devices/net_ft/rdt.h"
#include "fakes/faulty_network.h"
#include "fakes/memory_network.h"
#include "fakes/net_ft/fake_net_ft.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

constexpr const char* kHost = "192.0.2.30";

std::vector<int> Numbers(std::span<const std::byte> bytes) {
  std::vector<int> numbers;
  for (const std::byte b : bytes) numbers.push_back(std::to_integer<int>(b));
  return numbers;
}

// The expected request, which starts a stream without an end, is from ATI's manual.
TEST(Rdt, RequestIsAsInTheManual) {
  EXPECT_EQ(Numbers(rdt::Encode({rdt::Command::kStream, 0})),
            (std::vector<int>{0x12, 0x34, 0, 2, 0, 0, 0, 0}));
}

TEST(Rdt, RecordHasItsFieldsWhereTheManualSays) {
  rdt::Record record;
  record.sequence = 0x01020304;
  record.sample = 0x05060708;
  record.status = 0x80020000;
  record.counts = {1, -1, 0x7fffffff, std::numeric_limits<std::int32_t>::min(), 256, -256};
  const auto bytes = rdt::Encode(record);
  EXPECT_EQ(Numbers(bytes),
            (std::vector<int>{1,    2, 3, 4, 5,    6,    7,    8,    0x80, 2,    0,    0,
                              0,    0, 0, 1, 0xff, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff,
                              0x80, 0, 0, 0, 0,    0,    1,    0,    0xff, 0xff, 0xff, 0}));
  const auto again = rdt::DecodeRecord(bytes);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->counts, record.counts);
  EXPECT_EQ(again->status, record.status);
}

TEST(Rdt, TakesNoOtherSize) {
  const auto bytes = rdt::Encode(rdt::Record{});
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(rdt::DecodeRecord(std::span(bytes).first(size))) << size;
  std::array<std::byte, rdt::kRecordBytes + 1> longer{};
  EXPECT_FALSE(rdt::DecodeRecord(longer));
  std::array<std::byte, rdt::kRequestBytes> foreign{};
  EXPECT_FALSE(rdt::DecodeRequest(foreign));
}

class NetFtTest : public testing::Test {
 protected:
  std::unique_ptr<WrenchSensor> Connect(const FakeOptions& fake = {},
                                        NetFtMake make = NetFtMake::kAti) {
    fake_ = MakeFakeNetFt(fake);
    network_.Add(kHost, fake_.get(), &mechanics_);
    NetFtOptions options;
    options.make = make;
    options.address = {kHost, rdt::kPort};
    if (make == NetFtMake::kOnRobot) {
      options.counts_per_force = 1e4;
      options.counts_per_torque = 1e5;
    }
    return ConnectNetFt(options, &network_);
  }

  // Returns the error message of a failed connection.
  std::string Refusal(const std::string& trouble, const FakeOptions& options = {}) {
    fake_ = MakeFakeNetFt(options);
    EXPECT_TRUE(trouble.empty() || fake_->Do(trouble));
    network_.Add(kHost, fake_.get(), &mechanics_);
    try {
      ConnectNetFt({NetFtMake::kAti, {kHost, rdt::kPort}}, &network_);
    } catch (const DeviceError& error) {
      return error.what();
    }
    return "";
  }

  MemoryNetwork network_;
  Mechanics mechanics_;
  std::unique_ptr<FakeDevice> fake_;
};

TEST_F(NetFtTest, GivesTheWrenchInNewtons) {
  mechanics_.sample.F_S_raw << 1, -2, 30.5, 0.1, -0.2, 3;
  for (const NetFtMake make : {NetFtMake::kAti, NetFtMake::kOnRobot}) {
    const auto sensor =
        Connect(make == NetFtMake::kAti ? FakeOptions{} : FakeOptions{{"onrobot", ""}}, make);
    network_.Pass(0.005);
    WrenchReading reading;
    EXPECT_TRUE(sensor->Read(&reading).ok());
    EXPECT_LT((reading.F_S - mechanics_.sample.F_S_raw).norm(), 1e-4);
    EXPECT_LE(reading.age, 0.001);
    EXPECT_FALSE(reading.saturated);
  }
}

TEST_F(NetFtTest, ContinuesCountingWhenTheNumbersWrap) {
  const auto sensor = Connect({{"first", "4294967290"}});
  WrenchReading before, after;
  EXPECT_TRUE(sensor->Read(&before).ok());
  network_.Pass(0.020);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_EQ(after.sequence - before.sequence, 20u);
  EXPECT_LE(after.age, 0.001);
}

TEST_F(NetFtTest, AgesWhenNothingComes) {
  const auto sensor = Connect();
  for (const char* trouble : {"silent", "short", "long", "repeat"}) {
    WrenchReading reading, later;
    fake_->Do("well");
    network_.Pass(0.002);
    EXPECT_TRUE(sensor->Read(&reading).ok());
    fake_->Do(trouble);
    network_.Pass(0.050);
    EXPECT_TRUE(sensor->Read(&later).ok());
    EXPECT_NEAR(later.age - reading.age, 0.050, 1e-9) << trouble;
    EXPECT_EQ(later.sequence, reading.sequence) << trouble;
    EXPECT_EQ(later.link.taken, reading.link.taken) << trouble;
    EXPECT_EQ(later.link.lost, reading.link.lost) << trouble;
  }
}

// Readings that arrive after newer ones are outdated and must be ignored.
TEST_F(NetFtTest, IgnoresOlderReadings) {
  const auto sensor = Connect();
  network_.Pass(0.020);
  WrenchReading before, after;
  EXPECT_TRUE(sensor->Read(&before).ok());
  fake_->Do("back");
  mechanics_.sample.F_S_raw.setConstant(9);
  network_.Pass(0.025);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_EQ(after.sequence, before.sequence);
  EXPECT_EQ(after.F_S, before.F_S);
  EXPECT_NEAR(after.age - before.age, 0.025, 1e-9);
  network_.Pass(0.030);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_GT(after.sequence, before.sequence);
  EXPECT_EQ(sensor->Trouble(), "");  // the fault has passed
}

TEST_F(NetFtTest, ReportsARestartedCounter) {
  const auto sensor = Connect();
  network_.Pass(0.3);
  WrenchReading reading;
  EXPECT_TRUE(sensor->Read(&reading).ok());
  fake_->Do("restart");
  int ticks = 0;
  while (sensor->Trouble().empty() && ticks < 300) {
    network_.Pass(0.001);
    static_cast<void>(sensor->Read(&reading));
    ++ticks;
  }
  EXPECT_EQ(ticks, 16);
  EXPECT_NE(sensor->Trouble().find("has restarted its counter, as after a reboot"),
            std::string::npos);
  EXPECT_NE(sensor->Trouble().find("Restart this program"), std::string::npos);
}

// The driver must discard a record whose number the sensor cannot have reached, because it would
// make all later records look old. If the sensor continues to send such numbers, its counter has
// restarted.
TEST_F(NetFtTest, ANumberFarAheadDoesNotMakeOthersOld) {
  for (const std::uint32_t jump : {100U, 1'000'000U, 0x4000'0000U, 0x7fff'ffffU}) {
    fake_ = MakeFakeNetFt({});
    network_.Add(kHost, fake_.get(), &mechanics_);
    FaultyNetwork wire(&network_, 1);
    const auto sensor = ConnectNetFt({NetFtMake::kAti, {kHost, rdt::kPort}}, &wire);
    network_.Pass(0.100);
    WrenchReading before, after;
    ASSERT_TRUE(sensor->Read(&before).ok());
    wire.Of(kHost)->corrupt = [jump](Bytes* bytes) {
      auto record = rdt::DecodeRecord(*bytes);
      ASSERT_TRUE(record);
      record->sequence += jump;
      record->counts.fill(1'000'000);
      std::ranges::copy(rdt::Encode(*record), bytes->begin());
    };
    network_.Pass(0.001);
    ASSERT_TRUE(sensor->Read(&after).ok());
    EXPECT_EQ(after.sequence, before.sequence) << jump;
    EXPECT_EQ(after.F_S, before.F_S) << jump;
    EXPECT_EQ(after.link.refused, before.link.refused + 1) << jump;
    wire.Of(kHost)->corrupt = nullptr;
    network_.Pass(0.001);
    ASSERT_TRUE(sensor->Read(&after).ok());
    EXPECT_EQ(after.sequence, before.sequence + 2) << jump;
    EXPECT_LE(after.age, 0.001) << jump;
    EXPECT_EQ(sensor->Trouble(), "");
  }
}

// After the largest jump that still counts as a loss, the readings are delayed by some
// milliseconds. The driver must continue to use the sensor.
TEST_F(NetFtTest, ANumberSomewhatAheadCostsMilliseconds) {
  fake_ = MakeFakeNetFt({});
  network_.Add(kHost, fake_.get(), &mechanics_);
  FaultyNetwork wire(&network_, 1);
  const auto sensor = ConnectNetFt({NetFtMake::kAti, {kHost, rdt::kPort}}, &wire);
  WrenchReading reading;
  network_.Pass(0.100);
  ASSERT_TRUE(sensor->Read(&reading).ok());
  wire.Of(kHost)->corrupt = [](Bytes* bytes) {
    auto record = rdt::DecodeRecord(*bytes);
    ASSERT_TRUE(record);
    record->sequence += 8;
    std::ranges::copy(rdt::Encode(*record), bytes->begin());
  };
  network_.Pass(0.001);
  ASSERT_TRUE(sensor->Read(&reading).ok());
  wire.Of(kHost)->corrupt = nullptr;
  const std::uint64_t taken = reading.link.taken;
  for (int k = 0; k < 20; ++k) {
    network_.Pass(0.001);
    ASSERT_TRUE(sensor->Read(&reading).ok());
  }
  EXPECT_EQ(reading.link.taken, taken + 12);
}

// After a cable was disconnected, the numbers continue at the sensor's current value.
TEST_F(NetFtTest, ARecordAheadIsAcceptedAfterSilence) {
  const auto sensor = Connect();
  WrenchReading reading;
  network_.Pass(0.010);
  ASSERT_TRUE(sensor->Read(&reading).ok());
  fake_->Do("silent");
  for (int k = 0; k < 5000; ++k) {
    network_.Pass(0.001);
    ASSERT_TRUE(sensor->Read(&reading).ok());
  }
  EXPECT_NEAR(reading.age, 5, 0.002);
  fake_->Do("well");
  network_.Pass(0.001);
  ASSERT_TRUE(sensor->Read(&reading).ok());
  EXPECT_LE(reading.age, 0.001);
}

// A repeated reading means that the sensor is frozen, not that its counter has restarted.
TEST_F(NetFtTest, ARepeatedReadingIsNotNew) {
  const auto sensor = Connect();
  WrenchReading reading;
  fake_->Do("repeat");
  for (int k = 0; k < 300; ++k) {
    network_.Pass(0.001);
    static_cast<void>(sensor->Read(&reading));
  }
  EXPECT_EQ(sensor->Trouble(), "");
}

TEST_F(NetFtTest, CountsWhatIsLostAndWhatItRefuses) {
  const auto sensor = Connect();
  WrenchReading before, after;
  EXPECT_TRUE(sensor->Read(&before).ok());
  fake_->Do("skip");
  network_.Pass(0.010);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_EQ(after.link.lost - before.link.lost, 3U);
  EXPECT_EQ(after.link.taken - before.link.taken, 10U);
  EXPECT_EQ(after.link.refused, before.link.refused);
  fake_->Do("short");
  network_.Pass(0.010);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_EQ(after.link.refused - before.link.refused, 10U);
}

// The program does not read the socket while it connects to other devices. The socket's queue holds
// about 270 readings, and the system drops newer ones.
TEST_F(NetFtTest, AfterAPauseReadsTheWholeBuffer) {
  const auto sensor = Connect();
  WrenchReading before, after;
  network_.Pass(0.002);
  EXPECT_TRUE(sensor->Read(&before).ok());
  network_.Pass(0.3);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_LE(after.age, 0.001);
  fake_->Do("skip");
  network_.Pass(0.001);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_LE(after.age, 0.001);
  EXPECT_EQ(after.link.lost, before.link.lost) << "they were sent while nothing was reading";
  fake_->Do("skip");
  network_.Pass(0.001);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_EQ(after.link.lost, before.link.lost + 3);
}

TEST_F(NetFtTest, ReportsSaturationAndErrors) {
  const auto sensor = Connect();
  WrenchReading reading;
  fake_->Do("saturate");
  network_.Pass(0.002);
  EXPECT_TRUE(sensor->Read(&reading).ok());
  EXPECT_TRUE(reading.saturated);
  EXPECT_NE(sensor->Trouble().find("outside its range"), std::string::npos);
  fake_->Do("status 80010000");
  network_.Pass(0.002);
  EXPECT_EQ(sensor->Read(&reading).cause, StopCause::kSensor);
  EXPECT_NE(sensor->Trouble().find("0x80010000"), std::string::npos) << sensor->Trouble();
}

// No datagram is lost or out of order. Only the sensor's own numbers show that the delay grows.
TEST_F(NetFtTest, AQueueThatGrowsSlowlyIsDetected) {
  constexpr double kGrowth = 5e-6;  // per millisecond [s]
  for (const NetFtMake make : {NetFtMake::kAti, NetFtMake::kOnRobot}) {
    fake_ = MakeFakeNetFt(make == NetFtMake::kAti ? FakeOptions{} : FakeOptions{{"onrobot", ""}});
    network_.Add(kHost, fake_.get(), &mechanics_);
    FaultyNetwork wire(&network_, 1);
    NetFtOptions options;
    options.make = make;
    options.address = {kHost, rdt::kPort};
    const auto sensor = ConnectNetFt(options, &wire);
    WrenchReading reading;
    double delay = 0;
    int stale_after = 0;  // [ms]
    for (int k = 1; k <= 4000 && stale_after == 0; ++k) {
      wire.Of(kHost)->delay = delay = kGrowth * k;
      network_.Pass(0.001);
      ASSERT_TRUE(sensor->Read(&reading).ok());
      // The newest reading was sent some milliseconds ago, and its delay was determined then.
      EXPECT_GE(reading.age, kGrowth * (k - 10) - kRateError * 1e-3 * k) << k;
      EXPECT_LE(reading.age, delay + 0.002) << k;
      if (reading.age > 0.005) stale_after = k;
    }
    EXPECT_GT(stale_after, 0);
    EXPECT_LT(delay, 0.010);
    EXPECT_EQ(reading.link.lost, 0u);
  }
}

TEST_F(NetFtTest, ADuplicateIsNotANewReading) {
  fake_ = MakeFakeNetFt({});
  network_.Add(kHost, fake_.get(), &mechanics_);
  FaultyNetwork wire(&network_, 1);
  const auto sensor = ConnectNetFt({NetFtMake::kAti, {kHost, rdt::kPort}}, &wire);
  wire.Of(kHost)->duplicate = 1;
  WrenchReading before, after;
  ASSERT_TRUE(sensor->Read(&before).ok());
  for (int k = 0; k < 100; ++k) {
    network_.Pass(0.001);
    ASSERT_TRUE(sensor->Read(&after).ok());
  }
  EXPECT_EQ(after.sequence - before.sequence, 100u);
  EXPECT_EQ(after.link.taken - before.link.taken, 100u);
  EXPECT_EQ(after.link.lost, 0u);
}

// Small differences between clocks are normal, but the driver must report larger differences.
TEST_F(NetFtTest, ARateThatDiffersFromTheFileIsReported) {
  for (const double rate : {1000.5, 999.0, 990.0}) {
    const auto sensor = Connect({{"rate", std::to_string(rate)}});
    double oldest = 0;
    for (int k = 0; k < 5000; ++k) {
      network_.Pass(0.001);
      WrenchReading reading;
      ASSERT_TRUE(sensor->Read(&reading).ok());
      oldest = std::max(oldest, reading.age);
    }
    const std::string trouble = sensor->Trouble();
    EXPECT_EQ(trouble.empty(), rate > 998) << trouble;
    EXPECT_EQ(oldest<0.003, rate> 998) << oldest;
    if (rate > 998) continue;
    EXPECT_NE(trouble.find("sends 990.0 readings per second, but the machine file says 1000"),
              std::string::npos)
        << trouble;
  }
}

TEST_F(NetFtTest, ReportsTheErrorOfAnOnRobotSensor) {
  const auto sensor = Connect({{"onrobot", ""}}, NetFtMake::kOnRobot);
  struct Case {
    const char* status;
    bool usable, saturated;
    const char* says;
  };
  for (const Case& c : {Case{"0", true, false, ""},
                        {"200", true, true, "status 0x00000200, Fx outside its range"},
                        {"90", true, true, "Tz outside its range, Fz outside its range"},
                        {"400", false, false, "sensor not detected"},
                        {"810", false, true, "Tz outside its range, sensor failure"},
                        {"1000", false, false, "too hot or too cold"},
                        {"2000", false, false, "fault of its electronics"},
                        {"4000", false, false, "cannot reach the sensor"},
                        {"1", false, false, "status 0x00000001"},
                        {"20000", false, false, "status 0x00020000."},
                        {"80000000", false, false, "status 0x80000000"}}) {
    fake_->Do(std::string("status ") + c.status);
    network_.Pass(0.002);
    WrenchReading reading;
    EXPECT_EQ(sensor->Read(&reading).ok(), c.usable) << c.status;
    EXPECT_EQ(reading.saturated, c.saturated) << c.status;
    EXPECT_NE(sensor->Trouble().find(c.says), std::string::npos) << sensor->Trouble();
    EXPECT_EQ(sensor->Trouble().empty(), std::string(c.status) == "0");
  }
}

TEST_F(NetFtTest, RefusesRatesThatNoSensorSendsAt) {
  const auto refusal = [this](NetFtMake make, double rate) -> std::string {
    fake_ = MakeFakeNetFt(make == NetFtMake::kAti ? FakeOptions{} : FakeOptions{{"onrobot", ""}});
    network_.Add(kHost, fake_.get(), &mechanics_);
    NetFtOptions options;
    options.make = make;
    options.address = {kHost, rdt::kPort};
    options.rate = rate;
    try {
      ConnectNetFt(options, &network_);
      return "";
    } catch (const DeviceError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal(NetFtMake::kOnRobot, 2001),
            "192.0.2.30:49152 cannot send 2001 readings per second (arm.sensor.sample_rate): the "
            "interval of an OnRobot sensor is a whole number of milliseconds. Choose 1000, 500, "
            "250 or 125.");
  for (const double rate : {2000.0, 4000.0, 700.0, 0.0})
    EXPECT_NE(refusal(NetFtMake::kOnRobot, rate), "") << rate;
  for (const double rate : {1000.0, 500.0, 333.3, 125.0})
    EXPECT_EQ(refusal(NetFtMake::kOnRobot, rate), "") << rate;
  EXPECT_NE(refusal(NetFtMake::kAti, 7001).find("sends at most 7000"), std::string::npos);
  EXPECT_EQ(refusal(NetFtMake::kAti, 7000), "");
}

// The driver must repeat a lost request. The sensor then sends at the requested rate.
TEST_F(NetFtTest, RepeatsALostRequest) {
  fake_ = MakeFakeNetFt({{"onrobot", ""}});
  network_.Add(kHost, fake_.get(), &mechanics_);
  FaultyNetwork wire(&network_, 1);
  wire.Of(kHost)->deaf = true;
  int steps = 0;
  network_.SetWorld([&] { wire.Of(kHost)->deaf = ++steps < 250; });
  NetFtOptions options;
  options.make = NetFtMake::kOnRobot;
  options.address = {kHost, rdt::kPort};
  options.rate = 250;
  const auto sensor = ConnectNetFt(options, &wire);
  WrenchReading before, after;
  EXPECT_TRUE(sensor->Read(&before).ok());
  network_.Pass(0.100);
  EXPECT_TRUE(sensor->Read(&after).ok());
  EXPECT_EQ(after.sequence - before.sequence, 25u);
}

TEST_F(NetFtTest, ReportsWhyItCannotBeUsed) {
  EXPECT_EQ(Refusal("silent"),
            "192.0.2.30:49152 sends no force readings. Check that the sensor is on, that RDT is "
            "enabled in its settings, and that no other client is connected.");
  EXPECT_NE(Refusal("short").find("not RDT records"), std::string::npos);
  EXPECT_NE(Refusal("status 80010000").find("0x80010000"), std::string::npos);
}

TEST_F(NetFtTest, StopsTheStreamAtItsEnd) {
  auto sensor = Connect();
  sensor.reset();
  const auto port = network_.Open({kHost, rdt::kPort}, 0);
  network_.Pass(0.010);
  std::array<std::byte, 64> bytes;
  EXPECT_EQ(port->Receive(bytes), 0);
  EXPECT_TRUE(fake_->log().empty());
}

}  // namespace
}  // namespace predictor
