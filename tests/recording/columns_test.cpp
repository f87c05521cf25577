#include "recording/columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "core/error.h"

namespace predictor {
namespace {

TickRecord Sample() {
  TickRecord record{};
  record.tick = 12;
  record.run_time = 0.1;
  record.state = RunState::kRun;
  record.cobot_dof = 7;
  record.hands[0].present = 1;
  record.hands[0].arm_dof = 6;
  record.hands[0].wrench = {1, 2, 3, 4, 5, 0.1 + 0.2};
  record.hands[0].q[5] = -std::numeric_limits<double>::infinity();
  record.stage_us[3] = 1.1F;
  record.action = -1;
  return record;
}

const Column& Find(const std::vector<Column>& columns, const std::string& name) {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const Column& column) { return column.name == name; });
  EXPECT_NE(found, columns.end()) << name;
  return found == columns.end() ? columns.front() : *found;
}

TEST(Columns, HaveNamesUnitsAndTheRecordsNumbers) {
  const TickRecord record = Sample();
  const std::vector<Column> columns = ColumnsOf(record);
  EXPECT_EQ(Find(columns, "run.tick").Text(record), "12");
  EXPECT_EQ(Find(columns, "run.run_time").unit, "s");
  EXPECT_EQ(Find(columns, "run.action").Text(record), "-1");
  EXPECT_EQ(Find(columns, "run.state").Text(record), "5");
  EXPECT_EQ(Find(columns, "hands.left.wrench.force.y").Text(record), "2");
  EXPECT_EQ(Find(columns, "hands.left.wrench.torque.z").unit, "N m");
  EXPECT_EQ(Find(columns, "hands.left.q[5]").Text(record), "-inf");
  EXPECT_EQ(std::strtof(Find(columns, "timing.render").Text(record).c_str(), nullptr), 1.1F);
}

// The reference lists the types and meanings of all numbers.
TEST(Columns, HaveTypesAndMeanings) {
  for (const Column& column : AllColumns()) {
    EXPECT_FALSE(column.meaning.empty()) << column.name << " has no meaning in core/tick_fields.h.";
    EXPECT_EQ(column.type.substr(column.type.find_first_of("0123456789")),
              std::to_string(8 * column.size))
        << column.name;
  }
  EXPECT_EQ(Find(AllColumns(), "run.tick").type, "uint64");
  EXPECT_EQ(Find(AllColumns(), "run.state").type, "uint8");
  EXPECT_EQ(Find(AllColumns(), "run.action").type, "int32");
  EXPECT_EQ(Find(AllColumns(), "run.run_time").type, "float64");
  EXPECT_EQ(Find(AllColumns(), "timing.render").type, "float32");
}

TEST(Columns, AreReadBackAsTheSameNumber) {
  const TickRecord record = Sample();
  const std::string text = Find(AllColumns(), "hands.left.wrench.torque.z").Text(record);
  EXPECT_EQ(std::strtod(text.c_str(), nullptr), 0.1 + 0.2);
}

// Every byte of a record, except for the reserved ones, must lie in exactly one column.
TEST(Columns, CoverTheRecord) {
  std::set<std::string> names;
  std::vector<int> covered(sizeof(TickRecord));
  for (const Column& column : AllColumns()) {
    EXPECT_TRUE(names.insert(column.name).second) << column.name;
    TickRecord ones;
    std::memset(static_cast<void*>(&ones), 0xff, sizeof ones);
    const std::uint64_t bits = column.Bits(ones);
    const std::size_t bytes = bits == ~0ULL ? 8 : bits == 0xffffffffU ? 4 : bits == 0xffffU ? 2 : 1;
    for (std::size_t i = 0; i < bytes; ++i) ++covered[column.offset + i];
  }
  EXPECT_EQ(std::count(covered.begin(), covered.end(), 0),
            kHands * sizeof(HandRecord::more_reserved) + 3 * sizeof(StatusRecord::reserved) +
                sizeof(TickRecord::reserved));
  EXPECT_EQ(*std::max_element(covered.begin(), covered.end()), 1);
}

TEST(Columns, OfARecordLeaveOutWhatIsAbsent) {
  const std::vector<Column> columns = ColumnsOf(Sample());
  const auto has = [&](const std::string& name) {
    return std::any_of(columns.begin(), columns.end(),
                       [&](const Column& column) { return column.name == name; });
  };
  EXPECT_TRUE(has("cobot.q[6]"));
  EXPECT_FALSE(has("cobot.q[7]"));
  EXPECT_FALSE(has("hands.left.command[6]"));
  EXPECT_FALSE(has("hands.right.wrench.force.x"));
}

TEST(Columns, OfTheCobotHaveTheUnitOfTheirJoint) {
  std::vector<Column> columns =
      Select(ColumnsOf(Sample()), {"cobot.q[0]", "cobot.v[1]", "cobot.*[2]", "hands.left.q[0]"});
  const auto units = [&] {
    std::string text;
    for (const Column& column : columns) text += column.name + " " + column.unit + "; ";
    return text;
  };
  EXPECT_EQ(
      units(),
      "cobot.q[0] rad or m; cobot.v[1] rad/s or m/s; cobot.q[2] rad or m; cobot.v[2] rad/s or "
      "m/s; cobot.torque[2] N m or N; hands.left.q[0] rad; ");
  SetJointUnits({false, true}, &columns);  // the model of joint 2 is not known
  EXPECT_EQ(units(),
            "cobot.q[0] rad; cobot.v[1] m/s; cobot.q[2] rad or m; cobot.v[2] rad/s or m/s; "
            "cobot.torque[2] N m or N; hands.left.q[0] rad; ");
  SetJointUnits({true, true, true}, &columns);
  EXPECT_EQ(units(),
            "cobot.q[0] rad; cobot.v[1] m/s; cobot.q[2] m; cobot.v[2] m/s; cobot.torque[2] N; "
            "hands.left.q[0] rad; ");
}

TEST(Columns, OfInputsExistIfRequested) {
  const std::vector<Column> columns = ColumnsOf(Sample(), InputColumns::kIncluded);
  const std::size_t inputs = Sample().inputs.size();
  EXPECT_EQ(Select(columns, {"inputs.inputs*.kind"}).size(), inputs);
  EXPECT_GT(Select(columns, {"inputs.inputs[0]"}).size(), 3U);
  EXPECT_THROW(Select(ColumnsOf(Sample()), {"inputs.inputs[0]"}), InputError);
}

TEST(Columns, AreSelectedByPatternAndGroup) {
  const std::vector<Column> columns = ColumnsOf(Sample());
  EXPECT_EQ(Select(columns, {"hands.left.wrench.force"}).size(), 3U);
  EXPECT_EQ(Select(columns, {"*.wrench.*.z"}).size(), 2U);
  // A pattern may match groups, as in the example of `predictor export data --help`.
  EXPECT_EQ(Select(columns, {"hands.*.wrench"}).size(), 6U);
  EXPECT_EQ(Select(columns, {"hands.*ft.q"}).size(), 6U);
  EXPECT_EQ(Select(columns, {"cobot.q"}).size(), 7U);
  EXPECT_EQ(Select(columns, {"cobot.q[1]", "run.tick"}).front().name, "cobot.q[1]");
  EXPECT_THROW(Select(columns, {"cobot.x"}), InputError);
  EXPECT_THROW(Select(columns, {""}), InputError);
}

}  // namespace
}  // namespace predictor
