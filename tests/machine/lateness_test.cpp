// The tests must distinguish lateness of the computer, which is not a fault of the program, from
// lateness of the program.
#include <sys/socket.h>

#include "machine/attempts.h"

namespace predictor {
namespace {

TEST(LatenessIsJudged, ByTheFarEndAndNotByTheStopAlone) {
  const RigLateness calm{0.4, 0, 0.3, 40, 1}, stalled{12, 0, 0.3, 40, 12}, rig{0.4, 0, 8, 40, 1},
      busy{0.4, 0, 0.3, 40, 70};
  const std::string stale = "HELD after the stop 'stale'.", push = "HELD after the stop 'force'.",
                    key = "HELD after the stop 'enabling'.";
  // The duration of the program's silence does not matter.
  EXPECT_EQ(Judge(stale, false, calm, 1), Late::kProgram);
  EXPECT_EQ(Judge(stale, false, stalled, 12), Late::kComputer);
  EXPECT_EQ(Judge(stale, false, rig, 1), Late::kComputer);
  EXPECT_EQ(Judge("HELD after the stop 'deadline'.", false, calm, 9), Late::kComputer);
  EXPECT_EQ(Judge(push, false, stalled, 12), Late::kNothing);
  EXPECT_EQ(Judge("it crashed", false, stalled, 12), Late::kNothing);
  // The simulated person held the key the whole time.
  EXPECT_EQ(Judge(key, false, calm, 0), Late::kNothing);
  EXPECT_EQ(Judge(key, true, calm, 0), Late::kComputer);
  EXPECT_EQ(Judge(key, false, busy, 0), Late::kComputer);
  // The program's loop has priority over the busy threads.
  EXPECT_EQ(Judge(stale, false, busy, 1), Late::kProgram);
}

class Lateness : public testing::Test {
 protected:
  Lateness() : folder_({"ur", "ur"}) { folder_.NotePushTests(); }
  std::vector<std::string> Arguments() const {
    return {"run",   FileOf("dual_ur5"),     "--machine",   folder_.file(),
            "--set", "operator.type=person", "--no-viewer", "--no-record"};
  }
  static std::vector<std::string> Fakes() {
    return {"left=ur:" + HostOf(kLeft), "right=ur:" + HostOf(kRight)};
  }
  static Late JudgeOf(const Terminal& terminal, FakeRig* rig, RigLateness* once) {
    const std::uint64_t at = terminal.stop_seen();
    *once = rig->Late(at - kJustBefore, at);
    return Judge(terminal.Screen(), terminal.letter_was_late(), *once,
                 rig->Late(at - kASecond, at).processor_sum);
  }

  MachineFolder folder_;
};

// The processors were free, but the program sent nothing. Such a silence must not justify another
// attempt.
TEST_F(Lateness, OfAProgramThatStopsSendingIsItsOwn) {
  Attempts attempts;
  while (attempts.Next()) {
    FakeRig rig(FileOf("dual_ur5"), Fakes());
    Terminal terminal(Arguments());
    if (!terminal.IsIdle()) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    // waits until the load of the start-up has ended
    std::this_thread::sleep_for(std::chrono::milliseconds(1600));
    const std::uint64_t from = Terminal::Now();
    terminal.Kill(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const double silence = rig.Late(from, Terminal::Now()).silence;
    terminal.Kill(SIGCONT);
    EXPECT_TRUE(terminal.Says("after the stop", 10)) << terminal.Screen();
    EXPECT_GT(silence, 150);
    terminal.Kill(SIGINT);
    terminal.Wait();
    RigLateness once;
    const Late late = JudgeOf(terminal, &rig, &once);
    if (late == Late::kComputer) {  // the computer was late as well
      attempts.Note("a processor was late by " + std::to_string(once.processor) + " ms");
      continue;
    }
    EXPECT_EQ(late, Late::kProgram) << terminal.Screen();
    EXPECT_LT(once.rig, kLateOnce);
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

// The process of the fakes detects its own stall, so the stop is not attributed to the program.
TEST_F(Lateness, OfTheFarEndIsTheComputers) {
  Attempts attempts;
  while (attempts.Next()) {
    FakeRig rig(FileOf("dual_ur5"), Fakes());
    Terminal terminal(Arguments());
    if (!terminal.IsIdle()) {
      ASSERT_TRUE(attempts.EndedByComputer(&terminal, &rig));
      continue;
    }
    const std::uint64_t from = Terminal::Now();
    rig.Kill(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    rig.Kill(SIGCONT);
    EXPECT_TRUE(terminal.Says("after the stop", 10)) << terminal.Screen();
    terminal.Kill(SIGINT);
    terminal.Wait();
    const RigLateness late = rig.Late(from, Terminal::Now());
    EXPECT_GT(late.rig, 150);
    EXPECT_GT(late.processor, 150);
    RigLateness once;
    EXPECT_EQ(JudgeOf(terminal, &rig, &once), Late::kComputer) << terminal.Screen();
    return;
  }
  GIVE_UP_BUSY(attempts.Words());
}

}  // namespace
}  // namespace predictor
