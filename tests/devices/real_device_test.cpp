// Combines arms and sensors of different manufacturers and sample rates into one device.
#include "devices/real_device.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fakes/memory_network.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

struct Said {
  ArmReading reading;
  Status status;
  JointVector v;
  bool motion = false;
  bool power_off = false;
};

class SaysSo final : public Arm {
 public:
  SaysSo(Said* said, bool own_wrench) : said_(said) {
    facts_.name = "an arm";
    facts_.own_wrench = own_wrench;
  }
  const DeviceFacts& facts() const override { return facts_; }
  Status Read(ArmReading* reading) noexcept override {
    *reading = said_->reading;
    return said_->status;
  }
  Status Write(const JointVector& v, bool motion) noexcept override {
    said_->v = v;
    said_->motion = motion;
    return {};
  }
  void PowerOff(bool wanted) noexcept override { said_->power_off = wanted; }
  std::string Trouble() const override { return said_->status.ok() ? "" : "trouble"; }

 private:
  Said* said_;
  DeviceFacts facts_;
};

class Sensor final : public WrenchSensor {
 public:
  Sensor(const WrenchReading* reading, const Status* status) : reading_(reading), status_(status) {
    facts_.name = "a sensor";
  }
  const DeviceFacts& facts() const override { return facts_; }
  Status Read(WrenchReading* reading) noexcept override {
    *reading = *reading_;
    return *status_;
  }
  std::string Trouble() const override { return ""; }

 private:
  const WrenchReading* reading_;
  const Status* status_;
  DeviceFacts facts_;
};

class RealDeviceTest : public testing::Test {
 protected:
  RealDeviceTest() {
    for (Said& said : said_) {
      said.reading.q = JointVector::LinSpaced(6, 0.1, 0.6);
      said.reading.v = JointVector::Constant(6, 0.3);
      said.reading.sequence = 7;
      said.reading.age = 0;
      said.reading.wrench.F_S << 1, 2, 3, 4, 5, 6;
      said.reading.wrench.age = 0;
    }
    outside_.F_S.setConstant(9);
    outside_.sequence = 70;
    outside_.age = 0.0005;
    std::array<RealSide, kHands> sides;
    sides[0] = {std::make_unique<SaysSo>(&said_[0], true), nullptr};
    sides[1] = {std::make_unique<SaysSo>(&said_[1], false),
                std::make_unique<Sensor>(&outside_, &sensed_)};
    device_ = std::make_unique<RealDevice>(std::make_unique<MemoryNetwork>(), std::move(sides));
  }
  DeviceCommand Command(RunState state, double v) const {
    DeviceCommand command;
    command.state = state;
    for (JointVector& x : command.v) x.setConstant(6, v);
    return command;
  }

  std::array<Said, kHands> said_;
  WrenchReading outside_;
  Status sensed_;
  std::unique_ptr<RealDevice> device_;
};

TEST_F(RealDeviceTest, ReportsWhichArmIsStillBroughtToRestAndWhichCannotMoveYet) {
  for (const std::size_t hand : {0, 1}) {
    said_[hand].reading.in_motion = said_[1 - hand].reading.waits = true;
    said_[1 - hand].reading.in_motion = said_[hand].reading.waits = false;
    DeviceSample sample;
    (void)device_->Read(&sample);
    EXPECT_TRUE(sample.arms[hand].in_motion);
    EXPECT_FALSE(sample.arms[1 - hand].in_motion);
    EXPECT_FALSE(sample.arms[hand].waits);
    EXPECT_TRUE(sample.arms[1 - hand].waits);
  }
}

TEST_F(RealDeviceTest, TakesTheWrenchOfTheSensorOrOfTheArm) {
  DeviceSample sample;
  EXPECT_TRUE(device_->Read(&sample).ok());
  EXPECT_EQ(sample.arms[0].F_S_raw, said_[0].reading.wrench.F_S);
  EXPECT_EQ(sample.arms[1].F_S_raw, outside_.F_S);
  EXPECT_EQ(sample.arms[1].sensor_sequence, 70u);
  EXPECT_EQ(sample.arms[1].sensor_age, 0.0005);
  EXPECT_NE(device_->Describe().find("a sensor"), std::string::npos);
}

// Between samples, the device extrapolates the joints with their command, so a new sample causes no
// step.
TEST_F(RealDeviceTest, JointsAreExtrapolatedBetweenSamples) {
  ASSERT_TRUE(device_->Write(Command(RunState::kRun, 0.2)).ok());
  DeviceSample sample;
  for (int ms = 0; ms < 8; ++ms) {
    said_[0].reading.age = 0.001 * ms;
    ASSERT_TRUE(device_->Read(&sample).ok());
    EXPECT_NEAR(sample.arms[0].q[2], said_[0].reading.q[2] + 0.2 * 0.001 * ms, 1e-15);
    EXPECT_EQ(sample.arms[0].v[2], 0.3);  // as measured
    EXPECT_EQ(sample.arms[0].arm_sequence, 7u);
  }
  said_[0].reading.age = 5;
  ASSERT_TRUE(device_->Read(&sample).ok());
  EXPECT_NEAR(sample.arms[0].q[2], said_[0].reading.q[2] + 0.2 * 0.010, 1e-15);
}

TEST_F(RealDeviceTest, JointsAreWhereTheyWereBeforeTheFirstCommand) {
  DeviceSample sample;
  said_[0].reading.age = 0.005;
  ASSERT_TRUE(device_->Read(&sample).ok());
  EXPECT_EQ(sample.arms[0].q, said_[0].reading.q);
}

// The monitor uses the ages and range flags that this test checks.
TEST_F(RealDeviceTest, ReportsAgesAndWhatIsBeyondItsRange) {
  said_[0].reading.age = 0.003;
  said_[1].reading.age = 0.004;
  said_[0].reading.wrench.age = 0.006;
  said_[0].reading.wrench.saturated = true;
  DeviceSample sample;
  ASSERT_TRUE(device_->Read(&sample).ok());
  EXPECT_EQ(sample.arms[0].arm_age, 0.003);
  EXPECT_EQ(sample.arms[1].arm_age, 0.004);
  EXPECT_EQ(sample.arms[0].sensor_age, 0.006);
  EXPECT_EQ(sample.arms[1].sensor_age, 0.0005);
  EXPECT_TRUE(sample.arms[0].sensor_saturated);
  EXPECT_FALSE(sample.arms[1].sensor_saturated);
}

TEST_F(RealDeviceTest, NamesTheHandWithTheFault) {
  said_[1].status = {StopCause::kDevice};
  said_[1].reading.fault = true;
  DeviceSample sample;
  const Status status = device_->Read(&sample);
  EXPECT_EQ(status.cause, StopCause::kDevice);
  EXPECT_EQ(status.hand, 1);
  EXPECT_TRUE(sample.arms[1].fault);
  EXPECT_FALSE(sample.arms[0].fault);
  EXPECT_EQ(device_->Trouble(), "right: trouble");
}

TEST_F(RealDeviceTest, NamesTheHandWithTheSensorFault) {
  sensed_ = {StopCause::kSensor};
  DeviceSample sample;
  const Status status = device_->Read(&sample);
  EXPECT_EQ(status.cause, StopCause::kSensor);
  EXPECT_EQ(status.hand, 1);
}

// The device reports the first fault, but the most severe one determines how the stop ends.
TEST_F(RealDeviceTest, EndsWithoutPowerIfAnyArmMustNotBeHeld) {
  const Status holds{StopCause::kDevice};
  Status ends = holds;
  ends.power_off = true;
  DeviceSample sample;
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      said_[0].status = first ? ends : holds;
      said_[1].status = second ? ends : holds;
      const Status status = device_->Read(&sample);
      EXPECT_EQ(status.hand, second && !first ? 1 : 0);  // the hand with the reported fault
      EXPECT_EQ(status.power_off, first || second) << first << second;
    }
}

TEST_F(RealDeviceTest, ReportsWhichOfArmAndSensorIsSilent) {
  DeviceSample sample;
  const auto reported = [&] {
    EXPECT_TRUE(device_->Read(&sample).ok());
    return device_->Trouble();
  };
  EXPECT_EQ(reported(), "");
  outside_.age = 0.051;
  EXPECT_TRUE(reported().starts_with("right: the sensor, a sensor, no longer sends new data"))
      << reported();
  said_[1].reading.age = 0.051;  // if both are silent, the arm is reported first
  EXPECT_TRUE(reported().starts_with("right: the arm, an arm, no longer sends new data"))
      << reported();
  outside_.age = said_[1].reading.age = 0.049;
  EXPECT_EQ(reported(), "");
  said_[0].reading.wrench.age = 0.051;
  EXPECT_TRUE(reported().starts_with("left: the arm, an arm, no longer sends a wrench"))
      << reported();
  // If a driver reports its own fault, the device adds nothing to the message.
  said_[0].status = {StopCause::kDevice};
  said_[0].reading.age = 1;
  EXPECT_FALSE(device_->Read(&sample).ok());
  EXPECT_EQ(device_->Trouble(), "left: trouble");
}

TEST_F(RealDeviceTest, MovesOnlyInStatesThatMove) {
  for (int s = 0; s < kRunStates; ++s) {
    const auto state = static_cast<RunState>(s);
    ASSERT_TRUE(device_->Write(Command(state, 0)).ok());
    const bool moves = state == RunState::kAlign || state == RunState::kRun ||
                       state == RunState::kStopping || state == RunState::kRecovery;
    for (const Said& said : said_) EXPECT_EQ(said.motion, moves) << Name(state);
  }
}

TEST_F(RealDeviceTest, RequestsPowerOffOnlyWhileUnpowered) {
  for (int s = 0; s < kRunStates; ++s) {
    const auto state = static_cast<RunState>(s);
    ASSERT_TRUE(device_->Write(Command(state, 0)).ok());
    for (const Said& said : said_) EXPECT_EQ(said.power_off, state == RunState::kUnpowered);
  }
}

TEST_F(RealDeviceTest, ReportsWhichArmKeepsItsPowerAndWhichCannotCutIt) {
  said_[0].reading.keeps_power = true;
  said_[1].reading.no_power_off = true;
  DeviceSample sample;
  (void)device_->Read(&sample);
  EXPECT_TRUE(sample.arms[0].keeps_power);
  EXPECT_FALSE(sample.arms[1].keeps_power);
  EXPECT_TRUE(sample.arms[1].no_power_off);
  EXPECT_FALSE(sample.arms[0].no_power_off);
}

TEST_F(RealDeviceTest, AnArmWithoutAWrenchNeedsASensor) {
  std::array<RealSide, kHands> sides;
  sides[0] = {std::make_unique<SaysSo>(&said_[0], false), nullptr};
  EXPECT_THROW(RealDevice(std::make_unique<MemoryNetwork>(), std::move(sides)), DeviceError);
}

TEST_F(RealDeviceTest, AnEnablingDeviceIsPressedReleasedOrSilent) {
  EXPECT_EQ(device_->enabling(), Enabling::kNone);
  std::array<RealSide, kHands> sides;
  sides[1] = {std::make_unique<SaysSo>(&said_[1], true), nullptr};
  RealDevice device(std::make_unique<MemoryNetwork>(), std::move(sides), EnablingSource{1, 17});
  DeviceSample sample;
  EXPECT_EQ(device.enabling(), Enabling::kSilent);  // nothing has been read yet
  const auto now = [&](std::uint64_t inputs, double age) {
    said_[1].reading.inputs = inputs;
    said_[1].reading.age = age;
    static_cast<void>(device.Read(&sample));
    return device.enabling();
  };
  EXPECT_EQ(now(std::uint64_t{1} << 17, 0.002), Enabling::kPressed);
  EXPECT_EQ(now(~(std::uint64_t{1} << 17), 0.002), Enabling::kReleased);
  EXPECT_EQ(now(std::uint64_t{1} << 17, 0.030), Enabling::kSilent);
  EXPECT_EQ(now(std::uint64_t{1} << 17, std::nan("")), Enabling::kSilent);
  EXPECT_THROW(RealDevice(std::make_unique<MemoryNetwork>(), {}, EnablingSource{0, 1}),
               DeviceError);
}

TEST_F(RealDeviceTest, DoesNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  DeviceSample sample;
  const DeviceCommand command = Command(RunState::kRun, 0.1);
  const test::AllocationGuard guard;
  for (int i = 0; i < 100; ++i) {
    (void)device_->Read(&sample);
    (void)device_->Write(command);
  }
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace predictor
