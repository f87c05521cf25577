// The poses of movable objects are recorded only in scenarios that have movable objects.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "recording/cdr.h"
#include "recording/columns.h"
#include "recording/reader.h"
#include "recording/samples.h"
#include "recording/schema.h"
#include "recording/writer.h"

namespace predictor {
namespace {

using recording_test::SampleTick;

TickRecord TickWithTwo() {
  TickRecord record = SampleTick(1);
  record.movable_count = 2;
  record.movables[0] = {{1, 2, 3}, {1, 0, 0, 0}};
  record.movables[1] = {{4, 5, 6}, {0.5, 0.5, -0.5, 0.5}};
  return record;
}

std::vector<std::string> NamesOf(const std::vector<Column>& columns) {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
}

TEST(MovablePoses, AreColumnsOfThoseThatExist) {
  const TickRecord record = TickWithTwo();
  const std::vector<Column> columns = Select(ColumnsOf(record), {"movables.poses"});
  const std::vector<std::string> names = NamesOf(columns);
  ASSERT_EQ(names.size(), 14u);
  EXPECT_EQ(names[0], "movables.poses[0].p.x");
  EXPECT_EQ(names[13], "movables.poses[1].q.z");
  EXPECT_EQ(columns[7].text(columns[7].At(record)), "4");
  EXPECT_EQ(columns[7].unit, "m");
  EXPECT_EQ(columns[7].frame, "W");
  EXPECT_THROW(Select(ColumnsOf(SampleTick(1)), {"movables.poses"}), InputError);
}

TEST(MovablePoses, AreAListOfPosesInTheSchema) {
  const std::string& text = recording::Definition(TickGroup::kMovables);
  EXPECT_NE(text.find("geometry_msgs/Pose[] poses  # [m] in W"), std::string::npos) << text;
  EXPECT_NE(text.find("MSG: geometry_msgs/Quaternion"), std::string::npos) << text;
}

TEST(MovablePoses, AreReadBack) {
  recording_test::Folder folder;
  const std::string with = folder.File("with.mcap"), without = folder.File("without.mcap");
  const TickRecord written = TickWithTwo();
  {
    RecordingWriter writer(with, recording_test::SampleHeader());
    writer.Add(written);
    writer.Close();
  }
  RecordingReader reader(with);
  TickRecord read;
  ASSERT_TRUE(reader.Next(&read));
  EXPECT_TRUE(recording::SameBits(read, written));
  {
    RecordingWriter writer(without, recording_test::SampleHeader());
    writer.Add(SampleTick(1));
    writer.Close();
  }
  RecordingReader other(without);
  ASSERT_TRUE(other.Next(&read));
  EXPECT_EQ(read.movable_count, 0);
}

// If the reader accepted a count larger than the list, it would use the count as an index beyond
// the list.
TEST(MovablePoses, ACountBeyondTheListIsRefused) {
  TickRecord record = TickWithTwo();
  std::vector<std::byte> bytes(recording::kLongestTickMessage);
  const auto reads = [&](std::uint8_t count) {
    record.movable_count = count;
    recording::CdrWriter writer(bytes.data());
    VisitMovables(writer, record);
    recording::CdrReader reader({bytes.data(), writer.size()});
    TickRecord read = recording_test::Nothing();
    VisitMovables(reader, read);
    return reader.Done();
  };
  EXPECT_TRUE(reads(kMaxMovables));
  EXPECT_FALSE(reads(kMaxMovables + 1));
}

}  // namespace
}  // namespace predictor
