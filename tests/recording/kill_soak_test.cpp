// After kill −9 at a random moment, at most the last second may be lost.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "recording/reader.h"
#include "recording/recorder.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "support/soak.h"

namespace predictor {
namespace {

using namespace recording_test;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// The progress that the child publishes. The parent can read it even after the child's death.
struct Progress {
  std::atomic<std::uint64_t> tick{0};
};

[[noreturn]] void RecordForever(const std::string& path, Progress* progress) {
  auto ring = std::make_unique<RecordRing>();
  Recorder recorder(path, SampleHeader(), *ring);
  const auto start = Clock::now();
  for (std::uint64_t tick = 1;; ++tick) {
    TickRecord record = SampleTick(tick);
    record.wall_ns = tick * 1'000'000;
    ring->Publish(record);
    progress->tick = tick;
    if (const auto buffer = recorder.SnapshotBuffer(); !buffer.empty())
      recorder.SnapshotTaken(tick, buffer.size() / 2);
    std::this_thread::sleep_until(start + milliseconds(tick));
  }
}

TEST(RecordingSoak, KilledAtRandomMoments) {
  void* memory =
      mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::mt19937 random(5);
  std::uint64_t max_lost = 0;
  const long kills = Count(10, 300);
  for (long k = 0; k < kills; ++k) {
    const Folder folder;
    const std::string path = folder.File("a.mcap"), out = folder.File("b.mcap");
    auto* progress = new (memory) Progress;
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) RecordForever(path, progress);
    const std::uint64_t until = 1 + random() % 3000;
    while (progress->tick < until) std::this_thread::sleep_for(milliseconds(1));
    // The signal may arrive at any stage of writing a chunk.
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 1000));
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    const std::uint64_t published = progress->tick;

    const RecoverReport report = Recover(path, out);
    RecordingReader reader(out);
    EXPECT_TRUE(reader.complete());
    EXPECT_EQ(reader.count(), report.ticks);
    TickRecord record;
    for (std::uint64_t tick = 1; tick <= report.ticks; ++tick) {
      ASSERT_TRUE(reader.Next(&record));
      TickRecord expected = SampleTick(tick);
      expected.wall_ns = tick * 1'000'000;
      ASSERT_TRUE(Same(record, expected)) << "kill " << k << ", tick " << tick;
    }
    ASSERT_GE(published, report.ticks);
    max_lost = std::max(max_lost, published - report.ticks);
    // The unit of time is a millisecond of the child's own clock, which stops when the machine
    // stalls.
    EXPECT_LE(published - report.ticks, 1000u) << "kill " << k << " at tick " << published;
  }
  RecordProperty("max_lost_ms", static_cast<int>(max_lost));
  std::printf("%ld kills, at most %llu ms lost\n", kills,
              static_cast<unsigned long long>(max_lost));
  munmap(memory, sizeof(Progress));
}

}  // namespace
}  // namespace predictor
