// Tests `predictor evaluate` with a recording that contains the measured head.
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "child.h"
#include "recording/reader.h"
#include "recording/recorder.h"
#include "support/temporary_folder.h"

namespace predictor {
namespace {

constexpr std::uint64_t kMs = 1'000'000;  // [ns]

struct Rings {
  RecordRing ticks;
  HeadRing heads;
};

// Records the ticks of `from` again, in real time, with heads every 25 ms at `height` above the
// ground.
void AddHeads(const std::string& from, const std::string& to, double height) {
  const auto rings = std::make_unique<Rings>();
  RecordingReader reader(from);
  RecorderOptions options;
  options.warn_below = options.end_below = 0;
  options.heads = &rings->heads;
  Recorder recorder(to, reader.header(), rings->ticks, options, {HeadChannel()});
  for (TickRecord tick; reader.Next(&tick);) {
    tick.wall_ns = (tick.tick + 1) * kMs;
    if (tick.tick % 25 == 0) {
      HeadRecord head;
      head.wall_ns = tick.wall_ns;
      head.p = {0.9, 0, -0.85 + height};
      head.q = {0, 0, 0, 1};  // looks along -x
      rings->heads.Publish(head);
    }
    rings->ticks.Publish(tick);
  }
  recorder.Close();
}

class MeasuredHead : public testing::Test {
 protected:
  MeasuredHead() {
    Child child({"simulate", Scenario("box_9kg"), "--quiet", "--duration", "3", "--record",
                 folder_ / "hands.mcap", "--set",
                 "operator.stance={ground: [1, 0, -0.85], facing: 180 deg}"});
    EXPECT_LE(child.Wait(), 1) << child.errors();
  }
  nlohmann::json Evaluate(const std::string& name) {
    Child child({"evaluate", folder_ / name, "--no-intervals", "--quiet", "--json", "-"});
    EXPECT_EQ(child.Wait(), 0) << child.errors();
    return nlohmann::json::parse(child.output());
  }
  const test::TemporaryFolder folder_;
};

TEST_F(MeasuredHead, IsUsedWithoutAnyOption) {
  AddHeads(folder_ / "hands.mcap", folder_ / "head.mcap", 1.6);
  const auto hands = Evaluate("hands.mcap"), head = Evaluate("head.mcap");
  EXPECT_EQ(hands.dump().find("the headset"), std::string::npos);
  EXPECT_NE(head.dump().find("the headset"), std::string::npos) << head.dump();
  const auto neck = [](const nlohmann::json& json) {
    return json["quantities"]["trunk.flexion_rad"]["mean"].get<double>();
  };
  EXPECT_GT(std::abs(neck(head) - neck(hands)), 0.01);
}

TEST_F(MeasuredHead, IsLeftOutWithAWarningIfItIsImpossible) {
  AddHeads(folder_ / "hands.mcap", folder_ / "head.mcap", 9);
  const auto head = Evaluate("head.mcap");
  EXPECT_NE(head["warnings"].dump().find("is not used"), std::string::npos) << head["warnings"];
}

}  // namespace
}  // namespace predictor
