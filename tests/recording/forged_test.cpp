// Tests forged recordings. For any file, the reader must not use more memory than a recording
// needs, and it must not read any byte too often.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "recording/damage_fixture.h"
#include "recording/encoder.h"

namespace predictor {
namespace {

using namespace recording_test;

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
    // The test goes through every position that may contain a length.
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

// A CRC does not protect against forgery, because an attacker can compute it.
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

// Small items take many times more memory than space in the file, so the reader limits their
// number.
TEST_F(Damage, TooManySmallItemsAreRefused) {
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

// Returns the number of bytes that this process has read so far.
std::uint64_t BytesRead() {
  std::ifstream io("/proc/self/io");
  std::string name;
  std::uint64_t bytes = 0;
  io >> name >> bytes;
  return bytes;
}

// Each header seems to contain all following data. Even with such headers, the reader must read
// each byte only a bounded number of times.
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
  EXPECT_NE(report.Text().find("only resembles chunks"), std::string::npos);

  // If a file contains fewer such headers, the reader must still find the intact chunks after them.
  WriteFile(path_,
            bytes_.substr(0, first) + hostile.substr(first, 20 * head) + bytes_.substr(first));
  const auto recovered = RecoverAndCheck("behind heads");
  EXPECT_EQ(recovered.value_or(0), kDamagedTicks);
}

// The chunks expand a thousandfold and contain a huge number of events or exceed every size limit.
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

  std::string huge = bytes_;  // changes the uncompressed size of the first chunk
  const std::uint64_t size = std::uint64_t{1} << 36U;
  std::memcpy(huge.data() + huge.find("zstd") - 4 - 4 - 8, &size, 8);
  WriteFile(path_, huge);
  ExpectBounded(path_);
}

// A fuzzing seed must be readable up to its ticks. If the seed's tick layout were outdated, the
// reader would refuse the seed before it decodes a tick, and the decoder would not be tested.
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
      "sample.mcap (head -c 32000), which ends in the middle of predictor.copy, and pack it with "
      "tests/fuzz/pack.sh";
  EXPECT_GE(read, 5U) << kRemedy;
  EXPECT_EQ(mended, read) << kRemedy;
}

}  // namespace
}  // namespace predictor
