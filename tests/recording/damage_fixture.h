// The fixture of tests that damage a small recording. The fixture compares what is read with what
// was written.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "recording/mcap.h"
#include "recording/reader.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/writer.h"

namespace predictor::recording_test {

// The complete contents of a recording.
struct Content {
  std::vector<TickRecord> ticks;
  std::vector<RecordingEvent> events;
  std::vector<RecordedSnapshot> snapshots;
  RecordingHeader header;
  std::string problem;
  bool complete = false;
};

inline bool SameHeader(const RecordingHeader& a, const RecordingHeader& b) {
  const bool files =
      std::equal(a.attachments.begin(), a.attachments.end(), b.attachments.begin(),
                 b.attachments.end(), [](const auto& x, const auto& y) {
                   return x.name == y.name && x.media_type == y.media_type && x.bytes == y.bytes;
                 });
  return files && a.scenario_yaml == b.scenario_yaml && a.scenario_name == b.scenario_name &&
         a.machine_yaml == b.machine_yaml && a.program_version == b.program_version &&
         a.engine == b.engine && a.seed == b.seed && a.dt == b.dt && a.labels == b.labels &&
         a.model_hashes == b.model_hashes && a.start_unix_ns == b.start_unix_ns;
}
inline bool SameEvent(const RecordingEvent& a, const RecordingEvent& b) {
  return a.tick == b.tick && a.unix_ns == b.unix_ns && a.kind == b.kind && a.text == b.text &&
         a.lost == b.lost;
}

// Reads the ticks up to the first error, and everything else if there is no error. Returns no value
// if the file cannot be opened.
inline std::optional<Content> ReadAll(const std::string& path, bool* failed) {
  Content content;
  *failed = true;
  try {
    RecordingReader reader(path);
    content.header = reader.header();
    content.complete = reader.complete();
    content.problem = reader.problem();
    EXPECT_TRUE(content.complete || !content.problem.empty());
    try {
      for (TickRecord record; reader.Next(&record);) content.ticks.push_back(record);
      content.events = reader.events();
      for (const std::uint64_t tick : reader.snapshots()) {
        RecordedSnapshot snapshot;
        EXPECT_TRUE(reader.SnapshotAt(tick, &snapshot));
        content.snapshots.push_back(snapshot);
      }
      EXPECT_EQ(reader.count(), content.ticks.size());
      *failed = false;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
    }
  } catch (const InputError&) {
    return {};
  }
  return content;
}

// This number of ticks fills three chunks, which also contain a snapshot and an event.
inline constexpr std::uint64_t kDamagedTicks = 15;
inline TickRecord Tick(std::uint64_t tick) { return SampleTick(tick); }

inline void WriteSmall(const std::string& path) {
  RecordingHeader header = SampleHeader();
  header.dt = 0.1;  // makes chunks of six ticks
  RecordingWriter writer(path, header);
  for (std::uint64_t tick = 1; tick <= kDamagedTicks; ++tick) {
    if (tick == 3) writer.AddEvent("marker", tick);
    if (tick == 7) writer.AddSnapshot(tick, std::vector<std::byte>(50, std::byte{7}));
    writer.Add(Tick(tick));
  }
  writer.Close();
}

class Damage : public ::testing::Test {
 protected:
  Damage() : path_(folder_.File("a.mcap")) {
    WriteSmall(path_);
    bytes_ = ReadFile(path_);
    bool failed = false;
    original_ = *ReadAll(path_, &failed);
    EXPECT_FALSE(failed);
    EXPECT_EQ(original_.ticks.size(), kDamagedTicks);
    EXPECT_EQ(original_.events.size(), 1u);
    EXPECT_EQ(original_.snapshots.size(), 1u);
    preamble_ = bytes_.find("zstd") - 4 - 28 - mcap::kHead;
    std::uint64_t summary = 0;
    std::memcpy(&summary, bytes_.data() + bytes_.size() - 8 - 20, 8);
    index_ = summary;
  }

  // The ticks must be the first ticks of the original, and all other content must also come from
  // the original.
  void ExpectPrefix(const Content& content, const std::string& what) const {
    EXPECT_TRUE(SameHeader(content.header, original_.header)) << what;
    ASSERT_LE(content.ticks.size(), original_.ticks.size()) << what;
    for (std::size_t k = 0; k < content.ticks.size(); ++k)
      ASSERT_TRUE(Same(content.ticks[k], original_.ticks[k])) << what << ", tick " << k;
    ExpectOthers(content, what);
  }
  // Makes the same checks, except that ticks may be missing if events report the loss.
  void ExpectPart(const Content& content, const std::string& what) const {
    EXPECT_TRUE(SameHeader(content.header, original_.header)) << what;
    std::uint64_t last = 0, reported = 0, missing = 0;
    for (const TickRecord& record : content.ticks) {
      ASSERT_GT(record.tick, last) << what;
      ASSERT_LE(record.tick, kDamagedTicks) << what;
      ASSERT_TRUE(Same(record, original_.ticks[record.tick - 1])) << what;
      if (last != 0) missing += record.tick - last - 1;
      last = record.tick;
    }
    for (const RecordingEvent& event : content.events) reported += event.lost;
    EXPECT_EQ(reported, missing) << what;
    ExpectOthers(content, what);
  }
  void ExpectOthers(const Content& content, const std::string& what) const {
    for (const RecordingEvent& event : content.events)
      EXPECT_TRUE(event.kind == "loss" || SameEvent(event, original_.events[0])) << what;
    ASSERT_LE(content.snapshots.size(), 1u) << what;
    if (content.snapshots.empty()) return;
    EXPECT_EQ(content.snapshots[0].tick, 7u) << what;
    EXPECT_EQ(content.snapshots[0].bytes, original_.snapshots[0].bytes) << what;
  }

  // The file recovered from `path_` must have the same ticks and header, and must still report the
  // lost data.
  void ExpectRecoveredAlike(const Content& content, const std::string& what) {
    const std::string out = folder_.File("out.mcap");
    std::filesystem::remove(out);
    const RecoverReport report = Recover(path_, out, &calls_);
    EXPECT_EQ(report.ticks, content.ticks.size()) << what;
    EXPECT_EQ(report.preamble, content.problem) << what;
    bool failed = false;
    const auto again = ReadAll(out, &failed);
    ASSERT_TRUE(again && !failed && again->complete) << what;
    EXPECT_NO_THROW(RecordingReader(out).Check()) << what;
    EXPECT_TRUE(SameHeader(again->header, content.header)) << what;
    EXPECT_EQ(again->header.lost, content.header.lost) << what;
    EXPECT_EQ(again->problem.empty(), content.header.lost.empty()) << what;
  }

  // Returns whether the byte at `at` belongs to a chunk's messages or their header.
  bool InChunk(std::size_t at) const {
    for (std::size_t k = bytes_.find("zstd"); k < index_; k = bytes_.find("zstd", k + 1)) {
      std::uint64_t size = 0;
      std::memcpy(&size, bytes_.data() + k + 4, 8);
      const std::size_t start = k - 4 - 28 - mcap::kHead;
      if (at >= start && at < k + 4 + 8 + size) return true;
    }
    return false;
  }

  // Recovers the content of `path_`. Returns the number of recovered ticks, or no value if no file
  // was written.
  std::optional<std::size_t> RecoverAndCheck(const std::string& what) {
    const std::string out = folder_.File("out.mcap");
    std::filesystem::remove(out);
    RecoverReport report;
    try {
      report = Recover(path_, out, &calls_);
    } catch (const InputError&) {
      EXPECT_FALSE(std::filesystem::exists(out)) << what;
      return {};
    }
    bool failed = false;
    const auto content = ReadAll(out, &failed);
    if (!content || failed || !content->complete) {
      ADD_FAILURE() << what << ": the recovered file cannot be read";
      return {};
    }
    RecordingReader(out).Check();
    ExpectPart(*content, what);
    EXPECT_EQ(content->ticks.size(), report.ticks) << what;
    EXPECT_EQ(content->snapshots.size(), report.snapshots) << what;
    return content->ticks.size();
  }

  // Does not synchronise to disk, because the tests write thousands of temporary files.
  class Fleeting : public FileCalls {
    int DataSync(int) override { return 0; }
    int SyncFolder(const std::string&) override { return 0; }
    int Reserve(int, std::uint64_t, std::uint64_t) override { return 0; }
  };

  Fleeting calls_;
  Folder folder_{true};
  const std::string path_;
  std::string bytes_;
  std::size_t preamble_ = 0, index_ = 0;  // length of the preamble; start of the index
  Content original_;
};

}  // namespace predictor::recording_test
