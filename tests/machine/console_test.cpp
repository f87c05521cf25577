// Tests the commands that a person types at the console.
#include <gtest/gtest.h>

#include "machine/rig_process.h"

namespace predictor {
namespace {

TEST(ConsoleCommands, OfAViewerAreObeyed) {
  Terminal terminal({"run", FileOf("box_9kg"), "--port", "0", "--no-evaluation", "--no-record",
                     "--duration", "600"});
  ASSERT_TRUE(terminal.Says("Running", 60)) << terminal.Screen();
  constexpr const char* kAnswers[][2] = {
      {"mark here", "This run is not recorded."},
      {"status", "Viewer: 0 connected."},
      {"pin look", "(look), valid for two minutes"},
      {"pin operator", "(operator), valid for two minutes"},
      {"pin control", "(control), valid for two minutes"},
      {"revoke control", "No one holds the lease control now."},
      {"revoke operator", "No one holds the lease operator now."},
      {"foxglove", "Foxglove: ws://localhost:"},
      {"kick 12", "There is no client 12."},
      {"kick foxglove", "Foxglove was not connected."},
  };
  for (const auto& [command, answer] : kAnswers) {
    terminal.Type(std::string(command) + "\n");
    EXPECT_TRUE(terminal.Says(answer)) << command << "\n" << terminal.Screen();
  }
  for (const char* wrong :
       {"pin", "pin all", "kick", "kick 0", "kick x", "kick 1234567890", "marks", "status now"}) {
    terminal.Type(std::string(wrong) + "\n");
    EXPECT_TRUE(terminal.Says("Unknown command. The commands are: mark [TEXT], status, "))
        << wrong << "\n"
        << terminal.Screen();
  }
  terminal.Kill(SIGINT);
  EXPECT_EQ(terminal.Wait(), 0) << terminal.Screen();
}

TEST(ConsoleCommands, WithoutAViewerAreMarksOnly) {
  Terminal terminal({"run", FileOf("box_9kg"), "--no-viewer", "--no-record", "--duration", "600"});
  ASSERT_TRUE(terminal.Says("Running", 60)) << terminal.Screen();
  terminal.Type("status\n");
  EXPECT_TRUE(terminal.Says("Without a viewer page, the only command is mark [TEXT]."))
      << terminal.Screen();
  terminal.Type("mark\n");
  EXPECT_TRUE(terminal.Says("This run is not recorded.")) << terminal.Screen();
  terminal.Kill(SIGINT);
  EXPECT_EQ(terminal.Wait(), 0) << terminal.Screen();
}

}  // namespace
}  // namespace predictor
