// Truncated, damaged or forged recordings. The reader reports an error or returns the original
// data, but never anything else. The reader never uses more memory than a recording needs.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "core/error.h"
#include "recording/encoder.h"
#include "recording/reader.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/writer.h"
#include "support/soak.h"

namespace predictor {
namespace {

using namespace recording_test;

// The complete content of a recording.
struct Content {
  std::vector<TickRecord> ticks;
  std::vector<RecordingEvent> events;
  std::vector<RecordedSnapshot> snapshots;
  RecordingHeader header;
  std::string problem;
  bool complete = false;
};

bool SameHeader(const RecordingHeader& a, const RecordingHeader& b) {
  const bool files =
      std::equal(a.attachments.begin(), a.attachments.end(), b.attachments.begin(),
                 b.attachments.end(), [](const auto& x, const auto& y) {
                   return x.name == y.name && x.media_type == y.media_type && x.bytes == y.bytes;
                 });
  return files && a.scenario_yaml == b.scenario_yaml && a.scenario_name == b.scenario_name &&
         a.machine_yaml == b.machine_yaml && a.program_version == b.program_version &&
         a.seed == b.seed && a.dt == b.dt && a.labels == b.labels &&
         a.model_hashes == b.model_hashes && a.start_unix_ns == b.start_unix_ns;
}
bool SameEvent(const RecordingEvent& a, const RecordingEvent& b) {
  return a.tick == b.tick && a.unix_ns == b.unix_ns && a.kind == b.kind && a.text == b.text &&
         a.lost == b.lost;
}

// Reads the ticks up to the first error, and everything else if there was no error. Returns nullopt
// if the file cannot be opened.
std::optional<Content> ReadAll(const std::string& path, bool* failed) {
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

// Enough ticks for three chunks, with a snapshot and an event in them.
constexpr std::uint64_t kDamagedTicks = 15;
TickRecord Tick(std::uint64_t tick) { return SampleTick(tick); }

void WriteSmall(const std::string& path) {
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

  // The ticks must be the first ticks of the original, and all other content must come from it too.
  void ExpectPrefix(const Content& content, const std::string& what) const {
    EXPECT_TRUE(SameHeader(content.header, original_.header)) << what;
    ASSERT_LE(content.ticks.size(), original_.ticks.size()) << what;
    for (std::size_t k = 0; k < content.ticks.size(); ++k)
      ASSERT_TRUE(Same(content.ticks[k], original_.ticks[k])) << what << ", tick " << k;
    ExpectOthers(content, what);
  }
  // The same, but ticks may be missing if events report them.
  void ExpectPart(const Content& content, const std::string& what) const {
    EXPECT_TRUE(SameHeader(content.header, original_.header)) << what;
    std::uint64_t last = 0, told = 0, missing = 0;
    for (const TickRecord& record : content.ticks) {
      ASSERT_GT(record.tick, last) << what;
      ASSERT_LE(record.tick, kDamagedTicks) << what;
      ASSERT_TRUE(Same(record, original_.ticks[record.tick - 1])) << what;
      if (last != 0) missing += record.tick - last - 1;
      last = record.tick;
    }
    for (const RecordingEvent& event : content.events) told += event.lost;
    EXPECT_EQ(told, missing) << what;
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

  // The file recovered from `path_` must have the same ticks and header, and still report the lost
  // data.
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

  // Returns true if the byte at `at` belongs to a chunk's messages or their header.
  bool InChunk(std::size_t at) const {
    for (std::size_t k = bytes_.find("zstd"); k < index_; k = bytes_.find("zstd", k + 1)) {
      std::uint64_t size = 0;
      std::memcpy(&size, bytes_.data() + k + 4, 8);
      const std::size_t start = k - 4 - 28 - mcap::kHead;
      if (at >= start && at < k + 4 + 8 + size) return true;
    }
    return false;
  }

  // Recovers the content of `path_`. Returns the number of recovered ticks, or nullopt if no file
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
      ADD_FAILURE() << what << ": what was recovered cannot be read";
      return {};
    }
    RecordingReader(out).Check();
    ExpectPart(*content, what);
    EXPECT_EQ(content->ticks.size(), report.ticks) << what;
    EXPECT_EQ(content->snapshots.size(), report.snapshots) << what;
    return content->ticks.size();
  }

  // Skips the synchronisation to disk, because the tests write thousands of temporary files.
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

TEST_F(Damage, OfNothingIsNothingToMend) {
  const RecoverReport report = Recover(path_, folder_.File("out.mcap"));
  EXPECT_TRUE(report.was_complete);
  EXPECT_EQ(report.ticks, kDamagedTicks);
  EXPECT_EQ(report.lost_ticks, 0u);
  EXPECT_EQ(report.snapshots, 1u);
  EXPECT_EQ(report.events, 1u);
  bool failed = false;
  const auto content = ReadAll(folder_.File("out.mcap"), &failed);
  ASSERT_TRUE(content && !failed);
  EXPECT_EQ(content->ticks.size(), kDamagedTicks);
  ExpectPrefix(*content, "recovered");
  EXPECT_THROW(Recover(path_, path_), InputError);
  EXPECT_EQ(ReadFile(path_), bytes_);
}

// A file that is cut anywhere is readable to its last complete chunk, and recovery yields at least
// these chunks.
TEST_F(Damage, CutAtEachByteSoak) {
  const auto step = static_cast<std::size_t>(Count(13, 1));
  std::size_t most = 0, opened = 0;
  std::filesystem::resize_file(path_, bytes_.size());
  for (std::size_t size = bytes_.size(); size > step;) {
    size -= step;
    std::filesystem::resize_file(path_, size);
    const std::string what = "cut at " + std::to_string(size);
    bool failed = false;
    const auto content = ReadAll(path_, &failed);
    const auto recovered = RecoverAndCheck(what);
    EXPECT_EQ(content.has_value(), recovered.has_value()) << what;
    if (!content) continue;
    ++opened;
    EXPECT_FALSE(failed) << what;
    EXPECT_FALSE(content->complete) << what;
    ExpectPrefix(*content, what);
    EXPECT_GE(recovered.value_or(0), content->ticks.size()) << what;
    most = std::max(most, content->ticks.size());
  }
  EXPECT_EQ(most, kDamagedTicks);
  EXPECT_GT(opened, bytes_.size() / step / 4);
}

TEST_F(Damage, EachByteFlippedSoak) {
  const auto step = static_cast<std::size_t>(Count(13, 1));
  std::size_t errors = 0, whole = 0;
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  for (std::size_t at = 0; at < bytes_.size(); at += step) {
    // Flips one bit at a time, each in turn; every ninth byte has all its bits flipped.
    const unsigned mask = at % 9 == 8 ? 0xFFU : 1U << (at % 9);
    const auto put = [&](char byte) {
      file.seekp(static_cast<std::streamoff>(at));
      file.put(byte).flush();
    };
    put(static_cast<char>(static_cast<unsigned char>(bytes_[at]) ^ mask));
    const std::string what = "byte " + std::to_string(at) + " flipped";
    bool failed = false;
    const auto content = ReadAll(path_, &failed);
    if (content) ExpectPrefix(*content, what);
    errors += failed;
    whole += content && !failed && content->complete && content->ticks.size() == kDamagedTicks;
    bool checked = true;
    try {
      RecordingReader(path_).Check();
    } catch (const InputError&) {
      checked = false;
    }
    EXPECT_FALSE(checked) << what << " is not noticed";
    const auto recovered = RecoverAndCheck(what);
    ASSERT_TRUE(content.has_value() && recovered.has_value()) << what;
    EXPECT_GE(*recovered, kDamagedTicks - 6) << what;  // only one of three chunks is damaged
    if (!InChunk(at)) {
      EXPECT_EQ(*recovered, kDamagedTicks) << what;
      EXPECT_EQ(content->ticks.size(), kDamagedTicks) << what;
    }
    EXPECT_EQ(content->problem.find("copy behind the first chunk") != std::string::npos,
              at < preamble_)
        << what;
    put(bytes_[at]);
  }
  EXPECT_GT(errors, 0u);
  EXPECT_GT(step * whole, preamble_);
}

// All content before the first tick is stored twice, piece by piece. A piece is lost only if both
// copies are damaged, and the reader reports this.
TEST_F(Damage, InBothPlaces) {
  const std::size_t copy = bytes_.find("predictor.copy") - 4;
  const std::size_t run = bytes_.find("predictor.run") - mcap::kHead - 4;
  const std::size_t run_again = bytes_.find("predictor.run", copy) - mcap::kHead - 4;
  const std::map<std::string, std::string> places = {
      // piece -> text in it
      {"predictor.labels", "P07"},    {"predictor.models", "abc123"},
      {"scenario.yaml", "name: Box"}, {"machine.yaml", "device: here"},
      {"robot.urdf", "<robot/>"},     {"topics", "predictor_msgs/msg/Qp"}};
  for (const auto& [hit, text] : places) {
    for (const auto& [hit_again, text_again] : places) {
      const std::string what = hit + " and in the copy " + hit_again;
      std::string damaged = bytes_;
      damaged[bytes_.find(text, run)] ^= 1;
      damaged[bytes_.find(text_again, run_again)] ^= 1;
      WriteFile(path_, damaged);
      bool failed = false;
      const auto content = ReadAll(path_, &failed);
      ASSERT_TRUE(content && !failed) << what;
      EXPECT_EQ(content->ticks.size(), kDamagedTicks) << what;
      const bool lost = hit == hit_again;
      EXPECT_EQ(content->header.lost, lost ? std::vector{hit} : std::vector<std::string>{}) << what;
      EXPECT_EQ(content->problem.find("`" + hit + "` is lost") != std::string::npos, lost) << what;
      EXPECT_EQ(SameHeader(content->header, original_.header), !lost || hit == "topics") << what;
      ExpectRecoveredAlike(*content, what);
    }
  }
  // If both copies of the run's description are damaged, the reader reports an error.
  for (const std::size_t at : {run, run_again}) bytes_[at + 40] ^= 1;
  WriteFile(path_, bytes_);
  EXPECT_THROW(RecordingReader{path_}, InputError);
}

// Zeros replace a growing region from the start, as a bad sector would leave them, up to the copy.
TEST_F(Damage, OfARegionAtTheStart) {
  const std::size_t copy = bytes_.find("predictor.copy") - 4 - 16 - mcap::kHead;
  for (std::size_t size = 1; size < copy; size += 1 + size / 8) {
    const std::string what = "the first " + std::to_string(size) + " bytes gone";
    WriteFile(path_, std::string(size, '\0') + bytes_.substr(size));
    bool failed = false;
    const auto content = ReadAll(path_, &failed);
    ASSERT_TRUE(content.has_value()) << what;
    EXPECT_TRUE(SameHeader(content->header, original_.header)) << what;
    const auto recovered = RecoverAndCheck(what);
    EXPECT_GE(recovered.value_or(0), size <= preamble_ ? kDamagedTicks : kDamagedTicks - 6) << what;
  }
}

// A piece that is too large to be stored twice exists once only. If it is damaged, the reader
// reports this.
TEST_F(Damage, OfALargeFile) {
  RecordingHeader header = SampleHeader();
  header.attachments.push_back({"big.stl", "model/stl", std::string(1U << 20U, 'm')});
  std::filesystem::remove(path_);
  {
    RecordingWriter writer(path_, header);
    for (std::uint64_t tick = 1; tick <= kDamagedTicks; ++tick) writer.Add(Tick(tick));
    writer.Close();
  }
  bytes_ = ReadFile(path_);
  EXPECT_LT(bytes_.size(), 3U << 19U);
  std::string damaged = bytes_;
  damaged[bytes_.find("mmmm") + 1000] ^= 1;
  WriteFile(path_, damaged);
  const RecordingReader reader(path_);
  EXPECT_EQ(reader.header().lost, std::vector<std::string>{"big.stl"});
  EXPECT_EQ(reader.header().attachments.size(), 1U);
  damaged[bytes_.find("P07")] ^= 1;  // the other pieces are still restored from their copies
  damaged[bytes_.find("mmmm") + 1000] ^= 1;
  WriteFile(path_, damaged);
  EXPECT_TRUE(SameHeader(RecordingReader(path_).header(), header));
}

TEST_F(Damage, InAChunkNamesTheChunk) {
  const std::size_t at = bytes_.find("zstd") + 100;
  std::string damaged = bytes_;
  damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
  WriteFile(path_, damaged);
  RecordingReader reader(path_);
  TickRecord record;
  try {
    while (reader.Next(&record)) {
    }
    FAIL();
  } catch (const InputError& error) {
    const std::string place = "byte " + std::to_string(bytes_.find("zstd") - 41);
    EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what();
  }
}

// ---- forged files -------------------------------------------------------------------------------

[[noreturn]] void ReadInLittleMemory(const std::string& path) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = pages * 4096 + (512U << 20U);
  setrlimit(RLIMIT_AS, &limit);
#endif
  try {
    RecordingReader reader(path);
    for (TickRecord record; reader.Next(&record);) {
    }
    reader.count();
    reader.events();
  } catch (const InputError&) {
  }
  _exit(0);
}
// Runs in a child process, so that only the child's memory is limited.
void ExpectBounded(const std::string& path) {
  EXPECT_EXIT(ReadInLittleMemory(path), ::testing::ExitedWithCode(0), "");
}

TEST_F(Damage, SizesThatCannotBe) {
  for (const std::uint64_t size :
       {~std::uint64_t{0}, std::uint64_t{1} << 63U, std::uint64_t{1} << 40U, bytes_.size() + 0UL}) {
    // Every position that may contain a length.
    for (std::size_t at = 8; at + 8 < bytes_.size(); at += 1 + at / 16) {
      std::string hostile = bytes_;
      std::memcpy(hostile.data() + at, &size, 8);
      WriteFile(path_, hostile);
      bool failed = false;
      const auto content = ReadAll(path_, &failed);
      if (content) ExpectPrefix(*content, "size at " + std::to_string(at));
    }
  }
}

// A CRC does not protect against forgery: an attacker computes the correct CRC.
TEST_F(Damage, SidesThatCannotBeAreRefused) {
  for (const int side : {-128, -2, 2, 127}) {
    for (const int field : {0, 1, 2, 3}) {
      std::filesystem::remove(path_);
      TickRecord record = Tick(1);
      (field == 0   ? record.cause_hand
       : field == 1 ? record.read.hand
       : field == 2 ? record.written.hand
                    : record.harder.hand) = static_cast<std::int8_t>(side);
      RecordingWriter writer(path_, SampleHeader());
      writer.Add(record);
      writer.Close();
      EXPECT_THROW(RecordingReader(path_).Next(&record), InputError) << side << ", " << field;
    }
  }
}

TEST_F(Damage, TicksOfNoLengthAreRefused) {
  for (const double dt : {0.0, -0.001, 1e-5, 1.5, 1e300, HUGE_VAL, std::nan("")}) {
    std::filesystem::remove(path_);
    RecordingHeader header = SampleHeader();
    header.dt = dt;
    RecordingWriter(path_, header).Close();
    try {
      RecordingReader reader(path_);
      FAIL() << dt;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("its ticks last "), std::string::npos)
          << error.what();
    }
  }
}

// Small items take many times more memory than space in the file, so their number is limited.
TEST_F(Damage, SmallThingsWithoutEndAreRefused) {
  RecordingHeader header = SampleHeader();
  for (int k = 0; k < 20'000; ++k) header.labels[std::to_string(k)] = "";
  std::filesystem::remove(path_);
  RecordingWriter(path_, header).Close();
  EXPECT_THROW(RecordingReader{path_}, InputError);

  header = SampleHeader();
  for (int k = 0; k < 20'000; ++k) header.attachments.push_back({"x", "", ""});
  std::filesystem::remove(path_);
  RecordingWriter(path_, header).Close();
  try {
    RecordingReader reader(path_);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("more data before the first tick"), std::string::npos)
        << error.what();
  }
}

// The number of bytes that this process has read so far.
std::uint64_t BytesRead() {
  std::ifstream io("/proc/self/io");
  std::string name;
  std::uint64_t bytes = 0;
  io >> name >> bytes;
  return bytes;
}

// Each header seems to contain all following data. The number of reads of each byte must
// nevertheless be bounded.
TEST_F(Damage, AFileFullOfHeadsIsNotReadAgainForEach) {
  const std::size_t first = bytes_.find("zstd") - 4 - mcap::kHead - 28;
  std::string hostile = bytes_.substr(0, first);
  constexpr std::size_t kHeads = 40'000;
  const std::size_t head = mcap::kHead + mcap::kChunkHead, end = first + kHeads * head;
  for (std::size_t k = 0; k < kHeads; ++k) {
    const std::uint64_t rest = end - first - (k + 1) * head;
    mcap::Bytes content;
    content.U64(1).U64(2).U64(100).U32(0).String("zstd").U64(rest);
    mcap::Bytes whole;
    whole.Number(mcap::Op::kChunk).U64(content.text.size() + rest);
    hostile += whole.text + content.text;
  }
  ASSERT_EQ(hostile.size(), end);
  WriteFile(path_, hostile);
  const std::uint64_t before = BytesRead();
  const RecoverReport report = Recover(path_, folder_.File("out.mcap"), &calls_);
  EXPECT_LT(BytesRead() - before, 40 * hostile.size() + (200U << 20U));
  EXPECT_GT(report.gave_up_at, first);
  EXPECT_NE(report.Text().find("only looks like chunks"), std::string::npos);

  // After fewer such headers, intact chunks are still found.
  WriteFile(path_,
            bytes_.substr(0, first) + hostile.substr(first, 20 * head) + bytes_.substr(first));
  const auto recovered = RecoverAndCheck("behind heads");
  EXPECT_EQ(recovered.value_or(0), kDamagedTicks);
}

// Chunks that expand a thousandfold, with an unlimited number of events or a size beyond any limit.
TEST_F(Damage, BombsDoNotFillTheMemory) {
  std::filesystem::remove(path_);
  {
    recording::ChunkBuilder builder;
    const std::string event = recording::EventText({1, 1, "event", "boom", 0});
    while (builder.size() < 60U << 20U) builder.Add(recording::kEventChannel, 0, 1, event);
    const recording::Chunk chunk = builder.Finish();
    EXPECT_LT(chunk.index.compressed, chunk.index.uncompressed / 100);
    FileCalls calls;
    recording::McapFile file(path_, recording::MakePreamble(SampleHeader(), {}), &calls);
    for (int k = 0; k < 30; ++k) ASSERT_TRUE(file.Put(chunk));
    ASSERT_TRUE(file.End());
  }
  ExpectBounded(path_);
  RecordingReader reader(path_);
  EXPECT_EQ(reader.events().size(), 200'000u);  // and no more
  EXPECT_GT(reader.more_events(), 1'000'000u);

  std::string huge = bytes_;  // the first chunk's size, uncompressed
  const std::uint64_t size = std::uint64_t{1} << 36U;
  std::memcpy(huge.data() + huge.find("zstd") - 4 - 4 - 8, &size, 8);
  WriteFile(path_, huge);
  ExpectBounded(path_);
}

// A fuzzing seed must be readable up to its ticks. A seed with an outdated tick layout is refused
// before any tick is decoded, so the decoder would not be tested.
TEST(FuzzSeeds, HaveTicks) {
  std::uint64_t read = 0, mended = 0;
  const Folder folder;
  const std::string out = folder.File("mended.mcap");
  for (const auto& seed : std::filesystem::directory_iterator(PREDICTOR_FUZZ_RECORDINGS)) {
    TickRecord record;
    try {
      RecordingReader reader(seed.path().string());
      while (reader.Next(&record)) ++read;
      (void)Recover(seed.path().string(), out).Text();
      RecordingReader whole(out);
      while (whole.Next(&record)) ++mended;
    } catch (const InputError&) {
    }
    std::filesystem::remove(out);
  }
  constexpr const char* kRemedy =
      "replace the seed `cut`: run recording_sample FOLDER 5; take the beginning of its "
      "sample.mcap (head -c 28000), which ends in the middle of predictor.copy, and pack it with "
      "tests/fuzz/pack.sh";
  EXPECT_GE(read, 5U) << kRemedy;
  EXPECT_EQ(mended, read) << kRemedy;
}

}  // namespace
}  // namespace predictor
