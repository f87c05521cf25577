// Tests truncated or damaged recordings. The reader must either report an error or return the
// original data.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "recording/damage_fixture.h"
#include "support/soak.h"

namespace predictor {
namespace {

using namespace recording_test;

TEST_F(Damage, AnIntactFileNeedsNoRepair) {
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

// A truncated file must be readable to its last complete chunk, wherever the file was cut. Recovery
// must yield at least these chunks.
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
    // Damages one byte at a time. In eight of nine bytes, one bit is flipped, and the position of
    // this bit changes from byte to byte. In every ninth byte, all bits are flipped.
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
    EXPECT_FALSE(checked) << what << " is not detected";
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
// copies are damaged, and the reader must report the loss.
TEST_F(Damage, InBothPlaces) {
  const std::size_t copy = bytes_.find("predictor.copy") - 4;
  const std::size_t run = bytes_.find("predictor.run") - mcap::kHead - 4;
  const std::size_t run_again = bytes_.find("predictor.run", copy) - mcap::kHead - 4;
  const std::map<std::string, std::string> places = {
      // For each piece, the list contains a text that occurs in the piece.
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
  // If both copies of the run's description are damaged, the reader must report an error.
  for (const std::size_t at : {run, run_again}) bytes_[at + 40] ^= 1;
  WriteFile(path_, bytes_);
  EXPECT_THROW(RecordingReader{path_}, InputError);
}

// Zeros replace a growing region from the start up to the copy, as after a bad sector.
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

// A piece that is too large to be stored twice exists only once. If such a piece is damaged, the
// reader must report the damage.
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
  damaged[bytes_.find("P07")] ^= 1;  // the reader restores the other pieces from their copies
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

}  // namespace
}  // namespace predictor
