// Tests the streams of other systems in a recording. They have their own topics, and no tick
// depends on them.
#include "recording/sample_stream.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

#include "recording/reader.h"
#include "recording/recorder.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/share.h"
#include "recording/writer.h"

namespace predictor {
namespace {

using namespace recording_test;

constexpr std::uint64_t kFirst = 1'001'000'000;  // clock of the first tick [ns]
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

StreamSample SampleAt(std::uint32_t stream, std::uint64_t ms,
                      std::initializer_list<double> values) {
  StreamSample sample{.wall_ns = kFirst + ms * 1'000'000,
                      .stream = stream,
                      .count = static_cast<std::uint32_t>(values.size()),
                      .clock_offset = 0.125};
  std::ranges::copy(values, sample.values.begin());
  return sample;
}

// The samples of two streams, one of them at 500 Hz.
std::vector<StreamSample> TwoStreams() {
  std::vector<StreamSample> samples;
  for (std::uint64_t ms = 0; ms < 1000; ms += 2) {
    const double x = 1e-3 * static_cast<double>(ms);
    samples.push_back(SampleAt(0, ms, {x, ms == 500 ? kNone : -x}));
    if (ms % 250 == 0) samples.push_back(SampleAt(1, ms, {70 + x}));
  }
  return samples;
}

struct StreamBoards {
  RecordRing ticks;
  StreamRing samples;
};

// Records the ticks 1 ... 1000. Each sample is published when its time has come.
void RecordStreams(const std::string& file, const std::vector<StreamSample>& samples) {
  const auto boards = std::make_unique<StreamBoards>();
  RecorderOptions options;
  options.warn_below = options.end_below = 0;
  options.samples = &boards->samples;
  options.streams = {R"({"name":"a"})", R"({"name":"b"})"};
  Recorder recorder(file, SampleHeader(), boards->ticks, options,
                    {StreamsChannel(), SamplesChannel()});
  auto next = samples.begin();
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
    TickRecord record = SampleTick(tick);
    record.wall_ns = kFirst + (tick - 1) * 1'000'000;
    for (; next != samples.end() && next->wall_ns <= record.wall_ns; ++next)
      boards->samples.Publish(*next);
    boards->ticks.Publish(record);
  }
  for (; next != samples.end(); ++next) boards->samples.Publish(*next);
  recorder.Close();
}

TEST(SampleStream, IsReadBackWithTimesAndDescription) {
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  RecordStreams(file, TwoStreams());
  RecordingReader reader(file);
  reader.Check();
  EXPECT_EQ(reader.count(), 1000u);
  const auto streams = reader.ReadStreams();
  ASSERT_EQ(streams.size(), 2u);
  EXPECT_EQ(streams[0].description, R"({"name":"a"})");
  EXPECT_EQ(streams[1].description, R"({"name":"b"})");
  ASSERT_EQ(streams[0].times.size(), 500u);
  ASSERT_EQ(streams[0].values.size(), 1000u);
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_NEAR(streams[0].times[i], 0.002 * static_cast<double>(i), 2e-9);
    EXPECT_NEAR(streams[0].values[2 * i], 0.002 * static_cast<double>(i), 1e-12);
    EXPECT_EQ(std::isnan(streams[0].values[2 * i + 1]), i == 250);
  }
  EXPECT_EQ(streams[1].values, (std::vector<double>{70, 70.25, 70.5, 70.75}));
}

// Another process sends the samples.
TEST(SampleStream, LeavesOutWhatIsNotPlausible) {
  std::vector<StreamSample> bad(6, SampleAt(1, 100, {70}));
  bad[0].values[0] = std::numeric_limits<double>::infinity();
  bad[1].stream = 2;  // not described
  bad[2].count = kMaxStreamChannels + 1;
  bad[3].count = 0;
  bad[4].clock_offset = kNone;
  bad[5].wall_ns = kFirst - 1;               // before the run
  bad.push_back(SampleAt(1, 60'000, {70}));  // from the future
  bad.push_back(SampleAt(1, 500, {71}));
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  RecordStreams(file, bad);
  RecordingReader reader(file);
  reader.Check();
  EXPECT_EQ(reader.ReadStreams().at(1).values, (std::vector<double>{71}));
}

// The sender may change while the receiver is restarted.
TEST(SampleStream, LeavesOutAnotherNumberOfChannels) {
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  RecordStreams(file, {SampleAt(0, 100, {1, 2}), SampleAt(0, 102, {3}), SampleAt(1, 104, {70}),
                       SampleAt(0, 106, {4, 5, 6}), SampleAt(0, 108, {7, 8})});
  RecordingReader reader(file);
  reader.Check();
  const auto streams = reader.ReadStreams();
  ASSERT_EQ(streams.size(), 2u);
  EXPECT_EQ(streams[0].values, (std::vector<double>{1, 2, 7, 8}));
  EXPECT_EQ(streams[1].values, (std::vector<double>{70}));
  EXPECT_TRUE(streams[0].complete);
}

// The chunk with the descriptions may be lost.
TEST(SampleStream, IsReadWithoutItsDescription) {
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  const StreamSample sample = SampleAt(1, 0, {70});
  JsonChannel samples = SamplesChannel();
  samples.message = [&sample](const TickRecord&, std::uint64_t) {
    return recording::SamplesJson(std::span(&sample, 1));
  };
  RecordingWriter writer(file, SampleHeader(), {StreamsChannel(), samples});
  for (std::uint64_t tick = 1; tick <= 100; ++tick) writer.Add(SampleTick(tick));
  writer.Close();
  const auto streams = RecordingReader(file).ReadStreams();
  ASSERT_EQ(streams.size(), 2u);
  EXPECT_EQ(streams[1].description, "");
  ASSERT_FALSE(streams[1].values.empty());
  EXPECT_EQ(streams[1].values.front(), 70);
}

TEST(SampleStream, IsKeptByRepairAndNotShared) {
  const Folder folder;
  const std::string file = folder.File("run.mcap"), cut = folder.File("cut.mcap"),
                    mended = folder.File("mended.mcap"), shared = folder.File("shared.mcap");
  RecordStreams(file, TwoStreams());
  const std::string bytes = ReadFile(file);
  WriteFile(cut, bytes.substr(0, bytes.size() - 200));  // without the end of the file
  Recover(cut, mended);
  EXPECT_EQ(RecordingReader(mended).ReadStreams().at(0).times.size(), 500u);
  const std::vector<std::string> removed = WriteShared(file, shared);
  EXPECT_NE(removed.back().find("messages of other systems' measurements"), std::string::npos);
  EXPECT_TRUE(RecordingReader(shared).ReadStreams().empty());
}

TEST(SampleStream, RefusesOtherText) {
  const std::vector<StreamSample> samples = {SampleAt(1, 0, {1, 2}), SampleAt(1, 2, {3, kNone})};
  const std::string good = recording::SamplesJson(samples);
  const auto reads = [](const std::string& text, std::size_t channels = 0) {
    RecordedStream stream{.channels = channels};
    return recording::ParseSamples(text, 1, 0, &stream);
  };
  EXPECT_TRUE(reads(good)) << good;
  EXPECT_FALSE(reads(good, 3));  // another number of channels than before
  const auto changed = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_FALSE(reads(""));
  EXPECT_FALSE(reads("[]"));
  EXPECT_FALSE(reads(good.substr(0, good.size() - 1)));
  EXPECT_FALSE(reads(changed(R"("stream":1)", R"("stream":0)")));
  EXPECT_FALSE(reads(changed(R"("stream":1)", R"("stream":-1)")));
  EXPECT_FALSE(reads(changed("[1.0,2.0]", "[1.0]")));
  EXPECT_FALSE(reads(changed("[1.0,2.0]", "[1e13,2.0]")));
  EXPECT_FALSE(reads(changed("[1.0,2.0]", R"(["1",2.0])")));
  EXPECT_FALSE(reads(changed(R"("times":[0.0,)", R"("times":[-1.0,)")));
  EXPECT_FALSE(reads(changed(R"("times":[0.0,)", R"("times":[)")));
}

}  // namespace
}  // namespace predictor
