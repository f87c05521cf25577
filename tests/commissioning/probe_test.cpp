#include "commissioning/probe.h"

#include <gtest/gtest.h>

#include <memory>

#include "commissioning/arm_checks.h"
#include "commissioning/rig_station.h"
#include "core/error.h"
#include "core/random.h"
#include "devices/net_ft/net_ft.h"
#include "devices/net_ft/rdt.h"
#include "fakes/kinds.h"
#include "fakes/memory_network.h"

namespace predictor::commissioning {
namespace {

ProbeOptions EveryMillisecond() {
  ProbeOptions options;
  options.poll = 0.001;
  return options;
}

// A machine with one arm of the rig, in virtual time.
struct OneArm {
  explicit OneArm(double samples = 1000)
      : scenario(ArmScenario(1)), hand(scenario, &time, ArmStart(1)[0], samples) {
    machine.left = MachineArmOf(scenario);
    machine.left->arm.sample_rate = samples;
    connector.arm = [this](const MachineArm&, Network*) -> std::unique_ptr<Arm> {
      auto driver = std::make_unique<RigDriver>(&hand, own_wrench);
      driver->mutable_facts().payload = payload;
      driver->mutable_facts().rate = rate;
      return driver;
    };
    connector.sensor = [](const MachineArm&, Network*) { return nullptr; };
  }
  std::vector<Probed> Probe() {
    return ProbeMachine(machine, connector, &time, EveryMillisecond());
  }

  VirtualTime time;
  Scenario scenario;
  RigHand hand;
  Machine machine;
  Connector connector;
  bool own_wrench = true;
  double rate = 0;  // rate of its controller version [Hz]
  std::optional<ReportedPayload> payload;
};

TEST(ProbeMachine, MeasuresRateAgeAndWrench) {
  for (const double rate : {1000.0, 500.0, 125.0}) {
    OneArm one(rate);
    const JointVector before = one.hand.sample().q;
    const auto probed = one.Probe();
    ASSERT_EQ(probed.size(), 1u);
    const Probed& arm = probed[0];
    EXPECT_TRUE(arm.answers()) << arm.trouble;
    EXPECT_EQ(arm.place, "left arm");
    EXPECT_EQ(arm.name, "arm of the rig");
    EXPECT_NEAR(arm.times.rate, rate, 0.01 * rate);
    EXPECT_EQ(arm.times.lost, 0);
    for (const double interval : {arm.times.p50, arm.times.p99, arm.times.max})
      EXPECT_NEAR(interval, 1 / rate, 1e-9);
    EXPECT_NEAR(arm.times.age_max, 1 / rate - 0.001, 1e-9);
    EXPECT_TRUE(arm.remarks.empty());
    EXPECT_TRUE(AllAnswer(probed));
    EXPECT_TRUE(AllMatch(probed)) << ProbeText(probed);
    // The wrench consists of the bias and the weight, and varies only by the rig's noise.
    EXPECT_TRUE(arm.has_wrench);
    EXPECT_LT((arm.F_S - one.hand.sample().F_S_raw).head<3>().norm(), 0.3);
    EXPECT_NEAR(arm.deviation[0], 0.05, 0.01);
    EXPECT_LT((one.hand.sample().q - before).norm(), 1e-4);  // nothing moves
    const std::string text = ProbeText(probed);
    EXPECT_NE(text.find("left arm: arm of the rig"), std::string::npos) << text;
  }
}

TEST(ProbeMachine, DetectsWhatALoopOfAMillisecondWouldMiss) {
  OneArm one(1000);
  ProbeOptions slow = EveryMillisecond();
  slow.poll = 0.002;
  const auto probed = ProbeMachine(one.machine, one.connector, &one.time, slow);
  EXPECT_NEAR(probed[0].times.lost, 0.5, 0.01);
  EXPECT_NEAR(probed[0].times.rate, 1000, 10);
}

TEST(ProbeMachine, ReportsSilenceFaultAndWrongRate) {
  OneArm silent;
  silent.hand.silent = true;
  EXPECT_NE(silent.Probe()[0].trouble.find("no sample for 0.5 s"), std::string::npos);
  OneArm faulty;
  faulty.hand.trouble = "protective stop";
  const auto probed = faulty.Probe();
  EXPECT_EQ(probed[0].trouble, "protective stop");
  EXPECT_FALSE(AllAnswer(probed));
  EXPECT_NE(ProbeText(probed).find("TROUBLE"), std::string::npos);
  OneArm slow(125);
  slow.machine.left->arm.sample_rate = 500;
  const auto rated = slow.Probe();
  ASSERT_EQ(rated[0].mismatches.size(), 1u);
  EXPECT_NE(rated[0].mismatches[0].find("125 samples per second, but the machine file says 500"),
            std::string::npos);
  EXPECT_NE(rated[0].mismatches[0].find("arms.left.arm.sample_rate"), std::string::npos);
  EXPECT_TRUE(AllAnswer(rated));
  EXPECT_FALSE(AllMatch(rated));
  OneArm deaf;
  deaf.own_wrench = false;
  EXPECT_NE(deaf.Probe()[0].trouble.find("does not measure a wrench"), std::string::npos);
}

// The sample rate must be the nominal one of the controller's version, even if the network delivers
// fewer samples.
TEST(ProbeMachine, KnowsTheRateOfAVersion) {
  OneArm one(500);
  one.rate = 500;
  EXPECT_TRUE(AllMatch(one.Probe()));
  one.rate = 1000;
  const auto probed = one.Probe();
  EXPECT_NE(probed[0].mismatches.at(0).find("1000 samples"), std::string::npos);
  one.machine.left->arm.sample_rate = 1000;
  const auto lost = one.Probe();
  EXPECT_TRUE(AllMatch(lost));
  EXPECT_NE(lost[0].remarks.at(0).find("should send 1000 samples"), std::string::npos);
}

TEST(ProbeMachine, ComparesTheModelWithTheConnectedArm) {
  const auto mismatch = [](const std::function<void(OneArm*)>& change) {
    OneArm one;
    change(&one);
    const auto probed = one.Probe();
    EXPECT_TRUE(AllAnswer(probed)) << ProbeText(probed);
    EXPECT_EQ(probed[0].mismatches.size(), 1u) << ProbeText(probed);
    EXPECT_NE(ProbeText(probed).find("DIFFERS FROM THE MACHINE FILE"), std::string::npos);
    return probed[0].mismatches.empty() ? "" : probed[0].mismatches[0];
  };
  EXPECT_NE(mismatch([](OneArm* one) {
              ArmSpec& arm = one->machine.left->arm;
              arm.model = "package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf";
              arm.remove_links.clear();
              arm.end_effector = "tool0";
              arm.elbow = "forearm_link";
            }).find("arms.left.arm.model has 6 joints, but the arm that answers has 7"),
            std::string::npos);
  EXPECT_NE(mismatch([](OneArm* one) {
              one->machine.left->arm.elbow = "forearm_link";
            }).find("arms.left.arm.elbow: \"forearm_link\" is not a link"),
            std::string::npos);
  EXPECT_NE(mismatch([](OneArm* one) {
              one->hand.spoil = [](ArmSample* arm) { arm->q[3] = 1; };
            }).find("panda_joint4 is at 1.000 rad, but arms.left.arm.model allows"),
            std::string::npos);
}

TEST(ProbeMachine, ContinuesIfOneDoesNotAnswer) {
  OneArm one;
  one.machine.right = one.machine.left;
  const auto arm = one.connector.arm;
  int asked = 0;
  one.connector.arm = [&](const MachineArm& side, Network* network) -> std::unique_ptr<Arm> {
    if (asked++ == 0) throw DeviceError({"192.0.2.10", 30004}, "does not answer.");
    return arm(side, network);
  };
  const auto probed = one.Probe();
  ASSERT_EQ(probed.size(), 2u);
  EXPECT_FALSE(probed[0].answers());
  EXPECT_EQ(probed[0].trouble, "192.0.2.10:30004 does not answer.");
  EXPECT_TRUE(probed[1].answers());
  EXPECT_FALSE(AllAnswer(probed));
  EXPECT_NE(ProbeText(probed).find("left arm: DOES NOT ANSWER"), std::string::npos);
}

// Connects the real driver of a sensor through a network in memory.
TEST(ProbeMachine, MeasuresASensorOfItsOwn) {
  const auto fake = MakeFake("net_ft", {});
  Mechanics mechanics;
  mechanics.sample.present = true;
  MemoryNetwork network;
  network.Add("192.0.2.20", fake.get(), &mechanics);
  RandomStream random(1, "sensor");
  network.SetWorld([&] {
    ++mechanics.sample.sensor_sequence;
    for (double& f : mechanics.sample.F_S_raw) f = 2 + 0.01 * random.Normal();
  });
  OneArm one;  // silent, because its time stands still
  one.machine.left->sensor = {SensorMake::kNetFt, "192.0.2.20", 1e6, 1e6};
  one.connector.sensor = [](const MachineArm& side, Network* by) {
    NetFtOptions options;
    options.address = {side.sensor.host, rdt::kPort};
    return ConnectNetFt(options, by);
  };
  const auto probed = ProbeMachine(one.machine, one.connector, &network, EveryMillisecond());
  ASSERT_EQ(probed.size(), 2u);
  EXPECT_FALSE(probed[0].answers());
  const Probed& sensor = probed[1];
  EXPECT_TRUE(sensor.answers()) << sensor.trouble;
  EXPECT_EQ(sensor.place, "left sensor");
  EXPECT_NE(sensor.name.find("192.0.2.20"), std::string::npos);
  EXPECT_NEAR(sensor.times.rate, 1000, 10);
  EXPECT_NEAR(sensor.F_S[2], 2, 0.01);
}

TEST(PayloadRefusal, ComparesMassAndCentreOfGravity) {
  DeviceFacts facts;
  MachineArm side;
  side.arm.payload.mass = 0.5;
  side.arm.payload.center_of_mass = {0, 0, 0.06};
  side.arm.sensor.pose.xyz = {0, 0, 0.02};
  EXPECT_EQ(PayloadRefusal(facts, side), "");  // the arm reports no payload
  facts.payload = ReportedPayload{0.52, {0, 0, 0.08}};
  EXPECT_EQ(PayloadRefusal(facts, side), "");
  facts.payload = ReportedPayload{0, {0, 0, 0}};
  EXPECT_NE(PayloadRefusal(facts, side).find("Enter 0.50 kg at the pendant"), std::string::npos);
  facts.payload = ReportedPayload{1.2, {0, 0, 0.08}};
  EXPECT_NE(PayloadRefusal(facts, side).find("set to 1.20 kg"), std::string::npos);
  facts.payload = ReportedPayload{0.5, {0, 0.05, 0.08}};
  EXPECT_NE(PayloadRefusal(facts, side).find("centre of gravity at (0, 50, 80) mm"),
            std::string::npos);
  // A separate sensor adds its own weight and shifts the centre of gravity accordingly.
  side.sensor.make = SensorMake::kNetFt;
  EXPECT_NE(PayloadRefusal(facts, side).find("of sensor and handle together at the pendant"),
            std::string::npos);
  for (const double z : {0.79, 0.81}) {  // 0.5 kg at 80 mm, 0.5 kg within 100 mm, 0.01 kg·m
    facts.payload = ReportedPayload{1, {0, 0, 0.04 + 0.05 + 0.01 + 0.01 * (z - 0.8)}};
    EXPECT_EQ(PayloadRefusal(facts, side).empty(), z < 0.8) << z;
  }
  facts.payload = ReportedPayload{1.2, {0, 0, 0.03}};
  EXPECT_EQ(PayloadRefusal(facts, side), "");
  facts.payload = ReportedPayload{2.0, {0, 0, 0.03}};
  EXPECT_NE(PayloadRefusal(facts, side).find("the sensor's mass"), std::string::npos);
}

TEST(PayloadRefusal, OfAnArmThatTakesItOffItselfOnlyOneMayHaveTheWeight) {
  DeviceFacts facts;
  facts.payload_taken_off = true;
  MachineArm side;
  for (const double reported : {0.0, 0.5})
    for (const double ours : {0.0, 0.5}) {
      facts.payload = ReportedPayload{reported, {0, 0, 0.08}};
      side.arm.payload.mass = ours;
      EXPECT_EQ(PayloadRefusal(facts, side).find("subtracted twice") != std::string::npos,
                reported > 0 && ours > 0);
    }
  // With a separate sensor, the program must not use the arm's own estimate.
  side.sensor.make = SensorMake::kNetFt;
  side.arm.payload.center_of_mass = {0, 0, 0.08};
  EXPECT_EQ(PayloadRefusal(facts, side), "");
}

}  // namespace
}  // namespace predictor::commissioning
