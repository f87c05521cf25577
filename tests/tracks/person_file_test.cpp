// Tests imports from other systems.
#include "tracks/person_file.h"

#include <sqlite3.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/format.h"
#include "recording/mcap.h"
#include "tracks/files.h"
#include "tracks/ros_messages.h"

namespace predictor::tracks {
namespace {

class Import : public Files {
 protected:
  PersonFile Run(const std::string& yaml, const std::string& file) const {
    const ImportMap map = ParseImportMap(yaml, "map.yaml");
    return ReadPersonFile(
        Write("out.person.csv", ImportPerson(map, ReadSeries(file, map.channels.TimeOf()))));
  }
};

const char* const kMap =
    "time: t\n"
    "time_unit: ms\n"
    "unit: mm\n"
    "force_unit: N\n"
    "object_mass: 9\n"
    "operator: {body: {height: 1.7, mass: 70, sex: female}, stance: {ground: [1, 0, -0.8], facing: "
    "180 deg}}\n"
    "right_hand: {position: [px, py, pz], rotation: [qw, qx, qy, qz], force: [fx, fy, fz], "
    "on: hand}\n";

// Returns a robot's log at 500 Hz. The sensor measures the force on the hand.
std::string Log(const std::function<std::string(int)>& force) {
  std::string text = "t,px,py,pz,qw,qx,qy,qz,fx,fy,fz,note\n";
  for (int i = 0; i <= 500; ++i)
    text += Formatted("%d,%d,-20,1000,1,0,0,0,", 1000 + 2 * i, i) + force(i) + ",0,0,moves\n";
  return text;
}

TEST_F(Import, MakesRowsAt100HzInSiUnits) {
  const PersonFile person =
      Run(kMap, Write("log.csv", Log([](int i) { return Formatted("%d", i); })));
  EXPECT_EQ(person.header.name, "log");
  EXPECT_EQ(person.header.source, "log.csv");
  EXPECT_EQ(person.header.object_mass, 9);
  EXPECT_EQ(person.header.body->sex, Sex::kFemale);
  EXPECT_EQ(person.header.stance->ground.z(), -0.8);
  ASSERT_FALSE(person.track.hands[0]);
  const HandTrack& hand = *person.track.hands[1];
  ASSERT_EQ(hand.pose.times.size(), 101u);
  EXPECT_TRUE(hand.pose.p[50].isApprox(Vector3(0.25, -0.02, 1), 1e-9)) << hand.pose.p[50];
  // The mean of five readings around i = 250 has the opposite sign, because it is the force of the
  // hand on the handle.
  EXPECT_NEAR(hand.F[50][0], -250, 1);
  EXPECT_TRUE(hand.HoldsAt(0.5));
  ASSERT_EQ(person.header.notes.size(), 1u);
  ExpectWords(person.header.notes[0], {"right hand", "torque was not measured"});
}

TEST_F(Import, CountsWhatIsMissingAsNotHolding) {
  const PersonFile person =
      Run(kMap, Write("log.csv", Log([](int i) { return i >= 250 ? std::string("nan") : "5"; })));
  EXPECT_TRUE(person.track.hands[1]->HoldsAt(0.2));
  EXPECT_FALSE(person.track.hands[1]->HoldsAt(0.8));
  ASSERT_EQ(person.header.notes.size(), 2u);
  ExpectWords(person.header.notes[1], {"missing for 50", "not holding"});
}

TEST_F(Import, NamesWhatIsMissing) {
  const auto error = [&](const std::string& yaml) {
    return ErrorOf([&] { ParseImportMap(yaml, "map.yaml"); });
  };
  ExpectWords(error("unit: mm\n"), {"map.yaml", "left_hand or right_hand is missing"});
  ExpectWords(error("left_hand: {position: [p]}\n"),
              {"left_hand.rotation is missing", "left_hand.force is missing"});
  ExpectWords(error("left_hand: {position: [p], rotatoin: [q], force: [f]}\n"),
              {"rotatoin", "rotation"});
  const std::string file = Write("log.csv", Log([](int) { return "5"; }));
  const std::string other =
      std::string(kMap) + "left_hand: {position: [a], rotation: [q], force: [f]}\n";
  ExpectWords(ErrorOf([&] { Run(other, file); }), {"log.csv", "a.x"});
  ExpectWords(
      ErrorOf([&] { Run(kMap, Write("log.csv", Log([](int) { return std::string("nan"); }))); }),
      {"never measured together"});
}

TEST_F(Import, OfAnEditedFileIsRefused) {
  const ImportMap map = ParseImportMap(kMap, "map.yaml");
  const std::string text =
      ImportPerson(map, ReadCsv(Write("log.csv", Log([](int) { return "5"; })), {"t", "ms", 0}));
  EXPECT_TRUE(IsPersonFile(Write("a.csv", text)));
  std::string cut = text;
  cut.erase(cut.find("\n0.05,"), cut.find("\n0.09,") - cut.find("\n0.05,"));
  ExpectWords(ErrorOf([&] { ReadPersonFile(Write("cut.csv", cut)); }), {"0.01 s apart"});
  std::string version = text;
  version.replace(version.find("person: 1"), 9, "person: 7");
  ExpectWords(ErrorOf([&] { ReadPersonFile(Write("v.csv", version)); }), {"predictor_person"});
  EXPECT_FALSE(IsPersonFile(Write("b.csv", "time,x\n")));
  const PersonFile changed = ReadPersonFile(Write("a.csv", text), {"operator.body.height=1.62"});
  EXPECT_EQ(changed.header.body->height, 1.62);
}

// ---- bags -------------------------------------------------------------------------------------

// Returns a WrenchStamped in CDR: stamp, frame, and six numbers.
std::string WrenchMessage(std::int32_t second, std::uint32_t nanosecond, double force) {
  mcap::Bytes bytes;
  bytes.text.assign("\0\1\0\0", 4);
  bytes.Number(second).Number(nanosecond).U32(5);
  bytes.text.append("tool\0", 5);
  bytes.text.append(7, '\0');  // aligns to 8: 17 bytes so far
  for (int i = 0; i < 6; ++i) bytes.Number(force + i);
  return bytes.text;
}

std::string Bag(const std::string& compression, std::uint32_t crc_error) {
  mcap::Bytes schema, channel, chunk;
  schema.U16(1).String("geometry_msgs/msg/WrenchStamped").String("ros2msg").String("");
  channel.U16(1).U16(1).String("/wrench").String("cdr").U32(0);
  std::string records =
      mcap::Record(mcap::Op::kSchema, schema.text) + mcap::Record(mcap::Op::kChannel, channel.text);
  for (int i = 0; i < 3; ++i) {
    mcap::Bytes message;
    message.U16(1).U32(0).U64(5'000'000'000).U64(5'000'000'000);
    message.text += WrenchMessage(7, 10'000'000 * i, 10 * i);
    records += mcap::Record(mcap::Op::kMessage, message.text);
  }
  chunk.U64(0).U64(0).U64(records.size()).U32(mcap::Crc(records) + crc_error).String(compression);
  chunk.U64(records.size());
  return std::string(mcap::kMagic) + mcap::Record(mcap::Op::kHeader, std::string(8, '\0')) +
         mcap::Record(mcap::Op::kChunk, chunk.text + records) +
         mcap::Record(mcap::Op::kDataEnd, std::string(4, '\0')) + std::string(mcap::kMagic);
}

TEST_F(Import, ReadsStampedMessagesOfABag) {
  const SeriesFile file = ReadSeries(Write("a.mcap", Bag("", 0)));
  const Series& force = file.At("/wrench.wrench.force.y");
  EXPECT_EQ(force.unit, "N");
  EXPECT_EQ(force.values, (std::vector<double>{1, 11, 21}));
  EXPECT_NEAR((*force.times)[2], 7.02, 1e-9);
  EXPECT_EQ(file.At("/wrench.wrench.torque.z").values[0], 5);
}

TEST_F(Import, RefusesADamagedBag) {
  ExpectWords(ErrorOf([&] { ReadSeries(Write("a.mcap", Bag("", 1))); }), {"a.mcap", "CRC"});
  ExpectWords(ErrorOf([&] { ReadSeries(Write("a.mcap", Bag("lz4", 0))); }),
              {"lz4", "mcap compress"});
  ExpectWords(ErrorOf([&] { ReadSeries(Write("a.mcap", "no bag at all")); }),
              {"not an MCAP", "or a CSV file"});
  ExpectWords(ErrorOf([&] { ReadSeries(Write("a.db3", "no bag at all, but 20 bytes")); }),
              {"a.db3", "SQLite"});
  const std::string whole = Bag("", 0);
  for (std::size_t n = 1; n < whole.size(); n += 3) {
    const std::string file = Write("cut.mcap", whole.substr(0, n));
    ErrorOf([&] { ReadSeries(file); });  // no crash
  }
  // The message is not a wrench.
  RosTopic topic("/wrench", "geometry_msgs/msg/WrenchStamped");
  ExpectWords(ErrorOf([&] { topic.Add(std::string("\0\1\0\0\1", 5), 0, MessageTime::kStamp); }),
              {"/wrench", "CDR"});
}

// The message contains fewer strings and characters than its counts and lengths state.
TEST_F(Import, RefusesTransformsThatAreCutOff) {
  std::string transforms("\0\1\0\0\2\0\0\0", 8);
  for (const char frame : {'a', 'b'}) {
    mcap::Bytes bytes;
    bytes.U32(7).U32(0).U32(2).text.append("w\0", 2);
    bytes.text.append(2, '\0');
    bytes.U32(2).text.append({frame, '\0'});
    bytes.text.append(frame == 'a' ? 6 : 2, '\0');  // aligns to 8
    for (int i = 0; i < 7; ++i) bytes.Number(1.5 + i);
    transforms += bytes.text;
  }
  for (std::size_t n = 0; n < transforms.size(); ++n) {
    RosTopic topic("/tf", "tf2_msgs/msg/TFMessage");
    ExpectWords(ErrorOf([&] { topic.Add(transforms.substr(0, n), 0, MessageTime::kStamp); }),
                {"/tf", "CDR"});
  }
  RosTopic topic("/tf", "tf2_msgs/msg/TFMessage");
  topic.Add(transforms, 0, MessageTime::kStamp);
  for (const std::size_t stamp : {8, 92}) transforms[stamp] = 8;  // one second later
  topic.Add(transforms, 0, MessageTime::kStamp);
  std::vector<Series> series;
  topic.Finish("file", &series);
  ASSERT_EQ(series.size(), 14u);
  EXPECT_EQ(series[0].name, "/tf[a].transform.translation.x");
  EXPECT_EQ(series[0].values[0], 1.5);
  EXPECT_EQ(series[13].name, "/tf[b].transform.rotation.w");
  EXPECT_EQ(series[13].values[0], 7.5);
}

TEST_F(Import, ReadsABagInSqlite) {
  const std::string file = folder_.path() / "bag.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const char* const tables =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT, offered_qos_profiles TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
      "BLOB);"
      "INSERT INTO topics VALUES(1, '/wrench', 'geometry_msgs/msg/WrenchStamped', 'cdr', '');"
      "INSERT INTO topics VALUES(2, '/image', 'sensor_msgs/msg/Image', 'cdr', '');";
  ASSERT_EQ(sqlite3_exec(database, tables, nullptr, nullptr, nullptr), SQLITE_OK);
  for (int i = 0; i < 3; ++i) {
    sqlite3_stmt* row = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages VALUES(NULL, 1, ?, ?)", -1, &row, nullptr);
    const std::string message = WrenchMessage(0, 0, i);  // without a stamp
    sqlite3_bind_int64(row, 1, 1'000'000'000LL * (i + 3));
    sqlite3_bind_blob(row, 2, message.data(), static_cast<int>(message.size()), SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(row), SQLITE_DONE);
    sqlite3_finalize(row);
  }
  sqlite3_close(database);
  const SeriesFile bag = ReadSeries(file);
  EXPECT_EQ(bag.At("/wrench.wrench.force.x").values, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ((*bag.At("/wrench.wrench.force.x").times)[0], 3);
  ExpectWords(bag.warnings[0], {"/image", "sensor_msgs/msg/Image"});
  EXPECT_EQ(ReadSeries(folder_.path()).series.size(), 6u);  // the folder of the bag
}

}  // namespace
}  // namespace predictor::tracks
