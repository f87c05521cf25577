#include "viewer/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>

namespace predictor::viewer {
namespace {

template <class T>
double Read(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return static_cast<double>(value);
}

const std::map<std::string, std::pair<std::size_t, double (*)(const std::string&, std::size_t)>>
    kTypes = {
        {"u8", {1, Read<std::uint8_t>}},   {"i8", {1, Read<std::int8_t>}},
        {"u16", {2, Read<std::uint16_t>}}, {"i32", {4, Read<std::int32_t>}},
        {"u32", {4, Read<std::uint32_t>}}, {"u64", {8, Read<std::uint64_t>}},
        {"f32", {4, Read<float>}},         {"f64", {8, Read<double>}},
};

// Decodes the bytes only with the table, as the page does.
std::map<std::string, std::vector<double>> Decode(const std::string& bytes) {
  std::map<std::string, std::vector<double>> values;
  for (const FrameField& field : FrameFields()) {
    const auto& [size, read] = kTypes.at(field.type);
    for (std::uint32_t i = 0; i < field.count; ++i)
      values[field.name].push_back(read(bytes, field.offset + i * size));
  }
  return values;
}

TEST(Frame, HasNoGapAndNoOverlap) {
  std::size_t next = 0;
  std::set<std::string> names;
  for (const FrameField& field : FrameFields()) {
    EXPECT_EQ(field.offset, next) << field.name;
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    next += kTypes.at(field.type).first * field.count;
  }
  EXPECT_EQ(next, FrameBytes());
}

// The page's generated source contains the numbers of states and causes, and the types of the
// fields. This source must agree with the program.
TEST(Frame, ThePagesTypesAreThoseOfTheTable) {
  std::ifstream file(PREDICTOR_SOURCE_DIR "/web/src/quantities.ts");
  const std::string source{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(source, PageQuantities())
      << "Regenerate it: build/release/bin/page_quantities > web/src/quantities.ts";
}

TEST(Frame, ThePagesTypeOfAPersonIsThatOfTheTable) {
  std::ifstream file(PREDICTOR_SOURCE_DIR "/web/src/person_state.ts");
  const std::string source{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(source, PagePerson())
      << "Regenerate it: build/release/bin/page_quantities person > web/src/person_state.ts";
}

// The fields must have the names and sizes in docs/reference/viewer-protocol.md.
TEST(Frame, HasTheFieldsOfTheProtocol) {
  const std::vector<std::tuple<std::string, std::string, std::uint32_t>> run = {
      {"tick", "u64", 1},
      {"run_time", "f64", 1},
      {"wall_ns", "u64", 1},
      {"sent_ns", "u64", 1},
      {"state", "u8", 1},
      {"cause", "u8", 1},
      {"cause_hand", "i8", 1},
      {"cause_quantity", "u8", 1},
      {"cause_value", "f64", 1},
      {"cause_limit", "f64", 1},
      {"harder_cause", "u8", 1},
      {"harder_cause_hand", "i8", 1},
      {"harder_cause_quantity", "u8", 1},
      {"harder_cause_value", "f64", 1},
      {"harder_cause_limit", "f64", 1},
      {"action", "i32", 1},
      {"events", "u16", 1},
      {"latest_event", "u8", 1},
      {"cobot_stop", "u8", 1},
      {"attachment", "u8", 1},
      {"cobot_q", "f32", 16},
      {"object", "f32", 7},
      {"movables", "f32", 7 * kMaxMovables},
      {"end_effector", "f32", 7},
      {"link_distance", "f64", 1},
      {"relative_slack", "f32", 6},
      {"stage_us", "f32", 8},
      {"parameters", "f32", 5},
      {"qp_relaxed", "u8", 1},
      {"qp_failed", "u8", 1},
      {"guard_altered", "u8", 1},
      {"recording", "u8", 1}};
  const std::vector<std::tuple<std::string, std::string, std::uint32_t>> hand = {
      {"present", "u8", 1},     {"gripping", "u8", 1},        {"arm_fault", "u8", 1},
      {"real", "f32", 7},       {"virtual", "f32", 7},        {"wrench", "f32", 6},
      {"coupling", "f32", 6},   {"peak", "f32", 2},           {"arm_q", "f32", 10},
      {"sensor_age", "f64", 1}, {"manipulability", "f64", 1}, {"keeps_power", "u8", 1}};
  std::set<std::tuple<std::string, std::string, std::uint32_t>> expected(run.begin(), run.end());
  for (const auto& [name, type, count] : hand)
    for (const char* side : {"left_", "right_"}) expected.emplace(side + name, type, count);
  std::set<std::tuple<std::string, std::string, std::uint32_t>> fields;
  for (const FrameField& field : FrameFields()) fields.emplace(field.name, field.type, field.count);
  EXPECT_EQ(fields, expected);
}

// Returns a record in which the fields of the frame differ from their defaults.
TickRecord FilledRecord() {
  TickRecord r = {};
  r.tick = (1ULL << 40) + 3;
  r.run_time = 12.345678901;
  r.wall_ns = 7'000'000'000'000;
  r.state = RunState::kHeld;
  r.cause = StopCause::kLinkDistance;
  r.cause_hand = -1;
  r.cause_quantity = Quantity::kLength;
  r.cause_value = 0.29;
  r.cause_limit = 0.3;
  r.harder = {StopCause::kStale, 1, Quantity::kArmAge, 1, {}, 0.021, 0.02};
  r.action = -1;
  r.cobot_q[15] = 2.5;
  r.object.pose = {{1, 2, 3}, {0.5, 0.5, -0.5, 0.5}};
  r.movables[1] = {{7, 8, 9}, {1, 0, 0, 0}};
  r.hands[1].present = 1;
  r.hands[1].arm_fault = 1;
  r.hands[0].warnings = 1U << static_cast<unsigned>(Warning::kKeepsPower);
  r.hands[1].warnings = static_cast<std::uint8_t>(~r.hands[0].warnings);
  r.hands[1].virtual_.pose.p = {4, 5, 6};
  r.hands[0].wrench[5] = -3;
  r.hands[1].q[9] = 0.25;
  r.link_distance = std::numeric_limits<double>::infinity();
  r.stage_us[7] = 14.5;
  r.parameters = {1.5, 0.5, 2, 25, 4};
  r.guard_altered = 1;
  return r;
}

TEST(Frame, CarriesTheRecord) {
  const TickRecord r = FilledRecord();
  Peaks peaks;
  TickRecord before = r;
  before.hands[0].wrench = {3, 4, 0, 0, 0, 1};
  peaks.See(before);
  peaks.See(r);
  const std::string bytes = PackFrame(r, peaks, 99, true);
  ASSERT_EQ(bytes.size(), FrameBytes());
  auto v = Decode(bytes);
  EXPECT_EQ(v["tick"][0], static_cast<double>(r.tick));
  EXPECT_EQ(v["run_time"][0], r.run_time);
  EXPECT_EQ(v["wall_ns"][0], 7e12);
  EXPECT_EQ(v["sent_ns"][0], 99);
  EXPECT_EQ(v["state"][0], 7);
  EXPECT_EQ(v["cause"][0], 7);
  EXPECT_EQ(v["cause_hand"][0], -1);
  EXPECT_EQ(v["cause_quantity"][0], 4);
  EXPECT_EQ(v["cause_value"][0], 0.29);
  EXPECT_EQ(v["cause_limit"][0], 0.3);
  EXPECT_EQ(v["harder_cause"][0], 4);
  EXPECT_EQ(v["harder_cause_hand"][0], 1);
  EXPECT_EQ(v["harder_cause_quantity"][0], 9);
  EXPECT_EQ(v["harder_cause_value"][0], 0.021);
  EXPECT_EQ(v["harder_cause_limit"][0], 0.02);
  EXPECT_EQ(v["action"][0], -1);
  EXPECT_EQ(v["left_peak"], (std::vector<double>{5, 3}));
  EXPECT_EQ(v["right_peak"], (std::vector<double>{0, 0}));
  EXPECT_EQ(v["cobot_q"][15], 2.5);
  EXPECT_EQ(v["object"], (std::vector<double>{1, 2, 3, 0.5, 0.5, -0.5, 0.5}));
  EXPECT_EQ(v["movables"][7], 7);
  EXPECT_EQ(v["movables"][10], 1);
  EXPECT_EQ(v["right_present"][0], 1);
  EXPECT_EQ(v["left_present"][0], 0);
  EXPECT_EQ(v["right_arm_fault"][0], 1);
  EXPECT_EQ(v["left_arm_fault"][0], 0);
  EXPECT_EQ(v["right_keeps_power"][0], 0);
  EXPECT_EQ(v["left_keeps_power"][0], 1);
  EXPECT_EQ(v["right_virtual"][2], 6);
  EXPECT_EQ(v["left_wrench"][5], -3);
  EXPECT_EQ(v["right_arm_q"][9], 0.25);
  EXPECT_EQ(v["link_distance"][0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(v["stage_us"][7], 14.5);
  EXPECT_EQ(v["parameters"], (std::vector<double>{1.5, 0.5, 2, 25, 4}));
  EXPECT_EQ(v["guard_altered"][0], 1);
  EXPECT_EQ(v["recording"][0], 1);
}

}  // namespace
}  // namespace predictor::viewer
