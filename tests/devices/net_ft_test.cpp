#include "devices/net_ft/net_ft.h"

#include <gtest/gtest.h>

#include <limits>

#include "devices/net_ft/rdt.h"
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

// As printed in ATI's manual: the request that starts an endless stream.
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

  // What connecting says when it fails.
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

TEST_F(NetFtTest, CountsOnOverTheEndOfTheNumbers) {
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
  }
}

// They come behind newer ones: old, and not to be taken.
TEST_F(NetFtTest, DoesNotGoBack) {
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

TEST_F(NetFtTest, TellsSaturationAndErrors) {
  const auto sensor = Connect();
  WrenchReading reading;
  fake_->Do("saturate");
  network_.Pass(0.002);
  EXPECT_TRUE(sensor->Read(&reading).ok());
  EXPECT_TRUE(reading.saturated);
  EXPECT_NE(sensor->Trouble().find("beyond its range"), std::string::npos);
  fake_->Do("status 80010000");
  network_.Pass(0.002);
  EXPECT_EQ(sensor->Read(&reading).cause, StopCause::kSensor);
  EXPECT_NE(sensor->Trouble().find("0x80010000"), std::string::npos) << sensor->Trouble();
}

TEST_F(NetFtTest, SaysWhyItCannotBeUsed) {
  EXPECT_EQ(Refusal("silent"),
            "192.0.2.30:49152 sends no force readings. Is the sensor on, RDT enabled in its "
            "settings, and no other client connected?");
  EXPECT_NE(Refusal("short").find("no RDT records"), std::string::npos);
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
