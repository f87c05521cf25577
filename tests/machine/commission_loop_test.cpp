// Tests `predictor calibrate loop` at a terminal and over real sockets. The arm moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "commissioning/chirp.h"
#include "commissioning/swing_file.h"
#include "core/words.h"
#include "machine/attempts.h"
#include "machine/commissioning_fixture.h"
#include "rig/velocity_loop.h"

namespace predictor {
namespace {

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
  // Returns the true handles' maximum speed [m/s] and acceleration [m/s²] since the mark.
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

TEST_F(LoopAtTheTerminal, CtrlCInMotionBringsTheArmToRestAndReportsIt) {
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

// If the machine has an enabling device at either arm, the key alone must not move anything.
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
    std::this_thread::sleep_for(std::chrono::seconds(1));  // an earlier press must not count
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

// The watchdog runs as in a normal run. If this process hangs, the watchdog process must brake the
// arm.
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

// The program needs every state message of this arm. If a session slept for a millisecond in each
// cycle, it would receive and answer fewer states than the arm sends.
class FrankaLoopAtTheTerminal : public LoopAtTheTerminal {
 protected:
  FrankaLoopAtTheTerminal() : LoopAtTheTerminal({"franka", "franka"}, "box_9kg") {}

  // Measures the first joint. Returns no value if this computer was too busy.
  std::optional<commissioning::LoopRecord> SwingOne(Terminal* terminal) const {
    constexpr int kMaxTries = 8;
    Begin(terminal);
    bool measured = false;
    for (int i = 0; i < kMaxTries && !measured; ++i) {
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
  constexpr double kMaxLostShare = 0.02;
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
    // Whatever the load on the computer is, late ticks must account for all missing ticks.
    const commissioning::Gaps& gaps = record->gaps;
    const std::string seen = commissioning::GapsText(gaps);
    const double late =
        static_cast<double>(gaps.late) * gaps.longest_tick / commissioning::LoopRecord::kStep;
    EXPECT_GE(static_cast<double>(gaps.ticks) + late, 0.99 * static_cast<double>(record->u.size()))
        << seen;
    if (gaps.lost_share() <= kMaxLostShare) return;
    // Each delay of the computer may also cause the loss of one or two adjacent states.
    const double lost = 1e3 * gaps.lost_share() * static_cast<double>(record->u.size()) *
                        commissioning::LoopRecord::kStep,
                 late_for = rig_->Late(began, Terminal::Now()).processor_sum;
    ASSERT_GT(late_for, lost / 3) << seen << "; the computer was late by " << late_for << " ms";
    attempts.Note(seen);
  }
  GIVE_UP_BUSY(attempts.Words());
}

// Returns the data that a session leaves if it ends after `measured` of six joints.
commissioning::Swings SwingsOf(const VelocityLoopSpec& spec, int measured) {
  constexpr double kRest = 0.4, kQuantum = 1e-5;  // [s], [rad]
  const commissioning::Chirp chirp{commissioning::ChirpOptions()};
  commissioning::Swings swings{6, {}};
  for (int joint = 0; joint < measured; ++joint) {
    VelocityLoop loop(spec, 0, commissioning::LoopRecord::kStep, 1e9, 1e9);
    commissioning::LoopRecorder recorder(joint, commissioning::LoopRecord::kStep);
    for (double t = 0; t < chirp.duration() + 2 * kRest; t += commissioning::LoopRecord::kStep) {
      recorder.AddSample(t, kQuantum * std::round(loop.q() / kQuantum));
      recorder.AddCommand(t, t, chirp.v(t - kRest));
      loop.Step(chirp.v(t - kRest));
    }
    swings.records.push_back(std::move(recorder).Finish());
  }
  return swings;
}

// This test needs no arm.
TEST_F(Commissioning, MeasuredSwingsAreNotMeasuredAgain) {
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
    Terminal terminal =
        Predictor({"calibrate", "loop", "--arm", "left", "--json", ResultFile(), "--force"});
    ASSERT_TRUE(terminal.Says("Press Enter to use these results")) << terminal.Screen();
    terminal.Type("\n");
    ASSERT_TRUE(terminal.Says("Write these values to")) << terminal.Screen();
    terminal.Type(key);
    EXPECT_EQ(terminal.Wait(), 0) << terminal.Screen();
    EXPECT_EQ(Result()["written"], *key == 'y');
    EXPECT_NEAR(Result()["found"]["bandwidth_hz"]["value"].get<double>(), truth.bandwidth, 0.2);
  }
  const MachineArm arm = *folder_.machine().left;
  EXPECT_TRUE(IsLoopMeasured(arm));
  EXPECT_EQ(arm.commissioned->loop, "a-day");
  EXPECT_NEAR(arm.arm.loop.bandwidth, truth.bandwidth, 0.2);
  EXPECT_FALSE(std::filesystem::exists(file.path()));
}

// The model's file looks as if another robot's file had replaced it.
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

TEST_F(Commissioning, SwingsThatGiveNoLoopAreNotKept) {
  const commissioning::SwingFile file(folder_.file(), "left", HashOf(*folder_.machine().left));
  commissioning::Swings swings = SwingsOf({11, 0.8, 0.006}, 6);
  for (commissioning::LoopRecord& record : swings.records)
    for (commissioning::LoopRecord::Sample& sample : record.samples)
      sample.q = 0;  // the joint never moved
  file.Save(swings, "a-day");
  Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
  ASSERT_TRUE(terminal.Says("Press Enter to use these results")) << terminal.Screen();
  terminal.Type("\n");
  EXPECT_EQ(terminal.Wait(), kBadInput) << terminal.Screen();
  EXPECT_FALSE(std::filesystem::exists(file.path()));
}

// This test takes more than a minute of real time.
TEST_F(LoopAtTheTerminal, FindsTheArmsLoopSoak) {
  if (Count(0, 1) == 0) GTEST_SKIP() << "In ./dev soak; in virtual time: commissioning.MeasureLoop";
  Attempts attempts;
  while (attempts.Next()) {
    SwitchOn();
    Terminal terminal = Predictor({"calibrate", "loop", "--arm", "left"});
    Begin(&terminal);
    // If a busy computer interrupts a measurement, the measurement begins again after the key is
    // released.
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
    // The delays of the wire and of the controller's cycles add to the loop's delay.
    EXPECT_GT(found.delay, truth.delay) << screen;
    EXPECT_LT(found.delay, truth.delay + 0.008) << screen;
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

}  // namespace
}  // namespace predictor
