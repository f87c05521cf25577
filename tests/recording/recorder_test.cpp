// Tests the real-time recorder, which reports lost ticks, tolerates a slow disk, and reports a full
// one.
#include "recording/recorder.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <set>
#include <thread>

#include "core/error.h"
#include "recording/reader.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/writer.h"
#include "support/soak.h"

namespace predictor {
namespace {

using namespace recording_test;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

std::uint64_t Now() {
  return static_cast<std::uint64_t>(Clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
}

TickRecord LiveTick(std::uint64_t tick) {
  TickRecord record = SampleTick(tick);
  record.wall_ns = Now();
  return record;
}

// Waits without a time limit, because ctest's limit ends a test that hangs.
void Await(const std::function<bool()>& done) {
  while (!done()) std::this_thread::sleep_for(milliseconds(2));
}

// A disk that can be slow, full or broken and that logs its calls.
class Disk : public FileCalls {
 public:
  struct Call {
    bool sync;
    std::uint64_t at, end;  // [ns]
    std::uint64_t bytes;    // written before the call began
  };
  ssize_t Write(int fd, const void* bytes, std::size_t n, std::uint64_t at) override {
    std::this_thread::sleep_for(write_time.load());
    while (held) std::this_thread::sleep_for(milliseconds(1));
    const std::uint64_t room = capacity > written ? capacity - written : 0;
    if (refused > 0) ++writes_after_refusal;
    if (room == 0) {
      ++refused;
      errno = ENOSPC;
      return -1;
    }
    const ssize_t done = FileCalls::Write(fd, bytes, std::min<std::uint64_t>(n, room), at);
    if (done > 0) {
      const std::scoped_lock lock(mutex);
      written += static_cast<std::uint64_t>(done);
      calls.push_back({false, Now(), Now(), written});
    }
    return done;
  }
  int DataSync(int) override {
    const Call call{true, Now(), 0, written};
    std::this_thread::sleep_for(sync_time.load());
    const std::scoped_lock lock(mutex);
    calls.push_back(call);
    calls.back().end = Now();
    errno = EIO;
    return broken ? -1 : 0;
  }
  int Truncate(int fd, std::uint64_t size) override {
    written = std::min<std::uint64_t>(written, size);
    return FileCalls::Truncate(fd, size);
  }
  int Reserve(int, std::uint64_t from, std::uint64_t n) override {
    errno = ENOSPC;
    reserves_refused = from + n <= capacity ? 0 : reserves_refused + 1;
    // fails even without the space that is reserved in advance
    if (reserves_refused >= 2) ++refused;
    return reserves_refused == 0 ? 0 : -1;
  }
  std::uint64_t FreeBytes(int) override { return free_bytes; }

  std::atomic<milliseconds> write_time{milliseconds(0)}, sync_time{milliseconds(0)};
  std::atomic<bool> held{false};  // the disk accepts no data
  std::atomic<std::uint64_t> capacity{~std::uint64_t{0}}, written{0};
  std::atomic<std::uint64_t> free_bytes{100'000'000'000};
  std::atomic<bool> broken{false};
  std::atomic<int> refused{0}, writes_after_refusal{0};
  std::mutex mutex;
  std::vector<Call> calls;

 private:
  int reserves_refused = 0;  // in a row
};

class Live : public ::testing::Test {
 protected:
  RecorderOptions Options() {
    RecorderOptions options;
    options.notify = [this](const std::string& sentence) {
      const std::scoped_lock lock(mutex_);
      messages_.push_back(sentence);
    };
    return options;
  }
  std::vector<std::string> messages() {
    const std::scoped_lock lock(mutex_);
    return messages_;
  }
  void Publish(std::uint64_t ticks) {
    for (std::uint64_t k = 0; k < ticks; ++k) ring_->Publish(LiveTick(++tick_));
  }
  // Publishes ticks at 1 kHz until `done` returns true.
  void PublishUntil(const std::function<bool()>& done) {
    while (!done()) {
      Publish(1);
      std::this_thread::sleep_for(milliseconds(1));
    }
  }

  Folder folder_;
  const std::string path_ = folder_.File("a.mcap");
  std::unique_ptr<RecordRing> ring_ = std::make_unique<RecordRing>();
  std::uint64_t tick_ = 0;
  Disk disk_;

 private:
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

// An exception in the recorder's own threads must end only the recording, with a message.
class Thrower : public Disk {
 public:
  ssize_t Write(int fd, const void* bytes, std::size_t n, std::uint64_t at) override {
    if (throws_in_write.exchange(false)) throw std::runtime_error("no more paper");
    return Disk::Write(fd, bytes, n, at);
  }
  int DataSync(int fd) override {
    if (throws_in_sync.exchange(false)) throw std::runtime_error("no more ink");
    return Disk::DataSync(fd);
  }
  std::atomic<bool> throws_in_write{false}, throws_in_sync{false};
};

TEST_F(Live, EndsWithASentenceWhenAThreadOfItsThrows) {
  for (const bool in_write : {true, false}) {
    Thrower disk;
    const std::string path = folder_.File(in_write ? "write.mcap" : "sync.mcap");
    RecorderOptions options = Options();
    options.sync_period = milliseconds(5);
    Recorder recorder(path, SampleHeader(), *ring_, options, {}, &disk);
    PublishUntil([&] { return recorder.status().ticks > 0; });
    (in_write ? disk.throws_in_write : disk.throws_in_sync) = true;
    PublishUntil(
        [&] { return !recorder.status().recording && messages().size() == (in_write ? 1 : 2); });
    const std::string why = in_write ? "no more paper" : "writing to the disk failed: no more ink";
    EXPECT_NE(messages().back().find(": The recording ended: " + why), std::string::npos)
        << messages().back();
    recorder.Close();
    EXPECT_EQ(recorder.status().ended_why, messages().back());
    RecordingReader reader(path);
    EXPECT_TRUE(reader.complete()) << reader.problem();
    EXPECT_EQ(reader.count(), recorder.status().ticks);
  }
}

// Even if the callback that receives the message also throws, the recording must end.
TEST_F(Live, EndsEvenIfTheMessageCannotBeDelivered) {
  RecorderOptions options;
  options.notify = [](const std::string&) { throw std::runtime_error("no listener"); };
  disk_.capacity = 1U << 20U;
  Recorder recorder(path_, SampleHeader(), *ring_, options, {}, &disk_);
  PublishUntil([&] { return !recorder.status().recording; });
  recorder.Close();
  EXPECT_NE(recorder.status().ended_why.find("The recording ended"), std::string::npos);
}

TEST_F(Live, RecordsEveryTickMarksAndSnapshots) {
  Recorder recorder(path_, SampleHeader(), *ring_, Options(), {}, &disk_);
  Publish(100);
  std::span<std::byte> buffer;
  Await([&] { return !(buffer = recorder.SnapshotBuffer()).empty(); });
  std::memset(buffer.data(), 9, 300);
  recorder.SnapshotTaken(100, 300);
  EXPECT_TRUE(recorder.SnapshotBuffer().empty());
  recorder.Mark("here");
  Publish(1900);
  recorder.Close();
  const RecorderStatus status = recorder.status();
  EXPECT_FALSE(status.recording);
  EXPECT_EQ(status.ended_why, "");
  EXPECT_EQ(status.ticks, 2000u);
  EXPECT_EQ(status.lost, 0u);
  EXPECT_EQ(status.bytes, std::filesystem::file_size(path_));
  RecordingReader reader(path_);
  EXPECT_EQ(reader.count(), 2000u);
  EXPECT_EQ(reader.snapshots(), std::vector<std::uint64_t>{100});
  ASSERT_EQ(reader.events().size(), 1u);
  EXPECT_EQ(reader.events()[0].kind, "marker");
  EXPECT_EQ(reader.events()[0].text, "here");
  reader.Check();
  EXPECT_TRUE(messages().empty());
}

// The test causes the overrun intentionally. The disk accepts no data until the queue of chunks and
// the ring are full.
TEST_F(Live, ReportsLostTicksAndRequestsASnapshotAfterThem) {
  RecorderOptions options = Options();
  options.max_queued = 1;
  Recorder recorder(path_, SampleHeader(), *ring_, options, {}, &disk_);
  Publish(10);
  Await([&] { return !recorder.SnapshotBuffer().empty(); });
  recorder.SnapshotTaken(10, 1);
  // Even if the recorder encodes fast, it must wait for a disk that accepts no data, so the ring
  // overflows.
  for (std::uint64_t n = 20'000; recorder.status().lost == 0; n *= 2) {
    disk_.held = true;
    Publish(n);
    disk_.held = false;
    Await([&] { return recorder.status().ticks + recorder.status().lost >= tick_; });
  }
  Await([&] { return !recorder.SnapshotBuffer().empty(); });
  const std::uint64_t after = tick_;
  recorder.SnapshotTaken(after, 2);
  Publish(50);
  recorder.Close();
  RecordingReader reader(path_);
  std::uint64_t reported = 0, missing = 0, last = 0;
  for (const RecordingEvent& gap : reader.gaps()) reported += gap.lost;
  for (TickRecord record; reader.Next(&record); last = record.tick)
    missing += record.tick - last - 1;
  EXPECT_GT(missing, 0u);
  EXPECT_EQ(reported, missing);
  EXPECT_EQ(recorder.status().lost, missing);
  EXPECT_EQ(last, tick_);
  EXPECT_EQ(reader.snapshots(), (std::vector<std::uint64_t>{10, after}));
  reader.Check();
}

// A single event must report all gaps that lie within one second of the records' clock.
TEST_F(Live, ManyGapsAreReportedTogether) {
  RecorderOptions options = Options();
  options.max_queued = 1;
  Recorder recorder(path_, SampleHeader(), *ring_, options, {}, &disk_);
  const auto publish = [&](std::uint64_t ticks) {
    for (std::uint64_t k = 0; k < ticks; ++k) {
      TickRecord record = SampleTick(++tick_);
      record.wall_ns = 1 + tick_;  // all within a second
      ring_->Publish(record);
    }
  };
  constexpr int kHoles = 5;
  std::uint64_t n = 20'000;
  for (int hole = 0; hole < kHoles; ++hole) {
    const std::uint64_t before = recorder.status().lost;
    for (; recorder.status().lost == before; n *= 2) {
      disk_.held = true;
      publish(n);
      disk_.held = false;
      Await([&] { return recorder.status().ticks + recorder.status().lost >= tick_; });
    }
    n /= 2;
  }
  ASSERT_LT(tick_, 1'000'000'000u);
  recorder.Close();
  RecordingReader reader(path_);
  std::uint64_t holes = 0, missing = 0, reported = 0, last = 0;
  for (TickRecord record; reader.Next(&record); last = record.tick) {
    holes += record.tick > last + 1;
    missing += record.tick - last - 1;
  }
  EXPECT_GE(holes, static_cast<std::uint64_t>(kHoles));
  // There may be one event for the first gap, and one at the end for all others.
  EXPECT_LE(reader.gaps().size(), 2u);
  for (const RecordingEvent& gap : reader.gaps()) reported += gap.lost;
  EXPECT_EQ(reported, missing);
  EXPECT_NE(reader.gaps().back().text.find(" places"), std::string::npos);
}

// After a power failure at any moment, the recording must be preserved except for its last five
// seconds, because all older data has been synchronised. Each prefix of the file that could be on
// the disk must be readable.
TEST_F(Live, IsMadeToLastEveryFewSecondsSoak) {
  disk_.sync_time = milliseconds(300);
  const std::uint64_t start = Now();
  std::vector<std::uint64_t> ticked;  // times of the ticks [ns]
  {
    Recorder recorder(path_, SampleHeader(), *ring_, Options(), {}, &disk_);
    const auto end = Clock::now() + std::chrono::seconds(Count(11, 60));
    PublishUntil([&] { return Clock::now() >= end; });
    std::vector<Disk::Call> calls;
    {
      const std::scoped_lock lock(disk_.mutex);
      calls = disk_.calls;
    }
    std::uint64_t durable = start;  // all data written before this moment is on the disk
    std::uint64_t longest = 0;
    for (const Disk::Call& call : calls) {
      if (!call.sync) continue;
      longest = std::max(longest, call.end - durable);
      durable = call.at;
    }
    longest = std::max(longest, Now() - durable);
    // A chunk may wait for another half second.
    EXPECT_LT(longest, 4'500'000'000u);
    EXPECT_GE(std::count_if(calls.begin(), calls.end(), [](const auto& c) { return c.sync; }), 3);
  }
  const std::string bytes = ReadFile(path_);
  const std::uint64_t count = RecordingReader(path_).count();
  const std::scoped_lock lock(disk_.mutex);
  std::set<std::uint64_t> sizes;  // a call may end later than one that began with more bytes
  for (const Disk::Call& call : disk_.calls) sizes.insert(call.bytes);
  std::uint64_t last = 0;
  for (const std::uint64_t size : sizes) {
    WriteFile(folder_.File("prefix.mcap"), bytes.substr(0, size));
    RecordingReader reader(folder_.File("prefix.mcap"));
    std::uint64_t ticks = 0;
    for (TickRecord record; reader.Next(&record);) EXPECT_EQ(record.tick, ++ticks);
    EXPECT_GE(ticks, last);
    last = ticks;
  }
  EXPECT_EQ(last, count);
}

// The disk takes three seconds to synchronise and half a second for each write, but nothing may be
// lost.
TEST_F(Live, ASlowDiskLosesNothing) {
  disk_.sync_time = milliseconds(3000);
  disk_.write_time = milliseconds(300);
  {
    Recorder recorder(path_, SampleHeader(), *ring_, Options(), {}, &disk_);
    const auto end = Clock::now() + std::chrono::seconds(5);
    PublishUntil([&] { return Clock::now() >= end; });
    EXPECT_EQ(recorder.status().lost, 0u);
    disk_.sync_time = disk_.write_time = milliseconds(0);
  }
  EXPECT_EQ(RecordingReader(path_).count(), tick_);
}

// Between the first refusal and the message, only the index is written, so the message comes
// immediately.
TEST_F(Live, AFullDiskEndsItAndTheFileIsWhole) {
  disk_.capacity = 1'500'000;
  RecorderOptions options = Options();
  std::atomic<int> writes_when_notified{-1};
  options.notify = [&, notify = options.notify](const std::string& sentence) {
    writes_when_notified = disk_.writes_after_refusal.load();
    notify(sentence);
  };
  Recorder recorder(path_, SampleHeader(), *ring_, options, {}, &disk_);
  PublishUntil([&] { return !recorder.status().recording; });
  const RecorderStatus status = recorder.status();
  EXPECT_NE(status.ended_why.find("No space left on device"), std::string::npos)
      << status.ended_why;
  EXPECT_NE(status.ended_why.find(std::to_string(status.ticks) + " ticks"), std::string::npos);
  recorder.Close();
  EXPECT_EQ(messages(), std::vector<std::string>{status.ended_why});
  EXPECT_EQ(disk_.refused, 1);
  EXPECT_EQ(writes_when_notified, 1);
  EXPECT_EQ(disk_.writes_after_refusal, 1);
  RecordingReader reader(path_);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.count(), status.ticks);
  EXPECT_GT(status.ticks, 0u);
  reader.Check();
}

TEST_F(Live, ABrokenDiskEndsIt) {
  disk_.broken = true;
  Recorder recorder(path_, SampleHeader(), *ring_, Options(), {}, &disk_);
  PublishUntil([&] { return !recorder.status().recording; });
  const std::string why = recorder.status().ended_why;
  EXPECT_NE(why.find("Input/output error"), std::string::npos);
  EXPECT_NE(why.find("confirmed 0 of "), std::string::npos) << why;
  EXPECT_EQ(why.find("can be read"), std::string::npos) << why;
}

// The message may report only those ticks as saved that the disk confirmed before it failed.
TEST_F(Live, ADiskThatBreaksHasWhatItConfirmed) {
  RecorderOptions options = Options();
  options.sync_period = milliseconds(50);
  Recorder recorder(path_, SampleHeader(), *ring_, options, {}, &disk_);
  PublishUntil([&] { return recorder.status().ticks > 500; });
  const std::uint64_t there = recorder.status().ticks;
  const auto syncs = [&] {
    const std::scoped_lock lock(disk_.mutex);
    return std::count_if(disk_.calls.begin(), disk_.calls.end(),
                         [](const Disk::Call& call) { return call.sync; });
  };
  // The test waits for two synchronisations that begin after the tick `there` was written.
  const auto before = syncs();
  PublishUntil([&] { return syncs() >= before + 3; });
  disk_.broken = true;
  PublishUntil([&] { return !recorder.status().recording; });
  const RecorderStatus status = recorder.status();
  const std::size_t at = status.ended_why.find("confirmed ");
  ASSERT_NE(at, std::string::npos) << status.ended_why;
  const std::uint64_t confirmed = std::stoull(status.ended_why.substr(at + 10));
  EXPECT_GE(confirmed, there);
  EXPECT_LE(confirmed, status.ticks);
}

TEST_F(Live, LittleSpaceIsReportedAndThenEndsIt) {
  disk_.free_bytes = 5'000'000'000;
  Recorder recorder(path_, SampleHeader(), *ring_, Options(), {}, &disk_);
  PublishUntil([&] { return !messages().empty(); });
  EXPECT_NE(messages()[0].find("Only 5.0 GB are free"), std::string::npos) << messages()[0];
  EXPECT_TRUE(recorder.status().recording);
  disk_.free_bytes = 900'000'000;
  PublishUntil([&] { return !recorder.status().recording; });
  EXPECT_EQ(messages().size(), 2u);
  EXPECT_NE(recorder.status().ended_why.find("only 0.9 GB are free"), std::string::npos);
  recorder.Close();
  RecordingReader reader(path_);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.count(), recorder.status().ticks);
}

// The same rules apply in virtual time.
TEST_F(Live, AWriterWarnsSynchronisesAndEndsAsTheRecorderDoes) {
  disk_.free_bytes = 5'000'000'000;
  DiskRules rules = Options();
  rules.sync_period = milliseconds(0);
  RecordingWriter writer(path_, SampleHeader(), {}, &disk_, rules);
  while (writer.ticks() == 0) writer.Add(SampleTick(++tick_));
  ASSERT_EQ(messages().size(), 1u);
  EXPECT_NE(messages()[0].find("Only 5.0 GB are free"), std::string::npos) << messages()[0];
  const auto syncs = std::count_if(disk_.calls.begin(), disk_.calls.end(),
                                   [](const Disk::Call& call) { return call.sync; });
  EXPECT_EQ(syncs, 1);
  disk_.free_bytes = 900'000'000;
  std::string why;
  try {
    for (;;) writer.Add(SampleTick(++tick_));
  } catch (const RecordingError& error) {
    why = error.what();
  }
  EXPECT_NE(why.find("only 0.9 GB are free"), std::string::npos) << why;
  EXPECT_NE(why.find("were stored and can be read"), std::string::npos) << why;
  EXPECT_EQ(messages().size(), 1u);
  RecordingReader reader(path_);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.count(), writer.ticks());
}

TEST_F(Live, AWriterSaysWhatABrokenDiskHadConfirmed) {
  disk_.broken = true;
  DiskRules rules = Options();
  rules.sync_period = milliseconds(0);
  RecordingWriter writer(path_, SampleHeader(), {}, &disk_, rules);
  try {
    for (;;) writer.Add(SampleTick(++tick_));
  } catch (const RecordingError& error) {
    EXPECT_NE(std::string(error.what()).find("confirmed 0 of "), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace predictor
