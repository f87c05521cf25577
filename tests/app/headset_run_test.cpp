// Tests a run with a registered headset: the head of its wearer passes the real server, and reaches
// the live evaluation and the recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child.h"
#include "recording/reader.h"
#include "support/temporary_folder.h"
#include "viewer/client.h"

namespace predictor {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kPeriod = 20'000'000;  // between two poses [ns]

// A headset that sends the pose of a head which looks along -x of W and moves along z.
class Headset {
 public:
  explicit Headset(const std::string& said)
      : page_(static_cast<std::uint16_t>(std::stoi(After(said, "localhost:")))) {
    EXPECT_NE(page_.Hello(After(said, "#code=")), "");
  }

  // Sends poses until the server has reported `count` states of the person with a measured head.
  // Returns false if the connection ends before.
  bool WearUntilMeasured(int count) {
    for (int measured = 0; measured < count;) {
      SendDuePoses();
      const auto message = page_.Next();
      if (!message || message->opcode == 8) return false;
      const Json json = Json::parse(message->opcode == 1 ? message->payload : "{}");
      if (json.value("type", "") != "person") continue;
      const std::string head = json["head"];
      ++heads_[head];
      measured += head == "measured" ? 1 : 0;
    }
    return true;
  }

  // Returns the heights [m] of the poses that were sent, by their times on the server's clock [ns].
  const std::map<std::uint64_t, double>& sent() const { return sent_; }
  // Returns the number of states of the person with each origin of the head.
  const std::map<std::string, int>& heads() const { return heads_; }

 private:
  // Returns the text after `what` up to the end of the word.
  static std::string After(const std::string& said, const std::string& what) {
    const std::size_t begin = said.find(what) + what.size();
    return said.substr(begin, said.find_first_of("/ \r\n\x1b", begin) - begin);
  }

  // The server's clock is this machine's monotonic clock. Poses that fell due together, because
  // this process was delayed, keep their times.
  void SendDuePoses() {
    const auto now = static_cast<std::uint64_t>(
        std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count());
    if (posed_ == 0 || now - posed_ > 10 * kPeriod) posed_ = now - kPeriod;
    for (; posed_ + kPeriod <= now; posed_ += kPeriod) {
      const double height = 0.75 + 1e-5 * static_cast<double>(sent_.size());
      const std::uint64_t time = posed_ + kPeriod;
      sent_[time] = height;
      page_.SendText(Json{{"type", "immersive"},
                          {"active", true},
                          {"p", {0.9, 0, height}},
                          {"q", {0.5, 0.5, 0.5, 0.5}},  // WebXR: x right, y up, z backward
                          {"posed", std::to_string(time)},
                          {"registration", {{"yaw", 0.2}, {"t", {1, 2, 0}}, {"residual", 0.004}}}}
                         .dump());
    }
  }

  testing_client::WebSocket page_;
  std::uint64_t posed_ = 0;
  std::map<std::uint64_t, double> sent_;
  std::map<std::string, int> heads_;
};

class HeadsetRun : public testing::Test {
 protected:
  // Runs a scenario while a headset is worn.
  void Run() {
    Child run({"run", Scenario("box_9kg"), "--port", "0", "--duration", "4", "--no-stay",
               "--record", file_, "--set",
               "operator.stance={ground: [1, 0, -0.85], facing: 180 deg}"});
    ASSERT_TRUE(run.Says("#code=") && run.Says("RUN")) << run.errors();
    Headset headset(run.errors());
    EXPECT_TRUE(headset.WearUntilMeasured(30)) << Json(headset.heads()).dump();
    sent_ = headset.sent();
    EXPECT_EQ(headset.heads().count("impossible"), 0u);
    EXPECT_LE(run.Wait(), 1) << run.errors();
  }
  Json Evaluate() {
    Child child({"evaluate", file_, "--no-intervals", "--quiet", "--json", "-"});
    EXPECT_EQ(child.Wait(), 0) << child.errors();
    return Json::parse(child.output());
  }

  const test::TemporaryFolder folder_;
  const std::string file_ = folder_ / "run.mcap";
  std::map<std::uint64_t, double> sent_;
};

TEST_F(HeadsetRun, RecordsTheHeadAndEvaluatesItAsMeasured) {
  Run();
  RecordingReader reader(file_);
  TickRecord first;
  ASSERT_TRUE(reader.Next(&first));
  const auto heads = reader.ReadHeads();
  ASSERT_GT(heads.size(), 10u);
  for (const RecordedHead& recorded : heads) {
    const HeadRecord& head = recorded.head;
    const auto since = static_cast<std::uint64_t>(std::llround(1e9 * recorded.time));
    const auto at = sent_.lower_bound(first.wall_ns + since - 1000);  // rounding of the time
    ASSERT_NE(at, sent_.end());
    EXPECT_LE(at->first, first.wall_ns + since + 1000);
    EXPECT_EQ(head.p, (std::array<double, 3>{0.9, 0, at->second}));
    // The head has x forward, y left and z up, so it is turned by 180° about z.
    EXPECT_NEAR(std::abs(head.q[3]), 1, 1e-9);
    EXPECT_EQ(head.registration, (HeadRegistration{.yaw = 0.2, .t = {1, 2, 0}, .residual = 0.004}));
  }
  const Json parts = Evaluate()["measured"]["parts"];
  ASSERT_EQ(parts.size(), 2u) << parts;
  EXPECT_EQ(parts[0]["what"], "head");
  EXPECT_EQ(parts[0]["source"], "the headset");
  EXPECT_GT(parts[0]["share_of_time"], 0.1);
}

}  // namespace
}  // namespace predictor
