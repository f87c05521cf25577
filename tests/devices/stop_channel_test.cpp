// The watchdog must detect the loss of its channel to a UR before it needs the channel.
#include "devices/stop_channel.h"

#include <gtest/gtest.h>

#include "devices/ur_bench.h"

namespace predictor {
namespace {

using Link = StopChannel::Link;

class StopChannelTest : public testing::Test {
 protected:
  // Calls Tend in each of these milliseconds and returns its result, which must be the same in all
  // of them.
  Link Tend(int milliseconds) {
    Link link = Link::kTalks;
    for (int i = 0; i < milliseconds; ++i) {
      bench_.network.Pass(0.001);
      const Link now = channel_->Tend();
      if (i == 0) link = now;
      EXPECT_EQ(now, link) << i;
    }
    return link;
  }

  UrBench bench_;
  std::unique_ptr<StopChannel> channel_ = OpenStopChannel({ArmMake::kUr, kUrHost}, &bench_.network);
};

TEST_F(StopChannelTest, ReceivesDataFromTheController) { EXPECT_EQ(Tend(5000), Link::kTalks); }

// The arm must brake although the loop continues to send velocities.
TEST_F(StopChannelTest, BrakesTheArm) {
  bench_.Connect().Ticks(300, 1.0);
  ASSERT_DOUBLE_EQ(bench_.speed(), 1.0);
  EXPECT_TRUE(channel_->Stop());
  bench_.Ticks(60, 1.0);
  EXPECT_LT(bench_.speed(), 0.6);
  bench_.Ticks(60, 1.0);
  EXPECT_EQ(bench_.speed(), 0);
}

TEST_F(StopChannelTest, DetectsImmediatelyThatItIsClosed) {
  Tend(250);
  bench_.fake.Do("drop primary");
  EXPECT_EQ(Tend(3), Link::kLost);
  EXPECT_FALSE(channel_->Stop());
  channel_ = OpenStopChannel({ArmMake::kUr, kUrHost}, &bench_.network);
  EXPECT_EQ(Tend(1000), Link::kTalks);
}

TEST_F(StopChannelTest, DetectsThatTheControllerIsSilent) {
  Tend(250);
  bench_.fake.Do("mute primary");
  EXPECT_EQ(Tend(400), Link::kTalks);
  bench_.network.Pass(0.2);
  EXPECT_EQ(Tend(300), Link::kSilent);
  EXPECT_TRUE(channel_->Stop());  // the controller may still receive
  bench_.fake.Do("unmute primary");
  bench_.network.Pass(0.1);
  EXPECT_EQ(Tend(300), Link::kTalks);
  bench_.fake.Do("mute primary");
  bench_.network.Pass(3.2);
  EXPECT_EQ(Tend(100), Link::kLost);
  bench_.fake.Do("unmute primary");
  EXPECT_EQ(Tend(300), Link::kLost);  // permanently
}

}  // namespace
}  // namespace predictor
