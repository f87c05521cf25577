// Data that was written must be read back bit for bit.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "core/error.h"
#include "core/tick_fields.h"
#include "recording/encoder.h"
#include "recording/reader.h"
#include "recording/samples.h"
#include "recording/schema.h"
#include "recording/writer.h"

namespace predictor {
namespace {

using namespace recording_test;

// Makes every byte random, except in fields that have few valid values or must be zero.
TickRecord Random(std::mt19937_64* random, std::uint64_t tick) {
  TickRecord noise;
  auto* bytes = reinterpret_cast<unsigned char*>(&noise);
  for (std::size_t k = 0; k < sizeof noise; ++k) bytes[k] = static_cast<unsigned char>((*random)());
  // The function sets the bytes field by field, so that padding stays zero.
  noise.tick = tick;
  noise.state = static_cast<RunState>((*random)() % kRunStates);
  noise.cause = static_cast<StopCause>((*random)() % kStopCauses);
  noise.cause_quantity = static_cast<Quantity>((*random)() % 9);
  const auto side = [random] { return static_cast<std::int8_t>((*random)() % 3 - 1); };
  noise.cause_hand = side();
  for (StatusRecord* status : {&noise.read, &noise.written, &noise.harder}) {
    status->cause = static_cast<StopCause>((*random)() % kStopCauses);
    status->quantity = static_cast<Quantity>((*random)() % 9);
    status->hand = side();
    status->reserved = {};
  }
  noise.input_count = static_cast<std::uint8_t>((*random)() % (kInputsPerTick + 1));
  noise.cobot_dof = static_cast<std::uint8_t>((*random)() % (kMaxCobotJoints + 1));
  noise.movable_count = static_cast<std::uint8_t>((*random)() % (kMaxMovables + 1));
  for (HandRecord& hand : noise.hands) {
    hand.arm_dof = static_cast<std::uint8_t>((*random)() % (kMaxArmJoints + 1));
    hand.more_reserved = {};
  }
  noise.reserved = {};
  return noise;
}

// Marks the bytes of each visited field.
struct MarkVisitor {
  const unsigned char* start;
  std::vector<int> marks = std::vector<int>(sizeof(TickRecord));
  std::set<std::string>* names = nullptr;

  void Mark(const auto& x) {
    const auto at = static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&x) - start);
    for (std::size_t k = 0; k < sizeof x; ++k) ++marks[at + k];
  }
  void Value(const TickField&, const auto& x) { Mark(x); }
  void Flag(const TickField&, const auto& x) { Mark(x); }
  void Presence(const TickField&, const auto& x) { Mark(x); }
  void Unchecked(const TickField&, const auto& x) { Mark(x); }
  void Values(const TickField&, const auto& x) { Mark(x); }
  void Named(const TickField&, const auto&, const auto& x) { Mark(x); }
  void Joints(const TickField&, const auto& x, std::size_t) { Mark(x); }
  void Pose(const TickField&, const auto& x) { Mark(x); }
  void Poses(const TickField&, const auto& x, std::size_t) { Mark(x); }
  void Twist(const TickField&, const auto& x) { Mark(x); }
  void Wrench(const TickField&, const auto& x) { Mark(x); }
  void Reserved(const auto& x) { Mark(x); }
  void Message(const TickField&, const char*, auto&& visit) { visit(*this); }
  void Inputs(const TickField&, const char*, const auto& list, std::size_t, auto&& visit) {
    for (const auto& item : list) visit(*this, item);
  }
};

std::vector<int> Marks(const TickRecord& record) {
  MarkVisitor visitor{reinterpret_cast<const unsigned char*>(&record)};
  for (int g = 0; g < kTickGroupCount; ++g) VisitGroup(static_cast<TickGroup>(g), visitor, record);
  return visitor.marks;
}

TEST(Fields, AreEachInOneMessage) {
  const std::vector<int> marks = Marks(Nothing());
  std::size_t once = 0;
  for (std::size_t k = 0; k < marks.size(); ++k) {
    EXPECT_LE(marks[k], 1) << "byte " << k << " of TickRecord is in two messages";
    once += marks[k] == 1;
  }
  EXPECT_EQ(once, VisitedBytes());
}

TEST(Recording, KeepsEveryBit) {
  Folder folder;
  std::mt19937_64 random(1);
  std::vector<TickRecord> ticks;
  const std::vector<int> marks = Marks(Nothing());
  for (std::uint64_t tick = 1; tick <= 600; ++tick) {
    TickRecord record = Random(&random, tick);
    auto* bytes = reinterpret_cast<unsigned char*>(&record);
    for (std::size_t k = 0; k < sizeof record; ++k)
      if (marks[k] == 0) bytes[k] = 0;  // padding
    record.wall_ns = 1'000'000 * tick;
    ticks.push_back(record);
  }
  {
    RecordingWriter writer(folder.File("a.mcap"), SampleHeader());
    for (const TickRecord& record : ticks) writer.Add(record);
    writer.Close();
  }
  RecordingReader reader(folder.File("a.mcap"));
  EXPECT_TRUE(reader.complete()) << reader.problem();
  EXPECT_EQ(reader.count(), ticks.size());
  TickRecord record;
  for (const TickRecord& expected : ticks) {
    ASSERT_TRUE(reader.Next(&record));
    ASSERT_TRUE(Same(record, expected)) << "tick " << expected.tick;
  }
  EXPECT_FALSE(reader.Next(&record));
  reader.Check();
}

TEST(Recording, KeepsNanAndTheFieldsAfterTheJoints) {
  Folder folder;
  std::vector<TickRecord> ticks(4, Nothing());
  for (std::size_t k = 0; k < ticks.size(); ++k) ticks[k].tick = k + 1;
  ticks[0].energy = std::numeric_limits<double>::quiet_NaN();
  ticks[0].link_distance = std::numeric_limits<double>::infinity();
  ticks[0].kkt_residual = -std::numeric_limits<double>::infinity();
  ticks[1].cobot_dof = 2;
  ticks[1].cobot_q[15] = -0.0;   // its bits are not all zero
  ticks[2].inputs[3].value = 5;  // an input beyond the count
  ticks[3].hands[1].q[9] = 1;    // a joint of an absent arm
  {
    RecordingWriter writer(folder.File("a.mcap"), SampleHeader());
    for (const TickRecord& record : ticks) writer.Add(record);
  }
  RecordingReader reader(folder.File("a.mcap"));
  TickRecord record;
  for (const TickRecord& expected : ticks) {
    ASSERT_TRUE(reader.Next(&record));
    EXPECT_TRUE(Same(record, expected)) << "tick " << expected.tick;
  }
}

TEST(Recording, KeepsItsHeader) {
  Folder folder;
  const RecordingHeader expected = SampleHeader();
  RecordingWriter(folder.File("a.mcap"), expected).Close();
  RecordingReader reader(folder.File("a.mcap"));
  const RecordingHeader& header = reader.header();
  EXPECT_EQ(header.scenario_yaml, expected.scenario_yaml);
  EXPECT_EQ(header.scenario_name, expected.scenario_name);
  EXPECT_EQ(header.machine_yaml, expected.machine_yaml);
  EXPECT_EQ(header.program_version, expected.program_version);
  EXPECT_EQ(header.engine, expected.engine);
  EXPECT_EQ(header.seed, expected.seed);
  EXPECT_EQ(header.dt, expected.dt);
  ASSERT_TRUE(header.loop);
  EXPECT_EQ(header.loop->lead, expected.loop->lead);
  EXPECT_EQ(header.loop->margin, expected.loop->margin);
  EXPECT_EQ(header.labels, expected.labels);
  EXPECT_EQ(header.model_hashes, expected.model_hashes);
  EXPECT_EQ(header.start_unix_ns, expected.start_unix_ns);
  ASSERT_EQ(header.attachments.size(), 1u);
  EXPECT_EQ(header.attachments[0].name, "robot.urdf");
  EXPECT_EQ(header.attachments[0].bytes, expected.attachments[0].bytes);
  EXPECT_EQ(reader.count(), 0u);
  EXPECT_TRUE(reader.complete());
  TickRecord record;
  EXPECT_FALSE(reader.Next(&record));
  reader.Seek(5);
  EXPECT_FALSE(reader.Next(&record));
  reader.Check();
}

// The recording has `mode: direct` or comes from an older program.
TEST(Recording, WithoutAPredictedLoopContainsNoPrediction) {
  Folder folder;
  RecordingHeader header = SampleHeader();
  header.loop.reset();
  RecordingWriter(folder.File("a.mcap"), header).Close();
  EXPECT_FALSE(RecordingReader(folder.File("a.mcap")).header().loop);
}

TEST(Recording, SeeksToAnyTick) {
  Folder folder;
  constexpr std::uint64_t kTicks = 3000;
  {
    RecordingWriter writer(folder.File("a.mcap"), SampleHeader());
    for (std::uint64_t tick = 10; tick <= kTicks; tick += tick == 1000 ? 500 : 1)
      writer.Add(SampleTick(tick));
  }
  RecordingReader reader(folder.File("a.mcap"));
  TickRecord record;
  const auto after = [&](std::uint64_t tick) {
    reader.Seek(tick);
    return reader.Next(&record) ? record.tick : 0;
  };
  EXPECT_EQ(after(0), 10u);
  EXPECT_EQ(after(2999), 2999u);
  EXPECT_EQ(after(1001), 1500u);  // there is a gap
  EXPECT_EQ(after(kTicks + 1), 0u);
  std::mt19937_64 random(2);
  for (int k = 0; k < 60; ++k) {
    const std::uint64_t tick = 1500 + random() % 1500;
    EXPECT_EQ(after(tick), tick);
    EXPECT_TRUE(Same(record, SampleTick(tick)));
    ASSERT_TRUE(tick == kTicks || reader.Next(&record));
    EXPECT_EQ(record.tick, std::min(tick + 1, kTicks));
  }
}

TEST(Recording, KeepsSnapshotsAndEvents) {
  Folder folder;
  const std::vector<std::byte> state(100'000, std::byte{42});
  {
    RecordingWriter writer(folder.File("a.mcap"), SampleHeader());
    for (std::uint64_t tick = 1; tick <= 2500; ++tick) {
      writer.Add(SampleTick(tick));
      if (tick % 1000 == 0) writer.AddSnapshot(tick, std::span(state).first(tick));
      if (tick == 700) writer.AddEvent("Marker \"A\" äöü \xff", tick);
      if (tick == 1700) writer.NoteLoss(12, tick);
    }
  }
  RecordingReader reader(folder.File("a.mcap"));
  EXPECT_EQ(reader.snapshots(), (std::vector<std::uint64_t>{1000, 2000}));
  RecordedSnapshot snapshot;
  EXPECT_FALSE(reader.SnapshotAt(999, &snapshot));
  ASSERT_TRUE(reader.SnapshotAt(1000, &snapshot));
  EXPECT_EQ(snapshot.tick, 1000u);
  EXPECT_EQ(snapshot.bytes, std::vector<std::byte>(state.begin(), state.begin() + 1000));
  ASSERT_TRUE(reader.SnapshotAt(99999, &snapshot));
  EXPECT_EQ(snapshot.tick, 2000u);
  ASSERT_EQ(reader.events().size(), 2u);
  EXPECT_EQ(reader.events()[0].tick, 700u);
  EXPECT_EQ(reader.events()[0].text, "Marker \"A\" äöü \xEF\xBF\xBD");
  EXPECT_EQ(reader.events()[0].unix_ns, 1'700'000'000'700'000'000u);
  ASSERT_EQ(reader.gaps().size(), 1u);
  EXPECT_EQ(reader.gaps()[0].lost, 12u);
  EXPECT_EQ(reader.gaps()[0].tick, 1700u);
  reader.Check();
}

TEST(Recording, OverwritesNothingAndReportsTheError) {
  Folder folder;
  const auto message = [](auto&& act) -> std::string {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  WriteFile(folder.File("a.mcap"), "mine");
  EXPECT_NE(message([&] {
              RecordingWriter w(folder.File("a.mcap"), SampleHeader());
            }).find("never overwrites a file"),
            std::string::npos);
  EXPECT_EQ(ReadFile(folder.File("a.mcap")), "mine");
  EXPECT_NE(message([&] {
              RecordingWriter w(folder.File("no/a.mcap"), SampleHeader());
            }).find("No such file"),
            std::string::npos);
  EXPECT_NE(message([&] { RecordingReader r(folder.File("none.mcap")); }).find("No such file"),
            std::string::npos);
  EXPECT_NE(message([&] { RecordingReader r(folder.File("a.mcap")); }).find("not a recording"),
            std::string::npos);
  EXPECT_NE(message([&] { RecordingReader r(folder.path()); }).find("not a file"),
            std::string::npos);
}

// Changed constants or comments must not make old recordings unreadable. Changed fields must make
// them unreadable.
TEST(Schema, LayoutIsWhatTheBytesAreMadeOf) {
  using recording::Layout;
  EXPECT_EQ(Layout("# all\nuint8 A=1\nuint8 a  # [s]\n\nfloat64 b\n"), "uint8 a\nfloat64 b\n");
  EXPECT_NE(Layout("uint8 a\n"), Layout("uint16 a\n"));
  EXPECT_NE(Layout("uint8 a\n===\nMSG: x/Y\nuint8 b\n"), Layout("uint8 a\nuint8 b\n"));
}

TEST(Schema, ContainsTheNamesOfStates) {
  const std::string run = recording::Definition(TickGroup::kRun);
  EXPECT_NE(run.find("uint8 STATE_RUN=5\n"), std::string::npos);
  EXPECT_NE(run.find("uint8 CAUSE_FORCE=1\n"), std::string::npos);
  EXPECT_NE(run.find("\nMSG: predictor_msgs/Status\n"), std::string::npos);
}

}  // namespace
}  // namespace predictor
