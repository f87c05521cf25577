// Tests faults of a Franka arm and the messages about them.
#include <gtest/gtest.h>

#include <string>

#include "devices/franka/fault_record.h"
#include "devices/franka_rig.h"
#include "fakes/held_network.h"
#include "support/allocation_guard.h"
#include "support/text.h"

namespace predictor {
namespace {

class FrankaFault : public testing::TestWithParam<std::uint16_t> {
 protected:
  FrankaFault() : rig_(FrankaOfVersion(GetParam())) {}

  // Applies a fault in motion and returns the time until the driver reports the fault [ms].
  int TicksUntilReported(const std::string& what) {
    Move();
    EXPECT_TRUE(rig_.fake.Do(what)) << what;
    int ticks = 1;
    while (rig_.Tick() && ticks < 3000) ++ticks;
    return ticks;
  }
  void Move() {
    rig_.Connect();
    rig_.v.setConstant(0.2);
    ASSERT_TRUE(rig_.Ticks(100));
  }
  // Applies a fault at rest. The driver must report the fault immediately with the given words.
  void ExpectMessageAtRest(const std::string& what, const std::string& words) {
    rig_.Connect();
    ASSERT_TRUE(rig_.Ticks(10, false));
    ASSERT_TRUE(rig_.fake.Do(what)) << what;
    EXPECT_FALSE(rig_.Tick(false));
    ExpectMessage(words);
  }
  // The fault must persist in the results of Read and Write and in the reading, and the driver must
  // send no more commands.
  void ExpectMessage(const std::string& words) {
    EXPECT_TRUE(Contains(rig_.arm->Trouble(), words)) << rig_.arm->Trouble();
    EXPECT_TRUE(Contains(rig_.arm->Trouble(), "192.0.2.10:1337 ")) << rig_.arm->Trouble();
    const std::uint64_t commands = rig_.arm->counts().commands;
    for (int i = 0; i < 50; ++i) {
      EXPECT_FALSE(rig_.Tick());
      EXPECT_EQ(rig_.read.cause, StopCause::kDevice);
      EXPECT_EQ(rig_.written.cause, StopCause::kDevice);
      EXPECT_TRUE(rig_.reading.fault);
    }
    EXPECT_EQ(rig_.arm->counts().commands, commands);
    EXPECT_TRUE(Contains(rig_.arm->Trouble(), words)) << rig_.arm->Trouble();
  }

  FrankaRig rig_;
};

TEST_P(FrankaFault, ReflexIsNamed) {
  EXPECT_LE(TicksUntilReported("reflex joint_velocity_violation"), 2);
  ExpectMessage("stopped by a reflex (joint velocity violation)");
}

TEST_P(FrankaFault, ReflexAtRestIsNamed) {
  ExpectMessageAtRest("reflex cartesian_reflex", "is stopped by a reflex (cartesian reflex)");
}

TEST_P(FrankaFault, ErrorThatChangesNoModeIsNamed) {
  ExpectMessageAtRest("error power_limit_violation", "reports an error (power limit violation)");
}

TEST_P(FrankaFault, IsNeverClearedByTheDriver) {
  TicksUntilReported("reflex joint_reflex");
  ASSERT_TRUE(rig_.fake.Do("release"));
  ExpectMessage("joint reflex");
  for (const std::string& line : rig_.fake.log()) EXPECT_FALSE(Contains(line, "recovery"));
}

TEST_P(FrankaFault, UserStop) {
  EXPECT_LE(TicksUntilReported("user stop"), 2);
  ExpectMessage("stopped by");
  EXPECT_TRUE(Contains(rig_.arm->Trouble(), "user stop"));
}

TEST_P(FrankaFault, EmergencyStop) {
  EXPECT_LE(TicksUntilReported("emergency stop"), 2);
  ExpectMessage("");
}

TEST_P(FrankaFault, GuidingByHand) {
  EXPECT_LE(TicksUntilReported("guide"), 2);
  ExpectMessage("");
}

// If a person has pressed the stop button or the state of the arm is unknown, the arm must not
// remain powered. If the arm reports a fault and holds itself at rest, it may remain powered.
TEST_P(FrankaFault, EndsWithoutPowerIfTheArmMustNotBeHeld) {
  const std::vector<std::pair<const char*, bool>> ends = {
      {"user stop", true}, {"emergency stop", true},       {"drop link", true}, {"freeze", true},
      {"babble", true},    {"reflex joint_reflex", false}, {"guide", false}};
  for (const auto& [what, power_off] : ends) {
    for (const bool motion : {false, true}) {
      FrankaRig rig(FrankaOfVersion(GetParam()));
      rig.Connect();
      ASSERT_TRUE(rig.Ticks(50, motion));
      ASSERT_TRUE(rig.fake.Do(what));
      ASSERT_FALSE(rig.Ticks(30, motion)) << what;
      EXPECT_EQ(rig.read.power_off, power_off) << what << motion;
    }
  }
}

TEST(FrankaFaultRecord, EndsWithoutPowerByWhatTheArmAnswersOrSaysThatItIs) {
  using fci::Fault, fci::MoveStatus, fci::RobotMode;
  const auto ends = [](Fault fault, auto detail) {
    return fci::EndsWithoutPower({fault, static_cast<std::int8_t>(detail)});
  };
  EXPECT_TRUE(ends(Fault::kMove, MoveStatus::kEmergencyAborted));
  EXPECT_FALSE(ends(Fault::kMove, MoveStatus::kReflexAborted));
  EXPECT_FALSE(ends(Fault::kMove, MoveStatus::kAborted));
  EXPECT_TRUE(ends(Fault::kMode, RobotMode::kUserStopped));
  EXPECT_TRUE(ends(Fault::kMode, RobotMode::kOther));
  EXPECT_FALSE(ends(Fault::kMode, RobotMode::kReflex));
  for (const Fault fault : {Fault::kClosed, Fault::kNonsense, Fault::kSilent})
    EXPECT_TRUE(ends(fault, 0));
  for (const Fault fault : {Fault::kNone, Fault::kError, Fault::kNoStart, Fault::kNoEnd})
    EXPECT_FALSE(ends(fault, 0));
}

TEST_P(FrankaFault, InvalidAnswers) {
  EXPECT_LE(TicksUntilReported("babble"), 2);
  ExpectMessage("sent an answer that does not belong to the Franka Control Interface");
}

TEST_P(FrankaFault, AnswerWithoutARequest) {
  EXPECT_LE(TicksUntilReported("answer another"), 2);
  ExpectMessage("sent an answer that does not belong to the Franka Control Interface");
}

TEST_P(FrankaFault, MotionThatEndsWithoutAnAnswer) {
  EXPECT_LE(TicksUntilReported("forget"), 2);
  ExpectMessage("aborted the motion");
}

// The fault remains latched even if the arm becomes ready again.
TEST_P(FrankaFault, NoMotionBeginsAfterAFault) {
  rig_.Connect();
  ASSERT_TRUE(rig_.fake.Do("reflex joint_reflex"));
  ASSERT_FALSE(rig_.Ticks(2, false));
  ASSERT_TRUE(rig_.fake.Do("release"));
  EXPECT_FALSE(rig_.Ticks(100));
  EXPECT_EQ(rig_.fake.mode(), fci::RobotMode::kIdle);
  EXPECT_EQ(rig_.arm->counts().commands, 0U);
}

TEST_P(FrankaFault, AnotherProgramThatMovesIt) { ExpectMessageAtRest("moved", "moves"); }

TEST_P(FrankaFault, TwentyLostCommandsAreNamed) {
  const int ticks = TicksUntilReported("lose commands 1000");
  EXPECT_GE(ticks, 20);
  EXPECT_LE(ticks, 22);
  ExpectMessage("communication constraints violation");
}

TEST_P(FrankaFault, NineteenLostCommandsAreNoFault) {
  Move();
  ASSERT_TRUE(rig_.fake.Do("lose commands 19"));
  EXPECT_TRUE(rig_.Ticks(100));
}

TEST_P(FrankaFault, Silence) {
  const int ticks = TicksUntilReported("freeze");
  EXPECT_GE(ticks, 20);
  EXPECT_LE(ticks, 21);
  ExpectMessage("no longer sends states");
  EXPECT_NEAR(rig_.reading.age, 0.070, 0.002);
}

// The arm receives no answers either, so it stops on its own.
TEST_P(FrankaFault, LostStatesInMotion) {
  EXPECT_LE(TicksUntilReported("lose states 1000"), 22);
  ExpectMessage("stopped by a reflex");
}

TEST_P(FrankaFault, RepeatedStatesCountAsSilence) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(10, false));
  ASSERT_TRUE(rig_.fake.Do("replay state"));
  for (int tick = 0; tick < 18; ++tick) {
    ASSERT_TRUE(rig_.Tick(false));
    EXPECT_NEAR(rig_.reading.age, 1e-3 * (tick + 1), 1e-4);
  }
  EXPECT_FALSE(rig_.Ticks(4, false));
  ExpectMessage("no longer sends states");
}

TEST_P(FrankaFault, ClosedConnection) {
  EXPECT_LE(TicksUntilReported("drop link"), 2);
  ExpectMessage("closed the connection");
}

TEST_P(FrankaFault, MotionThatNeverBegins) {
  rig_.Connect();
  ASSERT_TRUE(rig_.fake.Do("no start"));
  EXPECT_TRUE(rig_.Ticks(1000));
  EXPECT_FALSE(rig_.Ticks(10));
  ExpectMessage("did not start its motion");
}

TEST_P(FrankaFault, MotionThatNeverEnds) {
  Move();
  ASSERT_TRUE(rig_.fake.Do("no end"));
  EXPECT_TRUE(rig_.Ticks(1000, false));
  EXPECT_FALSE(rig_.Ticks(200, false));
  ExpectMessage("did not end its motion");
}

TEST_P(FrankaFault, MotionThatEndsWithoutARequest) {
  EXPECT_LE(TicksUntilReported("answer 0"), 2);
  ExpectMessage("has ended the motion");
}

TEST_P(FrankaFault, RefusalToMove) {
  rig_.Connect();
  ASSERT_TRUE(rig_.Ticks(10, false));
  // The person presses the user stop between the last state and the request.
  ASSERT_TRUE(rig_.fake.Do("lose states 3"));
  ASSERT_TRUE(rig_.fake.Do("user stop"));
  EXPECT_FALSE(rig_.Ticks(3));
  ExpectMessage("refuses to move in its current mode");
}

// The driver must not allocate memory in a tick, neither in motion nor after a fault.
TEST_P(FrankaFault, DoesNotAllocate) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  for (const char* what : {"lose states 3", "repeat state", "cut state", "lose commands 4",
                           "reflex", "drop link", "freeze", "answer 7"}) {
    FrankaRig rig(FrankaOfVersion(GetParam()));
    HeldNetwork held(&rig.network);
    const std::unique_ptr<FrankaArm> arm = ConnectFranka(rig.options(), &held);
    held.Hold();
    JointVector v = JointVector::Constant(7, 0.2);
    ArmReading reading;
    std::int64_t count = 0;
    for (int tick = 0; tick < 600; ++tick) {
      rig.network.Pass(1e-3);
      held.Exchange();
      ASSERT_TRUE(tick != 200 || rig.fake.Do(what));
      const test::AllocationGuard guard;
      static_cast<void>(arm->Read(&reading));
      static_cast<void>(arm->Write(v, tick > 20 && tick < 400));
      count += guard.count();
      held.Exchange();
    }
    EXPECT_EQ(count, 0) << what;
    EXPECT_GT(arm->counts().commands, 100U);
  }
}

INSTANTIATE_TEST_SUITE_P(Versions, FrankaFault,
                         testing::Values(fci::kPandaVersion, fci::kResearch3Version),
                         [](const auto& version) { return ControllerName(version.param); });

// Returns the error message if the arm cannot be connected.
std::string Refusal(FrankaRig* rig, const FrankaOptions& options) {
  try {
    ConnectFranka(options, &rig->network);
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}
std::string Refusal(FrankaRig* rig) { return Refusal(rig, rig->options()); }

TEST(FrankaRefusal, NoAnswer) {
  FrankaRig rig;
  FrankaOptions options = rig.options();
  options.host = "192.0.2.99";
  EXPECT_TRUE(Contains(Refusal(&rig, options), "192.0.2.99")) << Refusal(&rig, options);
}

TEST(FrankaRefusal, UnknownVersion) {
  FrankaRig rig(FrankaOfVersion(8));
  const std::string text = Refusal(&rig);
  EXPECT_EQ(
      text,
      "192.0.2.10:1337 answers FCI version 8, but version 10 (Franka Research 3, system 5.9 and "
      "newer) or 5 (Panda, libfranka 0.8 and 0.9) is needed: update the arm's system in Desk.");
  FrankaRig newer(FrankaOfVersion(11));
  const std::string more = Refusal(&newer);
  EXPECT_TRUE(Contains(more, "answers FCI version 11, but version 10")) << more;
  EXPECT_TRUE(Contains(more, "or extend this driver")) << more;
}

TEST(FrankaRefusal, AnotherVersionThanRequested) {
  FrankaRig rig(FrankaOfVersion(5));
  FrankaOptions options = rig.options();
  options.version = fci::kResearch3Version;
  EXPECT_TRUE(
      Contains(Refusal(&rig, options), "answers FCI version 5; version 10 was requested. Remove"))
      << Refusal(&rig, options);
}

TEST(FrankaRefusal, NoStates) {
  FrankaRig rig;
  ASSERT_TRUE(rig.fake.Do("freeze"));
  EXPECT_TRUE(Contains(Refusal(&rig), "Check whether a firewall drops them.")) << Refusal(&rig);
}

TEST(FrankaRefusal, StatesOfAnUnknownSize) {
  FrankaRig rig;
  ASSERT_TRUE(rig.fake.Do("cut state"));
  EXPECT_TRUE(Contains(Refusal(&rig),
                       "192.0.2.10:1337 sends states of 1376 bytes in FCI version 10; 1377 bytes "
                       "(system 5.9 and newer) or 1233 bytes are needed. Install"))
      << Refusal(&rig);
  FrankaRig panda(FrankaOfVersion(fci::kPandaVersion));
  ASSERT_TRUE(panda.fake.Do("cut state"));
  EXPECT_TRUE(Contains(Refusal(&panda), "states of 2372 bytes in FCI version 5; 2373 bytes are"))
      << Refusal(&panda);
}

TEST(FrankaRefusal, ArmThatIsNotReady) {
  for (const auto& [what, words] : std::vector<std::pair<std::string, std::string>>{
           {"user stop", "is stopped by the user stop"},
           {"reflex joint_reflex", "is stopped by a reflex (joint reflex)"},
           {"guide", "is being guided by hand"},
           {"moved", "is moved by another program"},
           {"error power_limit_violation", "reports an error (power limit violation)"},
           {"emergency stop", "is in another mode"}}) {
    FrankaRig rig;
    ASSERT_TRUE(rig.fake.Do(what));
    const std::string text = Refusal(&rig);
    EXPECT_TRUE(Contains(text, "192.0.2.10:1337 " + words)) << text;
    EXPECT_TRUE(Contains(text, "Desk")) << text;
  }
}

TEST(FrankaRefusal, ImpossibleStates) {
  FrankaRig rig;
  ASSERT_TRUE(rig.fake.Do("spoil state"));
  ASSERT_TRUE(rig.fake.Do("replay state"));
  EXPECT_TRUE(Contains(Refusal(&rig), "sends states with invalid numbers")) << Refusal(&rig);
}

TEST(FrankaRefusal, ThresholdsThatTheArmRefuses) {
  FrankaRig rig;
  FrankaOptions options = rig.options();
  options.collision.emplace();
  EXPECT_TRUE(Contains(Refusal(&rig, options), "refuses the collision thresholds (status 2)"))
      << Refusal(&rig, options);
}

TEST(FrankaRefusal, SecondClient) {
  FrankaRig rig;
  rig.Connect();
  EXPECT_TRUE(Contains(Refusal(&rig), "Check that no other program controls the arm"))
      << Refusal(&rig);
}

class Mute final : public FakeDevice {
 public:
  std::vector<std::uint16_t> tcp_ports() const override { return {1337}; }
  void Step(Mechanics*) override {}
};

TEST(FrankaRefusal, SomethingElseAtThePort) {
  Mute mute;
  Mechanics mechanics;
  MemoryNetwork network;
  network.Add("192.0.2.11", &mute, &mechanics);
  FrankaOptions options;
  options.host = "192.0.2.11";
  try {
    ConnectFranka(options, &network);
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_TRUE(Contains(error.what(), "Activate the interface in Desk.")) << error.what();
  }
}

TEST(FrankaCollisionThresholds, AreSetIfRequested) {
  for (const std::uint16_t version : {fci::kPandaVersion, fci::kResearch3Version}) {
    FrankaRig rig(FrankaOfVersion(version));
    FrankaOptions options = rig.options();
    options.collision.emplace();
    options.collision->torque.fill(40);
    options.collision->force << 60, 60, 60, 20, 20, 20;
    rig.Connect(options);
    EXPECT_EQ(rig.fake.collision_force(), 60);
    EXPECT_TRUE(Contains(rig.arm->facts().remarks.at(0), "above 60 N or 20 N·m"));
    // A client that only listens changes no settings.
    FrankaRig heard(FrankaOfVersion(version));
    options = heard.options();
    options.collision = FrankaCollision{};
    options.listen = true;
    heard.Connect(options);
    EXPECT_EQ(heard.fake.collision_force(), 0);
    // Without values in the machine file, the robot keeps its own settings, which are unknown.
    FrankaRig own(FrankaOfVersion(version));
    own.Connect(own.options());
    EXPECT_TRUE(Contains(own.arm->facts().remarks.at(0), "set in Desk apply"));
  }
}

TEST(FrankaPayload, IsThatOfDeskAndNotInTheWrench) {
  for (const std::uint16_t version : {fci::kPandaVersion, fci::kResearch3Version}) {
    FakeFrankaOptions options = FrankaOfVersion(version);
    options.payload = 0.5;
    options.payload_cog = {0, 0.01, 0.05};
    FrankaRig rig(options);
    rig.Connect(rig.options());
    const DeviceFacts& facts = rig.arm->facts();
    ASSERT_TRUE(facts.payload);
    EXPECT_NEAR(facts.payload->mass, 0.5, 1e-6);
    EXPECT_LT((facts.payload->center_of_mass - Vector3(0, 0.01, 0.05)).norm(), 1e-6);
    EXPECT_TRUE(facts.payload_taken_off);
  }
}

}  // namespace
}  // namespace predictor
