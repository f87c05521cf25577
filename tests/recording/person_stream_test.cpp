// Tests the person's states in a recording. The states have their own topic, and no tick depends on
// them.
#include <gtest/gtest.h>

#include <thread>

#include "core/person_json.h"
#include "recording/input.h"
#include "recording/opening.h"
#include "recording/preamble.h"
#include "recording/recorder.h"
#include "recording/recover.h"
#include "recording/samples.h"
#include "recording/share.h"

namespace predictor {
namespace {

using namespace recording_test;

struct Boards {
  RecordRing ticks;
  EvaluationBoard persons;
};

PersonState StateAt(std::uint64_t tick) {
  PersonState state;
  state.tick = tick;
  state.wall_ns = 1'000'000'000 + tick * 1'000'000;
  state.status = PersonStatus::kJudged;
  state.gauges[0].value = 1000 + static_cast<float>(tick);
  return state;
}

// Records the ticks 1 ... 1000, with a state at every tenth one.
void Record(const std::string& file, bool with_person) {
  const auto boards = std::make_unique<Boards>();
  RecorderOptions options;
  options.warn_below = options.end_below = 0;
  std::vector<JsonChannel> channels;
  if (with_person) {
    options.person = &boards->persons;
    channels.push_back(PersonChannel());
  }
  Recorder recorder(file, SampleHeader(), boards->ticks, options, channels);
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
    TickRecord record = SampleTick(tick);
    record.wall_ns = 1'000'000'000 + tick * 1'000'000;
    boards->ticks.Publish(record);
    if (tick % 10 == 0) boards->persons.states.Publish(StateAt(tick));
  }
  recorder.Close();
}

struct PersonMessage {
  std::uint32_t sequence;
  std::uint64_t time;
  std::string text;
};

std::vector<PersonMessage> PersonsOf(const std::string& path) {
  const recording::InputFile file(path);
  const recording::Opening opening = ReadOpening(file);
  std::vector<PersonMessage> messages;
  if (opening.scene.empty()) return messages;
  EXPECT_EQ(opening.scene.back().topic, "/person/state");
  EXPECT_EQ(opening.scene.back().schema, PersonSchema());
  const auto channel = recording::kFirstJsonChannel + opening.scene.size() - 1;
  for (std::uint64_t at = opening.end; at < file.size();) {
    const auto head = ReadHead(file, at);
    if (!head) break;
    if (const auto index = ChunkAt(file, at)) {
      const std::string bytes = ReadChunk(file, *index);
      std::string_view rest = bytes;
      for (recording::Message m; TakeMessage(&rest, &m);)
        if (m.channel == channel) messages.push_back({m.sequence, m.time, std::string(m.data)});
    }
    at += mcap::kHead + head->length;
  }
  return messages;
}

std::uint64_t TicksOf(const std::string& path) {
  RecordingReader reader(path);
  std::uint64_t ticks = 0;
  for (TickRecord record; reader.Next(&record);) ++ticks;
  return ticks;
}

TEST(PersonStream, IsRecordedNextToTheTicks) {
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  Record(file, true);
  RecordingReader(file).Check();
  EXPECT_EQ(TicksOf(file), 1000u);
  const auto messages = PersonsOf(file);
  ASSERT_EQ(messages.size(), 100u);
  const auto start = static_cast<std::uint64_t>(SampleHeader().start_unix_ns);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::uint64_t tick = 10 * (i + 1);
    EXPECT_EQ(messages[i].sequence, tick);
    EXPECT_EQ(messages[i].text, PersonJson(StateAt(tick)));
    EXPECT_EQ(messages[i].time, start + (tick - 1) * 1'000'000);  // the time of its tick
  }
}

TEST(PersonStream, IsKeptByRepair) {
  const Folder folder;
  const std::string file = folder.File("run.mcap"), cut = folder.File("cut.mcap"),
                    mended = folder.File("mended.mcap");
  Record(file, true);
  const std::string bytes = ReadFile(file);
  WriteFile(cut, bytes.substr(0, bytes.size() - 200));  // without the end of the file
  Recover(cut, mended);
  RecordingReader(mended).Check();
  EXPECT_EQ(TicksOf(mended), 1000u);
  const auto before = PersonsOf(file), after = PersonsOf(mended);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].text, before[i].text);
}

// The states follow from the person's body, so a shared copy must not contain them.
TEST(PersonStream, IsNotShared) {
  const Folder folder;
  const std::string file = folder.File("run.mcap"), shared = folder.File("shared.mcap");
  Record(file, true);
  const std::vector<std::string> removed = WriteShared(file, shared);
  EXPECT_EQ(removed.back(), "100 states of the person");
  RecordingReader(shared).Check();
  EXPECT_EQ(TicksOf(shared), 1000u);
  EXPECT_EQ(PersonsOf(shared).size(), 0u);
}

TEST(PersonStream, IsAbsentIfNoPersonIsJudged) {
  const Folder folder;
  const std::string file = folder.File("run.mcap");
  Record(file, false);
  EXPECT_EQ(PersonsOf(file).size(), 0u);
  EXPECT_EQ(TicksOf(file), 1000u);
}

}  // namespace
}  // namespace predictor
