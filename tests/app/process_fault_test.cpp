// Tests faults at the boundary between program and system: files that cannot grow, readers that do
// not read, threads without memory, and a computer that was suspended.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "app/child.h"
#include "support/faulty_system.h"
#include "support/process.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

// While it exists, this object limits the file size of each program that is started, as `ulimit -f`
// does.
class FileSize {
 public:
  explicit FileSize(rlim_t bytes) {
    EXPECT_EQ(getrlimit(RLIMIT_FSIZE, &before_), 0);
    const rlimit limit = {bytes, before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileSize() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSize(const FileSize&) = delete;
  FileSize& operator=(const FileSize&) = delete;

 private:
  rlimit before_{};
};

constexpr rlim_t kLimit = 3U << 20U;  // [bytes]

// The recording must be intact up to the limit, and verification must reproduce it bit for bit.
void ExpectVerified(const std::string& recording) {
  EXPECT_LE(fs::file_size(recording), kLimit);
  EXPECT_GT(fs::file_size(recording), kLimit / 2);
  Child again({"verify", recording});
  EXPECT_EQ(again.Wait(), 0) << again.output() << again.errors();
  EXPECT_EQ(again.errors().find("cut"), std::string::npos) << again.errors();
}

// The test sets the limit during the run, because the run's shared memory is larger than this
// recording.
TEST(FileSizeLimit, EndsTheRecordingButNotTheRun) {
  const test::TemporaryFolder folder;
  const std::string recording = folder.path() / "a.mcap";
  Child run({"run", Scenario("box_9kg"), "--duration", "10", "--no-viewer", "--json", "-",
             "--record", recording});
  ASSERT_TRUE(test::Becomes([&] { return fs::exists(recording); }));
  ASSERT_TRUE(run.Says("RUN")) << run.errors();
  const rlimit limit = {kLimit, kLimit};
  ASSERT_EQ(prlimit(run.pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  EXPECT_EQ(run.Wait(), 3) << run.errors();  // reports the incomplete recording
  EXPECT_NE(run.errors().find("The recording ended: "), std::string::npos) << run.errors();
  EXPECT_NE(run.errors().find("File too large"), std::string::npos) << run.errors();
  const auto summary = nlohmann::json::parse(run.output());
  EXPECT_TRUE(summary["stop"].is_null()) << run.errors();
  EXPECT_NEAR(summary["duration_s"], 10, 0.01);
  ExpectVerified(recording);
}

// The limit is lower than the run's shared memory, so the program refuses the run before anything
// moves.
TEST(FileSizeLimit, ThatLeavesNoRoomForARunIsReportedAtItsStart) {
  const FileSize limit(1U << 20U);
  Child run({"run", Scenario("box_9kg"), "--duration", "1", "--no-viewer"});
  EXPECT_EQ(run.Wait(), 3);
  EXPECT_NE(run.errors().find("ulimit -f"), std::string::npos) << run.errors();
}

TEST(FileSizeLimit, IsReportedForASimulatedRun) {
  const test::TemporaryFolder folder;
  const std::string recording = folder.path() / "a.mcap";
  {
    const FileSize limit(kLimit);
    Child run(
        {"simulate", Scenario("box_9kg"), "--duration", "8", "--quiet", "--record", recording});
    const int code = run.Wait();
    EXPECT_GT(code, 0) << run.errors();  // no signal killed it
    EXPECT_NE(run.errors().find("File too large"), std::string::npos) << run.errors();
  }
  ExpectVerified(recording);
}

// Every command must ignore the signal SIGXFSZ, even if it records nothing.
TEST(FileSizeLimit, IsAnErrorOfEveryCommand) {
  const test::TemporaryFolder folder;
  const FileSize limit(16);
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"simulate", Scenario("box_9kg"), "--duration", "0.1", "--quiet", "--json",
            folder.path() / "summary.json"},
           {"export", "scene", Scenario("box_9kg"), "-o", folder.path() / "scene"}}) {
    Child command(arguments);
    EXPECT_GE(command.Wait(), 0) << arguments[0];
  }
}

// A full pipe that no process reads. The pipe stands for a standard error that accepts no more
// data, for example because a pager is not scrolled or a terminal is paused.
class FullPipe {
 public:
  FullPipe() {
    EXPECT_EQ(pipe2(ends_.data(), O_CLOEXEC), 0);
    EXPECT_EQ(fcntl(ends_[1], F_SETFL, O_NONBLOCK), 0);
    std::array<char, 4096> nothing{};
    while (write(ends_[1], nothing.data(), nothing.size()) > 0) {
    }
    EXPECT_EQ(fcntl(ends_[1], F_SETFL, 0), 0);
  }
  ~FullPipe() {
    close(ends_[0]);
    close(ends_[1]);
  }
  int end() const { return ends_[1]; }

 private:
  std::array<int, 2> ends_{};
};

TEST(UnreadOutput, DoesNotKeepARunFromEnding) {
  const test::TemporaryFolder folder;
  const std::string recording = folder.path() / "a.mcap";
  const FullPipe unread;
  Child run({"run", Scenario("box_9kg"), "--duration", "3600", "--no-viewer", "--json", "-",
             "--record", recording},
            "", unread.end());
  // The recorder writes 1.2 MB of scene before the first tick, and a second of ticks is 1.4 MB.
  ASSERT_TRUE(test::Becomes(
      [&] { return fs::exists(recording) && fs::file_size(recording) > (4U << 20U); }));
  const auto begin = std::chrono::steady_clock::now();
  run.Send(SIGINT);
  EXPECT_TRUE(test::Becomes([&] { return test::StatusOf(run.pid(), "State").starts_with("Z"); }));
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  // This time is the requirement. The program waits 1 s for the reader (patient_output.cpp).
  EXPECT_LT(time.count(), 5);
  run.Send(SIGKILL);  // in case it did not end
  EXPECT_EQ(run.Wait(), 0);
  EXPECT_TRUE(nlohmann::json::parse(run.output())["stop"].is_null());
  Child again({"verify", recording});
  EXPECT_EQ(again.Wait(), 0) << again.output() << again.errors();
}

TEST(UnreadOutput, DoesNotKeepAReplayFromEnding) {
  const test::TemporaryFolder folder;
  const std::string recording = folder.path() / "a.mcap";
  Child first({"simulate", Scenario("box_9kg"), "--duration", "20", "--record", recording});
  ASSERT_EQ(first.Wait(), 0);
  const FullPipe unread;
  Child replay({"replay", recording, "--port", "0"}, "", unread.end());
  std::this_thread::sleep_for(std::chrono::seconds(1));  // it waits for its output to be read
  replay.Send(SIGINT);
  EXPECT_TRUE(
      test::Becomes([&] { return test::StatusOf(replay.pid(), "State").starts_with("Z"); }));
  replay.Send(SIGKILL);  // in case it did not end
  EXPECT_EQ(replay.Wait(), 0);
}

TEST(Memory, OfTheFollowerExhaustedEndsTheRun) {
  const FaultySystem system("FAULTY_MEMORY", "follower,4,1");
  Child run({"run", Scenario("box_9kg"), "--duration", "40", "--no-viewer", "--stay"});
  EXPECT_EQ(run.Wait(), 3) << run.errors();
  EXPECT_NE(run.errors().find("this program can no longer monitor it (std::bad_alloc)."),
            std::string::npos)
      << run.errors();
}

TEST(Memory, OfTheRecorderExhaustedEndsTheRecordingNotTheRun) {
  // The first size, 16384, is that of a chunk's buffer. Smaller allocations might come from
  // nlohmann's JSON, whose destructor needs memory.
  for (const std::string fault : {"record encode,2,16384", "record write,2,64"}) {
    const test::TemporaryFolder folder;
    const FaultySystem system("FAULTY_MEMORY", fault);
    Child run({"run", Scenario("box_9kg"), "--duration", "6", "--no-viewer", "--json", "-",
               "--record", folder.path() / "a.mcap"});
    EXPECT_EQ(run.Wait(), 3) << run.errors();
    EXPECT_NE(run.errors().find("The recording ended: std::bad_alloc."), std::string::npos)
        << run.errors();
    const auto summary = nlohmann::json::parse(run.output());
    EXPECT_TRUE(summary["stop"].is_null()) << run.errors();
    EXPECT_NEAR(summary["duration_s"], 6, 0.01);
  }
}

// The viewer process dies while the thread that supervises it has no memory.
TEST(Memory, OfTheSupervisorExhaustedDoesNotEndIt) {
  const FaultySystem system("FAULTY_MEMORY", "supervisor,1,1");
  Child run({"run", Scenario("box_9kg"), "--duration", "3600", "--port", "0", "--no-evaluation"});
  ASSERT_TRUE(run.Says("Viewer: http")) << run.errors();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  std::ifstream children("/proc/" + std::to_string(run.pid()) + "/task/" +
                         std::to_string(run.pid()) + "/children");
  int viewer = 0;
  ASSERT_TRUE(children >> viewer);
  ASSERT_EQ(kill(viewer, SIGKILL), 0);
  EXPECT_TRUE(run.Says("The viewer: std::bad_alloc. Supervision continues.")) << run.errors();
  run.Send(SIGINT);
  EXPECT_EQ(run.Wait(), 0) << run.errors();
}

TEST(Suspend, StopsTheRunAndIsReported) {
  const FaultySystem system("FAULTY_SUSPEND", "2,3600");
  Child run(
      {"run", Scenario("box_9kg"), "--duration", "3600", "--no-viewer", "--json", "-", "--stay"});
  EXPECT_TRUE(run.Says("after the stop 'deadline'. The computer was suspended (3600 s"))
      << run.errors();
  run.Send(SIGINT);
  EXPECT_EQ(run.Wait(), 1) << run.errors();
  EXPECT_EQ(nlohmann::json::parse(run.output())["stop"]["cause"], "deadline") << run.output();
}

}  // namespace
}  // namespace predictor
