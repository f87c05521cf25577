// The log must contain the events of a run.
#include "recording/run_events.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "recording/recorder.h"
#include "recording/samples.h"
#include "recording/writer.h"

namespace predictor {
namespace {

using namespace recording_test;

// Returns a tick of a run that stops and is reset, and in which a user changes the damping.
TickRecord EventfulTick(std::uint64_t tick) {
  TickRecord r = SampleTick(tick);
  r.state = tick < 10 ? RunState::kArmed : RunState::kRun;
  if (tick == 20) {
    r.input_count = 1;
    r.inputs[0].kind = InputKind::kParameter;
    r.inputs[0].parameter = Parameter::kDampingRatio;
    r.inputs[0].value = 0.8;
  }
  if (tick >= 30 && tick < 50) {
    r.state = tick < 40 ? RunState::kStopping : RunState::kHeld;
    r.cause = StopCause::kForce;
    r.cause_hand = 1;
    r.cause_value = 31.25;
    r.cause_limit = 30;
    r.cause_quantity = Quantity::kForce;
  }
  if (tick >= 45 && tick < 50) {
    r.state = RunState::kUnpowered;
    r.harder = {StopCause::kStale, 0, Quantity::kArmAge, 1, {}, 0.0214, 0.02};
  }
  if (tick >= 50) r.state = RunState::kIdle;
  return r;
}
constexpr std::uint64_t kEventfulTicks = 60;
const std::vector<std::string> kExpected = {
    "10 state state RUN",
    "20 parameter damping_ratio set to 0.8",
    "30 stop stop: force, right hand: 31.2 N, limit 30 N",
    "30 state state STOPPING",
    "40 state state HELD",
    "45 stop power off: stale, left hand: 21.4 ms, limit 20 ms",
    "45 state state UNPOWERED",
    "50 reset reset",
    "50 state state IDLE"};

std::vector<std::string> EventsOf(const std::string& path) {
  RecordingReader reader(path);
  std::vector<std::string> events;
  for (const RecordingEvent& event : reader.events())
    events.push_back(std::to_string(event.tick) + " " + event.kind + " " + event.text);
  return events;
}

TEST(RunEvents, AreInARecordingOfVirtualTime) {
  const Folder folder;
  const std::string path = folder.File("a.mcap");
  RecordingWriter writer(path, SampleHeader());
  for (std::uint64_t tick = 1; tick <= kEventfulTicks; ++tick) writer.Add(EventfulTick(tick));
  writer.Close();
  EXPECT_EQ(EventsOf(path), kExpected);
}

TEST(RunEvents, AreInARecordingOfRealTime) {
  const Folder folder;
  const std::string path = folder.File("a.mcap");
  const auto ring = std::make_unique<RecordRing>();
  Recorder recorder(path, SampleHeader(), *ring);
  for (std::uint64_t tick = 1; tick <= kEventfulTicks; ++tick) {
    TickRecord record = EventfulTick(tick);
    record.wall_ns = tick * 1'000'000;
    ring->Publish(record);
  }
  recorder.Close();
  EXPECT_EQ(EventsOf(path), kExpected);
}

// Even if values change fast, the log must contain at most 50 events a second. Changes made in a
// page must not displace a stop.
TEST(RunEvents, AreBounded) {
  recording::RunEvents events;
  std::map<std::uint64_t, int> reported;  // by second
  std::uint64_t in_all = 0, left_out = 0;
  bool stopped = false;
  for (std::uint64_t tick = 1; tick <= 5000; ++tick) {
    TickRecord r = SampleTick(tick);
    r.input_count = kInputsPerTick;
    for (RunInput& input : r.inputs) {
      input.kind = InputKind::kParameter;
      input.value = static_cast<double>(tick);
    }
    if (tick >= 2900) r.cause = StopCause::kOperator;
    if (tick >= 4000) r.state = tick % 2 == 0 ? RunState::kRun : RunState::kIdle;
    for (const RecordingEvent& event : events.Follow(r, tick * 1'000'000)) {
      ++reported[(tick - 1) / 1000];
      ++in_all;
      if (event.kind == "omitted") left_out += std::stoull(event.text);
      stopped = stopped || event.kind == "stop";
    }
  }
  EXPECT_TRUE(stopped);
  for (const auto& [second, count] : reported) EXPECT_LE(count, 50) << second;
  EXPECT_GT(in_all, 60u);
  EXPECT_GT(left_out, 10'000u);
}

}  // namespace
}  // namespace predictor
