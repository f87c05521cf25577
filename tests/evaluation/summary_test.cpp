// Scripts use the summary's names. The values must match the records.
#include "evaluation/summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/random.h"
#include "support/allocation_guard.h"

namespace predictor {
namespace {

Scenario Named(const std::string& name, std::uint64_t seed) {
  Scenario s;
  s.name = name;
  s.seed = seed;
  s.safety.force = 30;
  s.safety.torque = 5;
  return s;
}

TickRecord Running(double time, double error, double force) {
  TickRecord r{};
  r.state = RunState::kRun;
  r.ran = 1;
  r.rendered = 1;
  r.run_time = time;
  r.link_distance = 0.5;
  r.hands_gripping = 2;
  for (std::size_t i = 0; i < kHands; ++i) {
    HandRecord& h = r.hands[i];
    h.present = 1;
    h.gripping = 1;
    const double y = i == 0 ? 0.1 : -0.1;
    h.virtual_.pose = {{0, y, 0.3}, {1, 0, 0, 0}};
    h.real.pose = {{error, y, 0.3}, {1, 0, 0, 0}};
    h.wrench = {force, 0, 0, 0, 0, 0.1};
  }
  r.object.pose = {{0, 0, 0.3 + time}, {1, 0, 0, 0}};
  return r;
}

// The number of the hand in a record may be invalid.
TEST(Summary, OfAStopByNoSide) {
  for (const int hand : {-128, -1, 0, 1, 2, 127}) {
    SummaryBuilder builder(Named("hostile", 7));
    TickRecord record = Running(0.001, 0, 40);
    record.cause = StopCause::kForce;
    record.cause_hand = static_cast<std::int8_t>(hand);
    record.stage_us.fill(std::nanf(""));
    builder.Add(record);
    ASSERT_EQ(builder.stops().stops().size(), 1U);
    EXPECT_EQ(builder.stops().stops().front().hand, hand == 0 || hand == 1 ? hand : -1);
    EXPECT_FALSE(SummaryJson(builder.summary()).empty());
    EXPECT_FALSE(SummaryTable(builder.summary()).empty());
  }
}

// The summary must contain at least these names, but further metrics may add others.
TEST(Summary, HasTheContractsNames) {
  SummaryBuilder builder(Named("name", 7));
  builder.Add(Running(0.001, 0.002, 10));
  const auto json = nlohmann::json::parse(SummaryJson(builder.summary()));
  for (const char* name : {"deadlines",
                           "duration_s",
                           "link_distance_m",
                           "energy",
                           "guidance",
                           "lead_s",
                           "object",
                           "oscillation",
                           "overruns",
                           "predicted_unstable",
                           "qp",
                           "real_time_factor",
                           "records_dropped",
                           "scenario",
                           "seed",
                           "stability_margin",
                           "stop",
                           "stop_count",
                           "stops",
                           "ticks",
                           "timing_us",
                           "tracking",
                           "wrench"})
    EXPECT_TRUE(json.contains(name)) << name;
  EXPECT_EQ(json["tracking"]["left"]["translation_m"]["mean"], 0.002);
  EXPECT_TRUE(json["tracking"]["relative"]["distance_m"].contains("std"));
  EXPECT_TRUE(json["tracking"]["relative"].contains("angle_rad"));
  EXPECT_TRUE(json["tracking"]["relative"]["right_from_left_m"].contains("max"));
  EXPECT_EQ(json["tracking"]["whole_run"]["right"]["translation_m"]["mean"], 0.002);
  EXPECT_TRUE(json["tracking"]["released"].is_null());
  EXPECT_EQ(json["wrench"]["right"]["force_n"]["max"], 10);
  EXPECT_TRUE(json["stop"].is_null());
  for (const char* stage :
       {"tick", "read", "sense", "simulate", "render", "monitor", "guard", "write"})
    for (const char* quantile : {"p50", "p99", "p999", "max"})
      EXPECT_TRUE(json["timing_us"][stage].contains(quantile)) << stage;
}

TEST(Summary, StatesWhetherTheHapticLoopWasPredictedUnstable) {
  SummaryBuilder builder(Named("name", 7));
  builder.Add(Running(0.001, 0.002, 10));
  Summary s = builder.summary();
  auto json = nlohmann::json::parse(SummaryJson(s));
  for (const char* key : {"lead_s", "stability_margin", "predicted_unstable"})
    EXPECT_TRUE(json[key].is_null()) << key;
  EXPECT_EQ(SummaryTable(s).find("Lead"), std::string::npos);
  for (const double margin : {0.0, 0.84, 1.0, 2.1}) {
    s.loop = PredictedLoop{0.0181, margin};
    json = nlohmann::json::parse(SummaryJson(s));
    EXPECT_EQ(json["lead_s"], 0.0181);
    EXPECT_EQ(json["stability_margin"], margin);
    EXPECT_EQ(json["predicted_unstable"], margin < 1);
    const std::string table = SummaryTable(s);
    EXPECT_NE(table.find("Lead 18.1 ms, stability margin"), std::string::npos) << table;
    EXPECT_EQ(table.find("PREDICTED UNSTABLE") != std::string::npos, margin < 1) << table;
  }
}

TEST(Summary, ComputesMeansDeviationsAndTheReleasedPartApart) {
  SummaryBuilder builder(Named("name", 1));
  builder.Add(Running(0.001, 0.001, 10));
  builder.Add(Running(0.002, 0.003, 12));
  TickRecord released = Running(0.003, 0.5, 0);
  released.hands_gripping = 1;
  builder.Add(released);
  TickRecord idle = Running(0, 9, 99);
  idle.state = RunState::kIdle;
  idle.ran = 0;
  builder.Add(idle);  // must be ignored
  const Summary s = builder.summary();
  EXPECT_EQ(s.ticks(), 3u);
  const auto& gripping = s.Get<Statistics>("tracking.left.translation_m");
  EXPECT_DOUBLE_EQ(gripping.mean(), 0.002);
  EXPECT_NEAR(gripping.std(), std::sqrt(2e-6), 1e-12);
  EXPECT_DOUBLE_EQ(s.Get<Statistics>("tracking.released.right.translation_m").max(), 0.5);
  EXPECT_NEAR(s.Get<double>("object.height_m.final"), 0.303, 1e-12);
  EXPECT_NEAR(s.Get<double>("object.lift_m"), 0.002, 1e-12);
}

// A rotation of the left handle about its own origin keeps the distance between the handles. In the
// left handle's frame, this rotation moves the right handle by the chord of the arc. A common
// translation of both handles changes neither value.
TEST(Summary, SeparatesTheRelativePoseFromTheDistance) {
  constexpr double kAngle = 0.1, kDistance = 0.2, kShift = 0.03;
  TickRecord turned = Running(0.001, kShift, 0);
  turned.hands[0].real.pose.q = {std::cos(kAngle / 2), 0, 0, std::sin(kAngle / 2)};
  SummaryBuilder builder(Named("name", 1));
  builder.Add(Running(0.001, kShift, 0));
  const auto max = [&](const std::string& key) {
    return builder.summary().Get<Statistics>("tracking.relative." + key).max();
  };
  EXPECT_NEAR(max("right_from_left_m"), 0, 1e-15);
  builder.Add(turned);
  EXPECT_NEAR(max("distance_m"), 0, 1e-15);
  EXPECT_NEAR(max("right_from_left_m"), 2 * kDistance * std::sin(kAngle / 2), 1e-12);
  EXPECT_NEAR(max("angle_rad"), kAngle, 1e-12);
}

// The statistics of the whole run must combine the means and the sums of squares of its parts.
TEST(Summary, OfTheWholeRunIsThatOfItsParts) {
  SummaryBuilder builder(Named("name", 1));
  for (const double error : {0.001, 0.004, 0.002}) builder.Add(Running(0.001, error, 1));
  TickRecord released = Running(0.004, 0.011, 0);
  released.hands_gripping = 0;
  builder.Add(released);
  const Summary s = builder.summary();
  const auto& whole_run = s.Get<Statistics>("tracking.whole_run.right.translation_m");
  EXPECT_EQ(whole_run.count(), 4U);
  EXPECT_NEAR(whole_run.mean(), 0.018 / 4, 1e-15);
  EXPECT_EQ(whole_run.max(), 0.011);
  EXPECT_EQ(s.Get<Statistics>("tracking.right.translation_m").max(), 0.004);
  EXPECT_NE(SummaryTable(s).find("Whole run"), std::string::npos);
}

TEST(Summary, ReportsTheStopAndWhenTheTruthCrossedTheThreshold) {
  SummaryBuilder builder(Named("name", 1));
  for (int k = 0; k < 5; ++k) {
    TickRecord r = Running(0.001 * k, 0, 29);
    r.hands[1].true_wrench = {k >= 2 ? 31.0 : 20.0, 0, 0, 0, 0, 0};
    builder.Add(r);
  }
  TickRecord stop = Running(0.005, 0, 30.5);
  stop.state = RunState::kStopping;
  stop.cause = StopCause::kForce;
  stop.cause_hand = 1;
  stop.cause_value = 30.5;
  stop.cause_limit = 30;
  stop.cause_quantity = Quantity::kForce;
  stop.hands[1].true_wrench = {32, 0, 0, 0, 0, 0};
  builder.Add(stop);
  TickRecord braking = stop;
  braking.ran = braking.rendered = 0;
  braking.hands[1].wrench = {99, 0, 0, 0, 0, 0};
  builder.Add(braking);  // must be ignored, because simulated time is paused
  ASSERT_EQ(builder.stops().stops().size(), 1U);
  EXPECT_NEAR(builder.stops().stops().front().detection.value(), 0.003, 1e-12);
  const auto json = nlohmann::json::parse(SummaryJson(builder.summary()));
  EXPECT_EQ(json["stop"]["cause"], "force");
  EXPECT_EQ(json["stop"]["hand"], "right");
  EXPECT_EQ(json["stop"]["quantity"], "force");
  EXPECT_EQ(json["stop"]["time_s"], 0.005);
  EXPECT_TRUE(json["stop"]["power_off_by"].is_null());
  // The statistics of the force must include the value that caused the stop.
  EXPECT_EQ(json["wrench"]["right"]["force_n"]["max"], 30.5);
  EXPECT_EQ(json["ticks"], 6);
  EXPECT_DOUBLE_EQ(json["duration_s"], 0.006);
  EXPECT_NE(SummaryTable(builder.summary()).find("30.5 N, limit 30 N"), std::string::npos);
}

TEST(Summary, ReportsWhatMadeTheEndOfAStopHarder) {
  SummaryBuilder builder(Named("name", 1));
  TickRecord stop = Running(0.001, 0, 1);
  stop.state = RunState::kStopping;
  stop.cause = StopCause::kDeadline;
  stop.cause_hand = -1;
  builder.Add(stop);
  stop.harder = {StopCause::kStale, 0, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
  stop.state = RunState::kUnpowered;
  builder.Add(stop);
  TickRecord reset = Running(0, 0, 1);
  reset.state = RunState::kIdle;
  builder.Add(reset);
  const auto by = nlohmann::json::parse(SummaryJson(builder.summary()))["stop"]["power_off_by"];
  EXPECT_EQ(by["cause"], "stale");
  EXPECT_EQ(by["hand"], "left");
  EXPECT_EQ(by["value"], 0.0214);
  EXPECT_EQ(by["quantity"], "arm_age");
  const std::string table = SummaryTable(builder.summary());
  EXPECT_TRUE(table.find("Power-off was requested because: Left") != std::string::npos);
}

// The summary must contain the reason even if it occurs in the tick of the last record.
TEST(Summary, ReportsWhatMadeAStopHarderInItsOwnTick) {
  SummaryBuilder builder(Named("name", 1));
  TickRecord stop = Running(0.001, 0, 1);
  stop.state = RunState::kStopping;
  stop.cause = StopCause::kDeadline;
  stop.cause_hand = -1;
  stop.harder = {StopCause::kStale, 0, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
  builder.Add(stop);
  ASSERT_EQ(builder.stops().stops().size(), 1U);
  EXPECT_EQ(builder.stops().stops().front().harder.cause, StopCause::kStale);
  EXPECT_EQ(builder.stops().stops().front().harder.value, 0.0214);
}

// The table must not claim rest if the cause or the end of the stop excludes it.
TEST(Summary, StatesThatArmsDidNotRest) {
  const auto rested = [](StopCause cause, Quantity quantity, const StatusRecord& harder) {
    SummaryBuilder builder(Named("name", 1));
    TickRecord stop = Running(0.001, 0, 1);
    stop.state = RunState::kStopping;
    stop.cause = cause;
    stop.cause_hand = -1;
    stop.cause_quantity = quantity;
    builder.Add(stop);
    stop.state = RunState::kUnpowered;
    stop.harder = harder;
    builder.Add(stop);
    const std::string table = SummaryTable(builder.summary());
    const bool reported = table.find("came to rest after") != std::string::npos;
    EXPECT_NE(reported, table.find("The arms had not come to rest.") != std::string::npos) << table;
    EXPECT_NE(reported, DidNotRest(builder.stops().stops().front()));
    return reported;
  };
  const auto device = [](Quantity quantity) {
    return StatusRecord{StopCause::kDevice, 1, quantity, 1, {}, 0.02, 0.0025};
  };
  EXPECT_FALSE(rested(StopCause::kForce, Quantity::kForce, device(Quantity::kSpeed)));
  EXPECT_FALSE(rested(StopCause::kForce, Quantity::kForce, device(Quantity::kTime)));
  EXPECT_FALSE(rested(StopCause::kDevice, Quantity::kSpeed, {}));
  EXPECT_FALSE(rested(StopCause::kDevice, Quantity::kTime, {}));
  EXPECT_TRUE(rested(StopCause::kForce, Quantity::kForce, device(Quantity::kAngle)));  // a jump
  EXPECT_TRUE(rested(StopCause::kDevice, Quantity::kNone, {}));
  EXPECT_TRUE(rested(StopCause::kTracking, Quantity::kSpeed, {}));
}

TEST(Summary, ShowsEachQuantityInItsOwnUnit) {
  const auto reported = [](StopCause cause, Quantity quantity, double value) {
    SummaryBuilder builder(Named("name", 1));
    TickRecord stop = Running(0.001, 0, 1);
    stop.state = RunState::kStopping;
    stop.cause = cause;
    stop.cause_hand = -1;
    stop.cause_quantity = quantity;
    stop.cause_value = value;
    stop.cause_limit = value / 2;
    builder.Add(stop);
    const std::string table = SummaryTable(builder.summary());
    return table.substr(table.find("by cause"),
                        table.find("\n", table.find("by cause")) - table.find("by cause"));
  };
  const double degree = 0.017453292519943295;
  EXPECT_EQ(reported(StopCause::kTracking, Quantity::kLength, 0.02),
            "by cause 'tracking': 20 mm, limit 10 mm.");
  EXPECT_EQ(reported(StopCause::kTracking, Quantity::kAngle, 6 * degree),
            "by cause 'tracking': 6°, limit 3°.");
  EXPECT_EQ(reported(StopCause::kTracking, Quantity::kSpeed, 0.004),
            "by cause 'tracking': 4 mm/s, limit 2 mm/s.");
  EXPECT_EQ(reported(StopCause::kTracking, Quantity::kAngularSpeed, degree),
            "by cause 'tracking': 1°/s, limit 0.5°/s.");
  EXPECT_EQ(reported(StopCause::kCoupling, Quantity::kTorque, 8),
            "by cause 'coupling': 8 N·m, limit 4 N·m.");
  EXPECT_EQ(reported(StopCause::kStale, Quantity::kCount, 50), "by cause 'stale': 50, limit 25.");
  EXPECT_EQ(reported(StopCause::kOperator, Quantity::kNone, 0), "by cause 'operator'.");
}

TEST(Summary, HasNoFiguresIfRunWasNotReached) {
  SummaryBuilder builder(Named("name", 1));
  TickRecord record = Running(0, 9, 99);
  record.state = RunState::kIdle;
  record.ran = 0;
  builder.Add(record);
  record.state = RunState::kStopping;
  record.cause = StopCause::kDevice;
  record.cause_hand = 0;
  builder.Add(record);
  const std::string table = SummaryTable(builder.summary());
  EXPECT_NE(table.find("was never reached"), std::string::npos) << table;
  EXPECT_NE(table.find("by cause 'device', left hand"), std::string::npos) << table;
  for (const char* figure : {"While gripping", "Hands", "Height", "Time per tick"})
    EXPECT_EQ(table.find(figure), std::string::npos) << table;
  const auto json = nlohmann::json::parse(SummaryJson(builder.summary()));
  EXPECT_TRUE(json["tracking"]["left"].is_null());
  EXPECT_TRUE(json["object"]["height_m"].is_null());
  EXPECT_TRUE(json["timing_us"]["tick"].is_null());
  EXPECT_EQ(json["stop"]["cause"], "device");
}

// The definition of rest is the same as in a stop. A handle is not at rest while it rotates or
// while its driver moves it.
TEST(Summary, RestsWhereTheStopRests) {
  const auto duration = [](const auto& at) {
    SummaryBuilder builder(Named("name", 1));
    TickRecord record = Running(0.001, 0, 10);
    record.state = RunState::kStopping;
    record.cause = StopCause::kForce;
    record.cause_hand = 1;
    builder.Add(record);
    record.ran = 0;
    for (int k = 1; k <= 9; ++k) {
      at(k, &record.hands[1]);
      builder.Add(record);
    }
    return builder.stops().stops().front().duration;
  };
  const auto turning = [&](double step) {  // rotation in each of five ticks [rad]
    return duration([&](int k, HandRecord* hand) {
      const double half = step * std::min(k, 5) / 2;
      hand->real.pose.q = {std::cos(half), 0, 0, std::sin(half)};
    });
  };
  EXPECT_NEAR(turning(6e-4), 0.005, 1e-12);  // 60 µm at a lever arm of 0.1 m
  EXPECT_EQ(turning(0.9e-4), 0);             // 45 µm in total
  EXPECT_NEAR(duration([](int k, HandRecord* hand) { hand->arm_in_motion = k <= 7; }), 0.007,
              1e-12);
}

// The run has one stop after 3 ticks and, after a reset, another one after 2 more ticks.
TEST(Summary, ReportsEachStop) {
  SummaryBuilder builder(Named("name", 1));
  const auto stop = [&](StopCause cause, std::int8_t hand, int ran, double way) {
    for (int k = 0; k < ran; ++k) builder.Add(Running(0.001 * k, 0, 10));
    TickRecord r = Running(0.001 * ran, 0, 10);
    r.state = RunState::kStopping;
    r.cause = cause;
    r.cause_hand = hand;
    builder.Add(r);
    r.ran = 0;
    for (int k = 1; k <= 4; ++k) {  // moves in two of the four ticks
      r.hands[1].real.pose.p[0] = way * std::min(k, 2) / 2;
      builder.Add(r);
    }
    r.state = RunState::kHeld;
    builder.Add(r);
    builder.Add(r);
  };
  stop(StopCause::kForce, 1, 3, 0.004);
  EXPECT_EQ(builder.stops().count(), 1U);
  TickRecord reset = Running(0, 0, 0);
  reset.state = RunState::kIdle;
  reset.ran = 0;
  builder.Add(reset);
  stop(StopCause::kEnabling, -1, 2, 0.002);
  const auto json = nlohmann::json::parse(SummaryJson(builder.summary()));
  EXPECT_EQ(json["stop"]["cause"], "force");
  EXPECT_EQ(json["stop_count"], 2);
  ASSERT_EQ(json["stops"].size(), 2U);
  EXPECT_EQ(json["stops"][0], json["stop"]);
  EXPECT_NEAR(json["stops"][0]["stop_distance_m"], 0.004, 1e-9);
  EXPECT_NEAR(json["stops"][0]["stop_duration_s"], 0.002, 1e-12);
  EXPECT_EQ(json["stops"][1]["cause"], "enabling");
  EXPECT_NEAR(json["stops"][1]["stop_distance_m"], 0.002, 1e-9);
  EXPECT_NEAR(json["stops"][1]["time_s"], 0.003 + 0.002, 1e-9);
  const std::string table = SummaryTable(builder.summary());
  for (const char* part : {"2 stops:", "by cause 'force', right hand", "by cause 'enabling'"})
    EXPECT_NE(table.find(part), std::string::npos) << table;
}

TEST(Summary, DoesNotCountEncoderNoiseAsDistance) {
  StopLog log(Named("name", 1));
  RandomStream random(1, "encoder");
  TickRecord record = Running(0.001, 0, 10);
  record.state = RunState::kStopping;
  record.cause = StopCause::kForce;
  for (int k = 0; k < 1000; ++k) {
    record.hands[1].real.pose.p = {1e-5 * random.Uniform(), 1e-5 * random.Uniform(), 0};
    log.Add(record);
  }
  EXPECT_LE(log.stops().front().distance, 2e-5);
}

// Returns the summary of a run that has the given numbers of ticks in the states of the grip, one
// after the other.
Summary WithGrip(const std::vector<std::pair<AttachmentState, int>>& states) {
  SummaryBuilder builder(Named("name", 1));
  for (const auto& [state, ticks] : states) {
    TickRecord record = Running(0, 0, 10);
    record.attachment = static_cast<std::uint8_t>(state);
    for (int k = 0; k < ticks; ++k) builder.Add(record);
  }
  return builder.summary();
}

TEST(Summary, StatesTheGripOfTheCobot) {
  using S = AttachmentState;
  const Summary summary =
      WithGrip({{S::kHolds, 5}, {S::kSlips, 20}, {S::kOpen, 100}, {S::kMissed, 30}});
  const auto grip = nlohmann::json::parse(SummaryJson(summary))["gripper"];
  EXPECT_EQ(grip["at_end"], "too far to grasp");
  EXPECT_EQ(grip["slipped"], true);
  EXPECT_NEAR(grip["slipping_s"], 0.02, 1e-12);
  EXPECT_NEAR(grip["open_s"], 0.13, 1e-12);
  EXPECT_NE(SummaryTable(summary).find("Gripper"), std::string::npos);
  // If the cobot never releases the object, the table must not contain a line about the gripper.
  const Summary held = WithGrip({{S::kHolds, 5}});
  EXPECT_EQ(nlohmann::json::parse(SummaryJson(held))["gripper"]["at_end"], "holding");
  EXPECT_EQ(nlohmann::json::parse(SummaryJson(held))["gripper"]["slipped"], false);
  EXPECT_EQ(SummaryTable(held).find("Gripper"), std::string::npos);
}

TEST(Summary, IsBuiltWithoutHeapInEachTick) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  SummaryBuilder builder(Named("name", 1));
  TickRecord record = Running(0.001, 0.002, 10);
  const test::AllocationGuard guard;
  for (int k = 0; k < 10; ++k) {
    record.cause = k % 2 ? StopCause::kForce : StopCause::kNone;
    builder.Add(record);
  }
  EXPECT_EQ(guard.count(), 0);
}

// Returns the paths of all values in a summary, except for those within statistics.
std::set<std::string> PathsOf(const nlohmann::json& json, const std::string& path = "") {
  if (!json.is_object() || json.contains("mean") || json.contains("p50")) return {path};
  std::set<std::string> paths;
  for (const auto& [key, value] : json.items()) paths.merge(PathsOf(value, path + "." + key));
  return paths;
}

std::set<std::string> PathsOfSchema(const nlohmann::json& schema, const std::string& path = "") {
  if (!schema.contains("properties")) return {path};
  std::set<std::string> paths;
  for (const auto& [key, value] : schema["properties"].items())
    paths.merge(PathsOfSchema(value, path + "." + key));
  return paths;
}

TEST(Summary, HasASchemaOfEveryValueWithItsMeaning) {
  SummaryBuilder builder(Named("name", 1));
  TickRecord gripping = Running(0.001, 0.002, 10);
  for (int k = 0; k < 4000; ++k, ++gripping.tick) builder.Add(gripping);  // a window of oscillation
  TickRecord released = Running(0.002, 0.002, 10);
  released.hands_gripping = 0;
  released.cause = StopCause::kForce;
  released.harder.cause = StopCause::kStale;
  released.cobot_stop = static_cast<std::uint8_t>(CobotStop::kForce);
  builder.Add(released);
  auto json = nlohmann::json::parse(SummaryJson(builder.summary()));
  const auto schema = nlohmann::json::parse(SummarySchema());
  EXPECT_EQ(PathsOf(json["stop"]), PathsOfSchema(schema["$defs"]["stop"]));
  json["stop"] = nullptr;
  EXPECT_EQ(PathsOf(json), PathsOfSchema(schema));
  for (const Result& result : builder.summary().results) {
    EXPECT_FALSE(result.meaning.empty()) << result.path;
    EXPECT_FALSE(result.group.empty()) << result.path;
  }
  EXPECT_EQ(schema["properties"]["wrench"]["properties"]["left"]["properties"]["force_n"]["unit"],
            "N");
}

}  // namespace
}  // namespace predictor
