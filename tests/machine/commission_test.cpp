// `predictor devices` and `predictor calibrate` as a person at a rig uses them: at a terminal, over
// real sockets. A separate process simulates the arms, their sensors, and the person who moves or
// presses them.
#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <regex>

#include "commissioning/chirp.h"
#include "commissioning/swing_file.h"
#include "core/words.h"
#include "machine/attempts.h"
#include "models/robot.h"
#include "rig/velocity_loop.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

constexpr int kUnfit = 1, kBadInput = 2, kDeviceFailure = 3;  // exit codes

// The first number that the parentheses in `pattern` capture.
double NumberIn(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? std::stod(match[1]) : NAN;
}

std::string Text(const JointVector& q) {
  std::ostringstream text;
  text.precision(12);
  text << q.transpose();
  return text.str();
}

class Commissioning : public testing::Test {
 protected:
  explicit Commissioning(const std::array<std::string, 2>& makes = {"ur", "ur"},
                         const std::string& scenario = "dual_ur5")
      : folder_(makes), file_(FileOf(scenario)), scenario_(LoadScenario(file_)) {}

  static std::string Left(const std::string& options = "") {
    return "left=ur:" + HostOf(kLeft) + options;
  }
  static std::string Right(const std::string& options = "") {
    return "right=ur:" + HostOf(kRight) + options;
  }
  void SwitchOn(const std::vector<std::string>& fakes = {Left(), Right()}) {
    rig_.reset();
    rig_ = std::make_unique<FakeRig>(file_, fakes);
  }
  Terminal Predictor(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--machine", folder_.file()});
    return Terminal(arguments);
  }
  JointVector Joints(const std::string& hand) {
    std::istringstream text(rig_->Ask("joints " + hand));
    std::vector<double> q;
    for (double x = 0; text >> x;) q.push_back(x);
    return Eigen::Map<Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
  }
  // A person leads the arm there in free-drive and holds it.
  void Lead(const std::string& hand, const JointVector& q) {
    ASSERT_EQ(rig_->Ask("lead " + hand + " " + Text(q)), "ok");
    for (int i = 0; i < 3000 && rig_->Ask("led " + hand) != "yes"; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(rig_->Ask("led " + hand), "yes");
  }
  // Pushes the handle as the program requests, each time until the program has read the push.
  void ObeyPushes(Terminal* terminal, int pushes) {
    const char* forces[] = {"12 0 0", "0 12 0", "0 0 12"};
    for (int n = 0; n < pushes; ++n) {
      // "left handle along +x of the world, ..."
      const std::string told = terminal->Line("Push the ");
      const auto at = told.find("along +");
      ASSERT_NE(at, std::string::npos) << terminal->Screen();
      const std::string hand = told.substr(0, told.find(' '));
      bool read = false;
      for (int attempt = 0; attempt < 5 && !read; ++attempt) {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));  // hands off in between
        rig_->Ask("press " + hand + " " + forces[told[at + 7] - 'x']);
        read = terminal->Says("  reads ", 4);
        rig_->Ask("press " + hand + " 0 0 0");
      }
      ASSERT_TRUE(read) << terminal->Screen();
    }
  }
  // Releases both handles while their sensors are tared, then pushes one handle.
  void PushOne(Terminal* terminal, int tares = 2) {
    for (int n = 0; n < tares; ++n) {
      ASSERT_TRUE(terminal->Says("hen press Enter.")) << terminal->Screen();
      terminal->Type("\n");
    }
    ObeyPushes(terminal, 3);
  }

  MachineFolder folder_;
  std::string file_;
  Scenario scenario_;
  std::unique_ptr<FakeRig> rig_;
};

// ---- devices ------------------------------------------------------------------------------------

TEST_F(Commissioning, DevicesTellsWhoAnswersAndGoesOnWhereOneDoesNot) {
  SwitchOn();
  {
    Terminal all = Predictor({"devices", "--duration", "0.5"});
    EXPECT_EQ(all.Wait(), 0) << all.Screen();
    for (const std::string& part :
         {std::string("left arm: Universal Robots e-Series, PolyScope 5.12"),
          "at " + HostOf(kRight), std::string("never run on hardware"), std::string("wrench now")})
      EXPECT_NE(all.Screen().find(part), std::string::npos) << part << "\n" << all.Screen();
  }
  {
    SwitchOn({Left(",payload=1.2"), Right()});
    rig_->Ask("do right 0 slider 70");
    Terminal told = Predictor({"devices", "--duration", "0.5"});
    EXPECT_EQ(told.Wait(), 0) << told.Screen();
    EXPECT_NE(told.Screen().find("is set to 1.20 kg at the flange"), std::string::npos)
        << told.Screen();
    EXPECT_NE(told.Screen().find("speed slider is at 70 %"), std::string::npos) << told.Screen();
  }
  {
    SwitchOn();
    folder_.Change([](Machine* machine) {  // like a CB3, and like an arm of seven joints
      machine->left->arm.sample_rate = 125;
      machine->right->arm = LoadScenario(FileOf("box_9kg")).arm(1);
    });
    Terminal others = Predictor({"devices", "--duration", "0.5"});
    EXPECT_EQ(others.Wait(), kUnfit) << others.Screen();
    for (const char* part : {"500 samples per second, but the machine file says 125",
                             "arms.right.arm.model has 7 joints, but the arm that answers has 6"})
      EXPECT_NE(others.Screen().find(part), std::string::npos) << part << "\n" << others.Screen();
  }
  SwitchOn({Right()});
  Terminal one = Predictor({"devices", "--duration", "0.5"});
  EXPECT_EQ(one.Wait(), kDeviceFailure);
  EXPECT_NE(one.Screen().find("left arm: DOES NOT ANSWER"), std::string::npos) << one.Screen();
  EXPECT_NE(one.Screen().find(HostOf(kLeft) + ":30004"), std::string::npos) << one.Screen();
  EXPECT_NE(one.Screen().find("right arm: Universal Robots"), std::string::npos) << one.Screen();
}

// ---- the handle ---------------------------------------------------------------------------------

TEST_F(Commissioning, TheHandleIsFoundInPosesIntoWhichAPersonLeads) {
  SwitchOn();
  folder_.Change([](Machine* machine) {  // as if the handle had not been measured yet
    machine->left->arm.payload = {};
    machine->left->arm.payload.mass = 0;
  });
  folder_.NotePushTests();
  const JointVector start = Joints("left");
  const double tilts[][3] = {{0, 0, 0},    {1.2, 0, 0}, {-1.2, 0, 0},   {0, 1.2, 0},
                             {0, -1.2, 0}, {0.8, 1, 0}, {-0.7, 0.9, 1}, {1.9, -0.4, -1}};
  Terminal terminal = Predictor({"calibrate", "handle", "--arm", "left"});
  for (int pose = 1; pose <= 8; ++pose) {
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + ": Enter")) << terminal.Screen();
    JointVector q = start;
    for (int j = 0; j < 3; ++j) q[3 + j] += tilts[pose - 1][j];
    Lead("left", q);
    terminal.Type("\n");
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + " taken")) << terminal.Screen();
  }
  terminal.Type("d");
  ASSERT_TRUE(terminal.Says("Write these values to")) << terminal.Screen();
  terminal.Type("y");
  EXPECT_EQ(terminal.Wait(), 0);
  const std::string said = terminal.Screen();
  EXPECT_NE(said.find("run `predictor calibrate push --machine "), std::string::npos) << said;

  const HandlePayloadSpec& truth = scenario_.arm(0).payload;
  const HandlePayloadSpec found = folder_.machine().left->arm.payload;
  EXPECT_NEAR(found.mass, truth.mass, 0.01 * truth.mass) << said;
  const double mass_sure = NumberIn(said, "mass +[-0-9.]+ ± ([0-9.]+) kg");
  EXPECT_LT(mass_sure, 0.01 * truth.mass) << said;
  EXPECT_GT(mass_sure, 0) << said;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    EXPECT_NEAR(found.center_of_mass[i], truth.center_of_mass[i], 0.001) << said;
    const double sure = NumberIn(said, "centre of mass " + axis + " +[-0-9.]+ ± ([0-9.]+) mm");
    EXPECT_GT(sure, 0) << said;
    EXPECT_LT(sure, 1) << said;
    const std::string bias = "force  " + axis + " +([-0-9.]+) ± ([0-9.]+) N";
    EXPECT_NEAR(NumberIn(said, bias), scenario_.rig.sensor_bias[static_cast<std::size_t>(i)], 0.05)
        << said;
    const double bias_sure = NumberIn(said, "force  " + axis + " +[-0-9.]+ ± ([0-9.]+) N");
    EXPECT_GT(bias_sure, 0) << said;
    EXPECT_LT(bias_sure, 0.05) << said;
  }
  // After this change the push tests must be repeated.
  EXPECT_FALSE(IsPushTested(*folder_.machine().left));
  EXPECT_TRUE(IsPushTested(*folder_.machine().right));
}

TEST_F(Commissioning, PosesThatAreTooAlikeAreRefusedAndNothingIsWritten) {
  SwitchOn();
  const std::string before = HashOf(*folder_.machine().left);
  Terminal terminal = Predictor({"calibrate", "handle", "--arm", "left"});
  JointVector q = Joints("left");
  for (int pose = 1; pose <= 6; ++pose) {
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + ": Enter")) << terminal.Screen();
    q[5] += 0.3;  // about the vertical: down stays down
    Lead("left", q);
    terminal.Type("\n");
    ASSERT_TRUE(terminal.Says("Pose " + std::to_string(pose) + " taken")) << terminal.Screen();
  }
  terminal.Type("d");
  EXPECT_TRUE(terminal.Says("too alike")) << terminal.Screen();
  ASSERT_TRUE(terminal.Says("Pose 7: Enter")) << terminal.Screen();
  terminal.Type("q");
  EXPECT_EQ(terminal.Wait(), kBadInput);
  EXPECT_NE(terminal.Screen().find("Cancelled. The machine file was not changed any further."),
            std::string::npos);
  EXPECT_EQ(HashOf(*folder_.machine().left), before);
}

// ---- the bases ----------------------------------------------------------------------------------

TEST_F(Commissioning, TheBasesAreFoundByTouchingCommonPoints) {
  SwitchOn();
  folder_.Change([](Machine* machine) {
    machine->right->arm.base.xyz += Vector3(0.03, -0.02, 0.01);
    machine->right->arm.base.rpy += Vector3(0.01, 0, 0.04);
  });
  const Vector3 tip(0, 0, 0.18);
  const auto joints = [&](int hand, const Vector3& point) {
    const ArmSpec& spec = scenario_.arm(hand);
    const auto model = RobotModel::Load({spec.model, {}, spec.remove_links, spec.base.ToPose()});
    JointVector q = Joints(kHandNames[static_cast<std::size_t>(hand)]);
    const FrameId end = model->Frame(spec.end_effector, {tip, {1, 0, 0, 0}});
    EXPECT_TRUE(SolveInverseKinematics(
        *model, end, {point, RotationFromVector({std::numbers::pi, 0, 0})}, q, 50, &q));
    return q;
  };
  const Vector3 points[] = {
      {0.55, -0.1, 0.1}, {0.7, 0.1, 0.1}, {0.6, 0.12, 0.3}, {0.5, -0.05, 0.25}, {0.65, -0.12, 0.2}};
  Terminal terminal = Predictor({"calibrate", "bases", "--tip", "0", "0", "0.18"});
  for (const int hand : {0, 1}) {
    for (std::size_t i = 0; i < std::size(points); ++i) {
      const std::string name = kHandNames[static_cast<std::size_t>(hand)];
      ASSERT_TRUE(terminal.Says("Touch point " + std::to_string(i + 1) + " with the tip of the " +
                                name + " arm"))
          << terminal.Screen();
      Lead(name, joints(hand, points[i]));
      terminal.Type("\n");
      ASSERT_TRUE(terminal.Says("mm in its base.")) << terminal.Screen();
    }
    if (hand == 1) continue;
    ASSERT_TRUE(terminal.Says("or d if all points are done")) << terminal.Screen();
    terminal.Type("d");
  }
  ASSERT_TRUE(terminal.Says("Write these values to")) << terminal.Screen();
  terminal.Type("y");
  EXPECT_EQ(terminal.Wait(), 0);
  const Pose found = folder_.machine().right->arm.base.ToPose();
  const Pose truth = scenario_.arm(1).base.ToPose();
  EXPECT_LT((found.p - truth.p).norm(), 0.001) << terminal.Screen();
  EXPECT_LT(RotationError(found.q, truth.q).norm(), 0.002) << terminal.Screen();
  EXPECT_LT(NumberIn(terminal.Screen(), "([0-9.]+) mm rms"), 1) << terminal.Screen();
}

// ---- push tests ---------------------------------------------------------------------------------

TEST_F(Commissioning, PushesThatReadAsPushedAreNotedForBothArms) {
  SwitchOn();
  Terminal terminal = Predictor({"calibrate", "push"});
  PushOne(&terminal);
  EXPECT_TRUE(terminal.Says("The left handle's readings agree with the pushes."))
      << terminal.Screen();
  PushOne(&terminal);
  EXPECT_TRUE(terminal.Says("The right handle's readings agree with the pushes."))
      << terminal.Screen();
  EXPECT_EQ(terminal.Wait(), 0);
  EXPECT_TRUE(IsPushTested(*folder_.machine().left));
  EXPECT_TRUE(IsPushTested(*folder_.machine().right));
}

struct Wiring {
  const char* name;
  const char* axes;  // of the left arm's sensor
  const char* says;
};

class WrongWiring : public Commissioning, public testing::WithParamInterface<Wiring> {};

TEST_P(WrongWiring, IsRefusedAndNotNoted) {
  SwitchOn();
  ASSERT_EQ(rig_->Ask(std::string("wire left ") + GetParam().axes), "ok");
  Terminal terminal = Predictor({"calibrate", "push", "--arm", "left"});
  PushOne(&terminal);
  EXPECT_EQ(terminal.Wait(), kBadInput);
  EXPECT_NE(terminal.Screen().find(GetParam().says), std::string::npos) << terminal.Screen();
  EXPECT_FALSE(IsPushTested(*folder_.machine().left));
}

INSTANTIATE_TEST_SUITE_P(
    Of, WrongWiring,
    testing::Values(Wiring{"MirroredAxis", "-1 0 0 0 1 0 0 0 1", "mirrored"},
                    Wiring{"SwappedAxes", "0 1 0 1 0 0 0 0 1", "mirrored"},
                    Wiring{"TurnedSensor", "0 -1 0 1 0 0 0 0 1", "rotated by 90"},
                    Wiring{"OppositeSigns", "-1 0 0 0 -1 0 0 0 -1", "All signs are reversed"}),
    [](const testing::TestParamInfo<Wiring>& wiring) { return std::string(wiring.param.name); });

// The file assigns each arm the other arm's address.
TEST_F(Commissioning, ExchangedSensorsAreRefused) {
  SwitchOn({Left(), Right(), "left=net_ft:" + HostOf(kLeftSensor),
            "right=net_ft:" + HostOf(kRightSensor)});
  folder_.Change([](Machine* machine) {
    machine->left->sensor = {SensorMake::kNetFt, HostOf(kRightSensor), 1e6, 1e6};
    machine->right->sensor = {SensorMake::kNetFt, HostOf(kLeftSensor), 1e6, 1e6};
    for (std::optional<MachineArm>* arm : {&machine->left, &machine->right})
      (*arm)->arm.sensor.sample_rate = 1000;
  });
  Terminal terminal = Predictor({"calibrate", "push", "--arm", "left"});
  PushOne(&terminal);
  EXPECT_EQ(terminal.Wait(), kBadInput);
  EXPECT_NE(terminal.Screen().find("are swapped"), std::string::npos) << terminal.Screen();
  EXPECT_FALSE(IsPushTested(*folder_.machine().left));
}

// ---- the velocity loop: the arm moves -----------------------------------------------------------

class LoopAtTheTerminal : public Commissioning {
 protected:
  using Commissioning::Commissioning;
  static void Begin(Terminal* terminal) {
    ASSERT_TRUE(terminal->Says("hen press Enter.")) << terminal->Screen();
    terminal->Type("\n");
    ASSERT_TRUE(terminal->Says("Take your hands off the left handle, then press Enter."))
        << terminal->Screen();
    terminal->Type("\n");
    ASSERT_TRUE(terminal->Says("hold s.")) << terminal->Screen();
    terminal->Hold('s');
  }
  // The true handles' maximum speed [m/s] and acceleration [m/s²] since the mark.
  std::pair<double, double> Motion() {
    std::istringstream text(rig_->Ask("motion"));
    double rest = 0, fastest = 0, hardest = 0;
    text >> rest >> fastest >> hardest;
    return {fastest, hardest};
  }
  void AwaitMotion() {
    for (int i = 0; i < 1000 && Motion().first < 0.01; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
};

TEST_F(LoopAtTheTerminal, CtrlCInMotionBringsTheArmToRestAndSaysSo) {
  Attempts attempts;
  while (attempts.Next()) {
    SwitchOn();
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    rig_->Ask("mark");
    Begin(&terminal);
    AwaitMotion();
    terminal.Type("\x03");
    const int code = terminal.Wait();
    const std::string screen = terminal.Screen();
    if (attempts.WasSpoiled(terminal, rig_.get())) continue;
    EXPECT_EQ(code, kBadInput) << screen;
    EXPECT_GT(Motion().first, 0.01);
    EXPECT_LT(Motion().first, 0.06);  // limits.align_speed is 0.05
    EXPECT_LT(Motion().second, 5);    // at most 3 rad/s² at a lever arm of less than a metre
    EXPECT_NE(screen.find("The left arm was brought to rest within"), std::string::npos) << screen;
    EXPECT_NE(screen.find("Ended on request. The machine file was not changed any further."),
              std::string::npos)
        << screen;
    rig_->Ask("mark");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_LT(Motion().first, 1e-3);
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

// If the machine has an enabling device at either arm, holding a key alone moves nothing.
TEST_F(LoopAtTheTerminal, TheMachinesEnablingDeviceIsAskedFor) {
  constexpr int kInput = 8;
  folder_.Change([](Machine* machine) { machine->enabling = EnablingInput{"right", kInput}; });
  const std::string input = std::to_string(kInput);
  Attempts attempts;
  while (attempts.Next()) {
    SwitchOn();
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    for (const char* asked :
         {"hen press Enter.", "Take your hands off the left handle, then press Enter."}) {
      ASSERT_TRUE(terminal.Says(asked)) << terminal.Screen();
      terminal.Type("\n");
    }
    ASSERT_TRUE(terminal.Says(HowToHold('s', true) + ".")) << terminal.Screen();
    rig_->Ask("mark");
    terminal.Hold('s');
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    EXPECT_LT(Motion().first, 1e-3);
    terminal.Let();
    EXPECT_EQ(rig_->Ask("do right 0 press " + input), "ok");
    std::this_thread::sleep_for(std::chrono::seconds(1));  // an earlier press does not count
    terminal.Type("s");
    AwaitMotion();
    EXPECT_EQ(rig_->Ask("do right 0 release " + input), "ok");
    const bool begins_again =
        terminal.Says("pressed another key. This joint will be measured again.", 5);
    terminal.Type("q");
    const int code = terminal.Wait();
    const std::string screen = terminal.Screen();
    if (attempts.WasSpoiled(terminal, rig_.get())) continue;
    EXPECT_EQ(code, kBadInput) << screen;
    EXPECT_GT(Motion().first, 0.01) << screen;
    EXPECT_TRUE(begins_again) << screen;
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

// The watchdog runs as it does in a normal run: if this process hangs, the watchdog process brakes
// the arm.
TEST_F(LoopAtTheTerminal, WhereTheProgramHangsTheWatchdogStopsTheArm) {
  Attempts attempts;
  while (attempts.Next()) {
    SwitchOn();
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    rig_->Ask("mark");
    Begin(&terminal);
    ASSERT_NE(terminal.Screen().find("Watchdog  left arm: separate stop channel."),
              std::string::npos)
        << terminal.Screen();
    AwaitMotion();
    if (attempts.WasSpoiled(terminal, rig_.get())) continue;
    terminal.Kill(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    const std::vector<std::string> log = rig_->Log("left", 0);
    EXPECT_NE(std::find(log.begin(), log.end(), "program predictor_watchdog"), log.end())
        << (log.empty() ? "no log" : log.back());
    terminal.Kill(SIGCONT);
    EXPECT_NE(terminal.Wait(), 0);
    EXPECT_NE(terminal.Screen().find("The control loop hung, and the watchdog stopped the arms."),
              std::string::npos)
        << terminal.Screen();
    return;
  }
  FAIL() << attempts.Words();
}

// Every state of this arm counts. A session that slept for a millisecond in each cycle would
// receive and answer fewer states than the arm sends.
class FrankaLoopAtTheTerminal : public LoopAtTheTerminal {
 protected:
  FrankaLoopAtTheTerminal() : LoopAtTheTerminal({"franka", "franka"}, "box_9kg") {}

  // Measures the first joint. Returns nullopt if this computer was too busy.
  std::optional<commissioning::LoopRecord> SwingOne(Terminal* terminal) const {
    constexpr int kAnew = 8;
    Begin(terminal);
    bool measured = false;
    for (int i = 0; i < kAnew && !measured; ++i) {
      measured = terminal->Line("Joint ", 20).starts_with("2 of 7");
      terminal->Let();
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      if (!measured) terminal->Hold('s');
    }
    terminal->Let();
    terminal->Type("q");
    terminal->Wait();
    const commissioning::SwingFile file(folder_.file(), "left", HashOf(*folder_.machine().left));
    const commissioning::Swings swings = file.Load().swings;
    file.Remove();
    if (swings.records.empty()) return std::nullopt;
    return swings.records[0];
  }
};

TEST_F(FrankaLoopAtTheTerminal, ItsStatesAreSeenAndAnsweredAsItSendsThem) {
  constexpr double kMostLost = 0.02;
  Attempts attempts;
  while (attempts.Next()) {
    SwitchOn({"left=franka:" + HostOf(kLeft), "right=franka:" + HostOf(kRight)});
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    const std::uint64_t began = Terminal::Now();
    const std::optional<commissioning::LoopRecord> record = SwingOne(&terminal);
    if (!record) {
      ASSERT_TRUE(attempts.WasSpoiled(terminal, rig_.get())) << terminal.Screen();
      continue;
    }
    // Whatever the load of the computer, late ticks must account for all missing ticks.
    const commissioning::Gaps& gaps = record->gaps;
    const std::string seen = commissioning::GapsText(gaps);
    const double late =
        static_cast<double>(gaps.late) * gaps.longest_tick / commissioning::LoopRecord::kStep;
    EXPECT_GE(static_cast<double>(gaps.ticks) + late, 0.99 * static_cast<double>(record->u.size()))
        << seen;
    if (gaps.lost_share() <= kMostLost) return;
    // Each delay of the computer may also lose one or two adjacent states.
    const double lost = 1e3 * gaps.lost_share() * static_cast<double>(record->u.size()) *
                        commissioning::LoopRecord::kStep,
                 late_for = rig_->Late(began, Terminal::Now()).processor_sum;
    ASSERT_GT(late_for, lost / 3) << seen << "; the computer was late by " << late_for << " ms";
    attempts.Note(seen);
  }
  GIVE_UP_BUSY(attempts.Words());
}

// The data that a session leaves if it ends after `measured` of six joints.
commissioning::Swings SwingsOf(const VelocityLoopSpec& spec, int measured) {
  constexpr double kRest = 0.4, kQuantum = 1e-5;  // [s], [rad]
  const commissioning::Chirp chirp{commissioning::ChirpOptions()};
  commissioning::Swings swings{6, {}};
  for (int joint = 0; joint < measured; ++joint) {
    VelocityLoop loop(spec, 0, commissioning::LoopRecord::kStep, 1e9, 1e9);
    commissioning::LoopRecorder recorder(joint, commissioning::LoopRecord::kStep);
    for (double t = 0; t < chirp.duration() + 2 * kRest; t += commissioning::LoopRecord::kStep) {
      recorder.Seen(t, kQuantum * std::round(loop.q() / kQuantum));
      recorder.Told(t, t, chirp.v(t - kRest));
      loop.Step(chirp.v(t - kRest));
    }
    swings.records.push_back(std::move(recorder).Finish());
  }
  return swings;
}

// This test needs no arm.
TEST_F(Commissioning, SwingsThatWereMeasuredAreNotMeasuredAgain) {
  const commissioning::SwingFile file(folder_.file(), "left", HashOf(*folder_.machine().left));
  const VelocityLoopSpec truth{11, 0.8, 0.006};
  file.Save(SwingsOf(truth, 1), "a-day");
  for (const char* key : {"n", "\n"}) {
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    ASSERT_TRUE(terminal.Says("For the left arm, 1 of 6 joints were measured on a-day"))
        << terminal.Screen();
    ASSERT_TRUE(
        terminal.Says("Press Enter to continue with joint 2, or n to measure all joints again."));
    terminal.Type(key);
    ASSERT_TRUE(terminal.Says("Guide the left arm to a typical working pose")) << terminal.Screen();
    terminal.Type("\x03");
    EXPECT_EQ(terminal.Wait(), kBadInput) << terminal.Screen();
    const bool kept =
        terminal.Screen().find("1 of 6 joints have been measured. The results are kept in") !=
        std::string::npos;
    EXPECT_EQ(kept, *key != 'n') << terminal.Screen();
    EXPECT_EQ(file.Load().swings.measured(), 1);
    EXPECT_EQ(file.Load().date, "a-day");
    EXPECT_FALSE(IsLoopMeasured(*folder_.machine().left));
  }
  file.Save(SwingsOf(truth, 6), "a-day");
  for (const char* key : {"n", "y"}) {  // a person who declines is asked again in the next session
    EXPECT_FALSE(IsLoopMeasured(*folder_.machine().left));
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    ASSERT_TRUE(terminal.Says("Press Enter to use these results")) << terminal.Screen();
    terminal.Type("\n");
    ASSERT_TRUE(terminal.Says("Write these values to")) << terminal.Screen();
    terminal.Type(key);
    EXPECT_EQ(terminal.Wait(), 0) << terminal.Screen();
  }
  const MachineArm arm = *folder_.machine().left;
  EXPECT_TRUE(IsLoopMeasured(arm));
  EXPECT_EQ(arm.commissioned->loop, "a-day");
  EXPECT_NEAR(arm.arm.loop.bandwidth, truth.bandwidth, 0.2);
  EXPECT_FALSE(std::filesystem::exists(file.path()));
}

// As if another robot's file had replaced the model's file.
TEST_F(Commissioning, SwingsOfAnotherNumberOfJointsAreNotUsed) {
  const commissioning::SwingFile file(folder_.file(), "left", HashOf(*folder_.machine().left));
  commissioning::Swings swings = SwingsOf({11, 0.8, 0.006}, 5);
  swings.joints = 5;
  file.Save(swings, "a-day");
  Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
  EXPECT_TRUE(terminal.Says("has 5 joints, but the arm has 6. All joints will be measured again."))
      << terminal.Screen();
  EXPECT_TRUE(terminal.Says("Guide the left arm to a typical working pose")) << terminal.Screen();
  terminal.Type("\x03");
  EXPECT_EQ(terminal.Wait(), kBadInput) << terminal.Screen();
}

TEST_F(Commissioning, SwingsOutOfWhichNoLoopCanBeMadeAreNotKept) {
  const commissioning::SwingFile file(folder_.file(), "left", HashOf(*folder_.machine().left));
  commissioning::Swings swings = SwingsOf({11, 0.8, 0.006}, 6);
  for (commissioning::LoopRecord& record : swings.records)
    for (commissioning::LoopRecord::Sample& sample : record.samples)
      sample.q = 0;  // it never moved
  file.Save(swings, "a-day");
  Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
  ASSERT_TRUE(terminal.Says("Press Enter to use these results")) << terminal.Screen();
  terminal.Type("\n");
  EXPECT_EQ(terminal.Wait(), kBadInput) << terminal.Screen();
  EXPECT_FALSE(std::filesystem::exists(file.path()));
}

// Takes more than a minute of real time.
TEST_F(LoopAtTheTerminal, FindsTheArmsLoopSoak) {
  if (Count(0, 1) == 0) GTEST_SKIP() << "In ./dev soak; in virtual time: commissioning.MeasureLoop";
  Attempts attempts;
  while (attempts.Next()) {
    SwitchOn();
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    Begin(&terminal);
    // If a busy computer interrupts a measurement, it begins again after the key is released.
    while (terminal.Says("his joint will be measured again.", 25)) {
      terminal.Let();
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      terminal.Hold('s');
    }
    const bool measured = terminal.Says("Write these values to", 100);
    terminal.Let();
    terminal.Type(measured ? "y" : "q");
    const int code = terminal.Wait();
    const std::string screen = terminal.Screen();
    commissioning::SwingFile(folder_.file(), "left", "").Remove();  // each attempt measures again
    if (code != 0 && attempts.WasSpoiled(terminal, rig_.get())) continue;
    ASSERT_EQ(code, 0) << screen;
    const VelocityLoopSpec found = folder_.machine().left->arm.loop;
    const VelocityLoopSpec& truth = scenario_.arm(0).loop;
    EXPECT_NEAR(found.bandwidth, truth.bandwidth, 0.1 * truth.bandwidth) << screen;
    EXPECT_NEAR(found.damping_ratio, truth.damping_ratio, 0.1) << screen;
    // The delay of the wire and of the controller's cycles adds to the loop's delay.
    EXPECT_GT(found.delay, truth.delay) << screen;
    EXPECT_LT(found.delay, truth.delay + 0.008) << screen;
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

}  // namespace
}  // namespace predictor
