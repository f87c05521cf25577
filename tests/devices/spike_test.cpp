// A reading beyond the range of its sensor must not enter the simulation or the recorded wrench.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/words.h"
#include "devices/net_ft/rdt.h"
#include "fakes/bench.h"

namespace predictor {
namespace {

struct Spike {
  const char* name;
  int axis;
  double value;  // [N], [N·m]
};

double Norm(const std::array<double, 6>& x) {
  double sum = 0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum);
}

// In RUN, with both hands on the object, the test falsifies one datagram of the left hand's Net
// F/T.
TEST(Spike, MovesNeitherTheSimulationNorTheRecordedWrench) {
  for (const Spike& spike : {Spike{"2000 N", 2, 2000}, Spike{"-2000 N", 0, -2000},
                             Spike{"300 N", 1, 300}, Spike{"50 N·m", 4, 50}}) {
    BenchOptions options;
    options.scenario = PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml";
    options.sensors = {"net_ft", "net_ft"};
    Bench bench(options);
    std::vector<TickRecord> records;
    ASSERT_TRUE(bench.Start());
    bench.Pass(2.5);
    ASSERT_EQ(bench.emulator().state(), RunState::kRun);
    bench.Watch([&](const TickRecord& record) { records.push_back(record); });
    bench.Pass(0.2);
    const std::size_t quiet = records.size();
    int forged = 0;
    bench.sensor_wire(0).corrupt = [&](Bytes* bytes) {
      auto record = rdt::DecodeRecord(*bytes);
      if (!record || forged++ > 0) return;
      record->counts[static_cast<std::size_t>(spike.axis)] =
          static_cast<std::int32_t>(spike.value * 1e6);
      std::ranges::copy(rdt::Encode(*record), bytes->begin());
    };
    bench.Pass(0.1);
    ASSERT_EQ(forged > 0, true);

    std::size_t seen = 0, stopped = 0;  // tick with the raw spike; tick of the stop
    // largest earlier wrench; largest change of the object's twist in a tick
    double largest = 0, change = 0;
    for (std::size_t k = 0; k < records.size(); ++k) {
      const TickRecord& r = records[k];
      const double raw = r.hands[0].wrench_raw[static_cast<std::size_t>(spike.axis)];
      if (seen == 0 && std::abs(raw - spike.value) < 1e-3) seen = k;
      if (stopped == 0 && r.cause != StopCause::kNone) stopped = k;
      for (const HandRecord& hand : r.hands)
        if (k < quiet) largest = std::max(largest, Norm(hand.wrench));
      if (k == 0 || k >= quiet) continue;
      for (std::size_t i = 0; i < 6; ++i)
        change = std::max(change, std::abs(r.object.twist[i] - records[k - 1].object.twist[i]));
    }
    ASSERT_GT(seen, quiet - 1) << spike.name;
    ASSERT_GE(stopped, seen) << spike.name;
    EXPECT_LE(stopped - seen, 1U) << spike.name;
    EXPECT_EQ(records[stopped].cause, StopCause::kSensor) << spike.name;
    EXPECT_EQ(records[stopped].cause_hand, 0) << spike.name;
    EXPECT_EQ(StopCauseWords(records[stopped]),
              "Left hand: " + StopCauseText(StopCause::kSensor) + ".");
    for (std::size_t k = seen; k < records.size(); ++k) {
      for (const HandRecord& hand : records[k].hands)
        EXPECT_LE(Norm(hand.wrench), 1.2 * largest) << spike.name << ", tick " << k - seen;
      for (std::size_t i = 0; i < 6; ++i)
        EXPECT_LE(std::abs(records[k].object.twist[i] - records[k - 1].object.twist[i]),
                  1.5 * change)
            << spike.name << ", tick " << k - seen;
    }
  }
}

}  // namespace
}  // namespace predictor
