// Tests the commands that a person types at the fake rig, as in docs/tutorials/fake-rig.md.
#include "machine/rig_process.h"

namespace predictor {
namespace {

class FakeRigsLines : public testing::Test {
 protected:
  FakeRig rig_{FileOf("dual_ur5"), {"left=ur:" + HostOf(kLeft), "right=ur:" + HostOf(kRight)}};
};

TEST_F(FakeRigsLines, AreListedByHelp) {
  std::string help = rig_.Ask("help") + "\n";
  // The answer to the next command follows the list.
  for (std::string line = rig_.Ask("mark"); line != "ok"; line = rig_.Ask("mark"))
    help += line + "\n";
  for (const char* command : {"run", "rest", "press", "lead", "led", "state", "joints", "mark",
                              "motion", "wire", "do", "log", "help", "quit"})
    EXPECT_NE(help.find(command), std::string::npos) << command << "\n" << help;
}

TEST_F(FakeRigsLines, AreDoneOnlyIfUnderstoodToTheirLastWord) {
  EXPECT_EQ(rig_.Ask("dance"), "There is no command \"dance\". Type help for a list.");
  EXPECT_EQ(rig_.Ask("state left"), "state takes no arguments, but left was given.");
  EXPECT_EQ(rig_.Ask("press up 1 2 3"), "press needs a side, left or right. See help.");
  EXPECT_EQ(rig_.Ask("press left 1 2"),
            "press takes 3 numbers, but 2 were given. The command was ignored.");
  EXPECT_EQ(rig_.Ask("press left 1 2 3 4"),
            "press takes 3 numbers, but 4 were given. The command was ignored.");
  EXPECT_EQ(rig_.Ask("press left 1 2 3 N"), "N is not a number. The command was ignored.");
  EXPECT_EQ(rig_.Ask("joints left 1"),
            "joints takes 0 numbers, but 1 were given. The command was ignored.");
  EXPECT_EQ(rig_.Ask("do left"), "do needs the place of a fake. 0 is the first one of that side.");
  EXPECT_EQ(rig_.Ask("do left 1 press 8"), "There is no fake at place 1.");
  EXPECT_EQ(rig_.Ask("do left 0 press 8 9"), "9 is not expected here. The command was ignored.");
  EXPECT_EQ(rig_.Ask("do left 0 press it"), "That fake cannot interpret \"press it\".");
  EXPECT_EQ(rig_.Ask("do left 0 dance"), "That fake does not know \"dance\".");
  EXPECT_EQ(rig_.Ask("log left 0 all"), "all is not expected here.");
  for (const char* line : {"press left 1 2 3", "press left 0 0 0", "do left 0 press 8",
                           "do left 0 protective stop", "lead left", "run", "rest"})
    EXPECT_EQ(rig_.Ask(line), "ok") << line;
}

TEST_F(FakeRigsLines, StateUnits) {
  const std::string state = rig_.Ask("state");
  std::istringstream words(state);
  std::vector<std::string> all{std::istream_iterator<std::string>(words), {}};
  ASSERT_EQ(all.size(), 2 * (1 + 2 * 8U)) << state;
  EXPECT_EQ(all[8], "rad") << state;
  EXPECT_EQ(all[16], "rad/s") << state;
}

}  // namespace
}  // namespace predictor
