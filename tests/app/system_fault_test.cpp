// Tests faults of the operating system during a run of the program as a separate process.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "app/child.h"
#include "support/faulty_system.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

std::string TemporaryFile(const std::string& name) {
  return (fs::temp_directory_path() / (std::to_string(getpid()) + "-" + name)).string();
}

// A run must never depend on the wall clock (fault 32).
TEST(SystemFault, AWallClockThatJumpsChangesNothing) {
  for (const std::string jump : {"3600", "-3600"}) {
    const std::string recording = TemporaryFile("clock.mcap");
    {
      const FaultySystem system("FAULTY_CLOCK", "1," + jump);
      Child run({"run", Scenario("box_9kg"), "--duration", "3", "--no-viewer", "--json", "-",
                 "--record", recording});
      EXPECT_EQ(run.Wait(), 0) << run.errors();
      const auto summary = nlohmann::json::parse(run.output());
      EXPECT_TRUE(summary["stop"].is_null()) << run.errors();
      EXPECT_NEAR(summary["duration_s"], 3, 0.01);
    }
    Child again({"verify", recording});
    EXPECT_EQ(again.Wait(), 0) << again.output() << again.errors();
    fs::remove(recording);
  }
}

// Without real-time priority (the milder form of fault 33), a simulated rig waits for the loop, and
// the program prints a warning.
TEST(SystemFault, WithoutRealTimePriorityASimulatedRunContinues) {
  const FaultySystem system("FAULTY_PRIORITY", "1");
  Child run({"run", Scenario("box_9kg"), "--duration", "1", "--no-viewer"});
  EXPECT_EQ(run.Wait(), 0) << run.errors();
  EXPECT_NE(run.errors().find("Real-time scheduling: refused"), std::string::npos) << run.errors();
}

// If another program uses the port, the run must not choose a different one (fault 50).
TEST(SystemFault, ABusyPortEndsTheRunBeforeItBegins) {
  const int socket_ = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(listen(socket_, 1), 0);
  socklen_t size = sizeof address;
  ASSERT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string port = std::to_string(ntohs(address.sin_port));
  Child run({"run", Scenario("box_9kg"), "--duration", "1", "--port", port});
  EXPECT_NE(run.Wait(), 0);
  EXPECT_NE(run.errors().find(port), std::string::npos) << run.errors();
  EXPECT_EQ(run.errors().find("http://"), std::string::npos) << run.errors();
  EXPECT_EQ(run.errors().find("No safety stop"), std::string::npos) << run.errors();
  close(socket_);
}

// In contrast, a run that receives SIGTERM brings the arms to rest and completes its recording.
TEST(SystemFault, ARunThatReceivesSigtermFinishesItsRecording) {
  const std::string recording = TemporaryFile("end.mcap");
  Child run({"run", Scenario("box_9kg"), "--no-viewer", "--record", recording});
  ASSERT_TRUE(run.Says("RUN")) << run.errors();
  run.Send(SIGTERM);
  EXPECT_EQ(run.Wait(), 0) << run.errors();
  Child again({"verify", recording});
  EXPECT_EQ(again.Wait(), 0) << again.output() << again.errors();
  EXPECT_EQ(again.errors().find("cut"), std::string::npos) << again.errors();
  fs::remove(recording);
}

}  // namespace
}  // namespace predictor
