// Tests the measured heads in a recording. They have their own topic, and no tick depends on them.
#include "recording/head_stream.h"

#include <gtest/gtest.h>

#include <limits>

#include "recording/recorder.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/share.h"

namespace predictor {
namespace {

using namespace recording_test;

constexpr std::uint64_t kFirst = 1'001'000'000;  // clock of the first tick [ns]

HeadRecord HeadAt(std::uint64_t wall_ns) {
  HeadRecord head{.wall_ns = wall_ns, .delay = 0.0125, .client = 3};
  head.p = {0.75, -0.125, 0.5 + 1e-9 * static_cast<double>(wall_ns)};
  head.q = {0.6, 0, 0.8, 0};
  head.registration = {.yaw = 0.3, .t = {1, 2, -0.9}, .residual = 0.004};
  return head;
}

struct Boards {
  RecordRing ticks;
  HeadRing heads;
};

// Records the ticks 1 ... 1000. `heads` are published before tick 500.
void Record(const std::string& file, const std::vector<HeadRecord>& heads, bool topic = true) {
  const auto boards = std::make_unique<Boards>();
  RecorderOptions options;
  options.warn_below = options.end_below = 0;
  options.heads = &boards->heads;
  std::vector<JsonChannel> channels;
  if (topic) channels.push_back(HeadChannel());
  Recorder recorder(file, SampleHeader(), boards->ticks, options, channels);
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
    TickRecord record = SampleTick(tick);
    record.wall_ns = kFirst + (tick - 1) * 1'000'000;
    if (tick == 500)
      for (const HeadRecord& head : heads) boards->heads.Publish(head);
    boards->ticks.Publish(record);
  }
  recorder.Close();
}

std::vector<HeadRecord> EveryTwentyFiveMs() {
  std::vector<HeadRecord> heads;
  for (std::uint64_t k = 0; k < 40; ++k) heads.push_back(HeadAt(kFirst + k * 25'000'000));
  return heads;
}

TEST(HeadStream, IsReadBackWithTimeAndRegistration) {
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  const auto written = EveryTwentyFiveMs();
  Record(file, written);
  RecordingReader reader(file);
  reader.Check();
  EXPECT_EQ(reader.count(), 1000u);
  const auto heads = reader.ReadHeads();
  ASSERT_EQ(heads.size(), written.size());
  for (std::size_t k = 0; k < heads.size(); ++k) {
    EXPECT_NEAR(heads[k].time, 0.025 * static_cast<double>(k), 1e-9);
    EXPECT_EQ(heads[k].head.p, written[k].p);
    EXPECT_EQ(heads[k].head.q, written[k].q);
    EXPECT_EQ(heads[k].head.delay, 0.0125);
    EXPECT_EQ(heads[k].head.registration.yaw, 0.3);
    EXPECT_EQ(heads[k].head.registration.t, written[k].registration.t);
    EXPECT_EQ(heads[k].head.registration.residual, 0.004);
  }
}

// The viewer's process is not trusted.
TEST(HeadStream, LeavesOutWhatIsNotPlausible) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t now = kFirst + 100'000'000;
  std::vector<HeadRecord> bad(9, HeadAt(now));
  bad[0].p[1] = nan;
  bad[1].p[2] = 101;
  bad[2].q = {1, 1, 0, 0};
  bad[3].q[0] = nan;
  bad[4].registration.t[0] = nan;
  bad[5].registration.residual = 2;
  bad[6].delay = 1;
  bad[7].wall_ns = kFirst - 1;               // before the run
  bad[8].wall_ns = kFirst + 60'000'000'000;  // from the future
  bad.push_back(HeadAt(now));
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  Record(file, bad);
  RecordingReader(file).Check();
  EXPECT_EQ(RecordingReader(file).ReadHeads().size(), 1u);
}

TEST(HeadStream, IsEmptyIfNothingWasMeasured) {
  const Folder folder;
  const std::string without = folder.File("without.mcap"), old = folder.File("old.mcap");
  Record(without, {});
  EXPECT_TRUE(RecordingReader(without).ReadHeads().empty());
  Record(old, EveryTwentyFiveMs(), false);
  EXPECT_TRUE(RecordingReader(old).ReadHeads().empty());
}

TEST(HeadStream, IsKeptByRepair) {
  const Folder folder;
  const std::string file = folder.File("run.mcap"), cut = folder.File("cut.mcap"),
                    mended = folder.File("mended.mcap");
  Record(file, EveryTwentyFiveMs());
  const std::string bytes = ReadFile(file);
  WriteFile(cut, bytes.substr(0, bytes.size() - 200));  // without the end of the file
  EXPECT_EQ(RecordingReader(cut).ReadHeads().size(), 40u);
  Recover(cut, mended);
  RecordingReader(mended).Check();
  EXPECT_EQ(RecordingReader(mended).ReadHeads().size(), 40u);
}

// The motion of the head describes the person, so a shared copy must not contain it.
TEST(HeadStream, IsNotShared) {
  const Folder folder;
  const std::string file = folder.File("run.mcap"), shared = folder.File("shared.mcap");
  Record(file, EveryTwentyFiveMs());
  const std::vector<std::string> removed = WriteShared(file, shared);
  EXPECT_EQ(removed.back(), "40 measured poses of the head");
  RecordingReader reader(shared);
  reader.Check();
  EXPECT_EQ(reader.count(), 1000u);
  EXPECT_TRUE(reader.ReadHeads().empty());
}

TEST(HeadStream, RefusesOtherText) {
  const std::string good = recording::HeadJson(HeadAt(kFirst));
  HeadRecord head;
  EXPECT_TRUE(recording::ParseHead(good, &head));
  const auto changed = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  for (const std::string& text :
       {std::string(), std::string("[]"), good.substr(1), changed("\"p\"", "\"P\""),
        changed("[0.75,", "[\"0.75\","), changed("[0.75,", "[0.75,0,"), changed("[0.75,", "[750,"),
        changed("\"delay\":0.0125", "\"delay\":null"), changed("[0.6,", "[0.7,"),
        changed("\"registration\":{", "\"registration\":[], \"r\":{"),
        changed("\"yaw\":0.3", "\"yaw\":1e300")})
    EXPECT_FALSE(recording::ParseHead(text, &head)) << text;
}

}  // namespace
}  // namespace predictor
