// Compares the bytes of messages with the bytes that ROS itself writes. Also checks how messages
// are framed in the stream.
#include <gtest/gtest.h>

#include <map>

#include "ros_tcp/framing.h"
#include "ros_tcp/golden.h"
#include "ros_tcp/ros_messages.h"

namespace predictor::ros_tcp {
namespace {

class Ros : public testing::TestWithParam<RosDialect> {
 protected:
  template <class Message>
  void Expect(const std::string& name, const Message& message) {
    const std::string key = name + " " + Name(GetParam());
    ASSERT_TRUE(golden_.contains(key)) << key;
    EXPECT_EQ(Serialise(message, GetParam()), golden_[key]) << key;
  }
  std::map<std::string, std::string> golden_ = Golden();
  const RosHeader header_{7, 12, 345, "world"};
  const Pose pose_{{0.25, -1.5, 3}, Quaternion(0.5, 0.5, -0.5, 0.5)};
};
INSTANTIATE_TEST_SUITE_P(Dialects, Ros, testing::Values(RosDialect::kRos1, RosDialect::kRos2),
                         [](const auto& dialect) { return Name(dialect.param); });

TEST_P(Ros, WritesTheSameBytes) {
  Expect("string0", RosString{""});
  Expect("string1", RosString{"RUN"});
  Expect("string2", RosString{"HELD force left 30.1 30"});
  Expect("pose", RosPoseStamped{header_, pose_});
  Wrench wrench;
  wrench << 1, 2, 3, -4, 5.5, 0.125;
  Expect("wrench", RosWrenchStamped{header_, wrench});
  Expect("array", RosFloat64MultiArray{"left, right", {0.001, 0.002}});
  for (int count = 0; count < 4; ++count) {
    RosJointState joints;
    joints.header = header_;
    for (int k = 0; k < count; ++k) {
      joints.name.push_back("joint" + std::string(static_cast<std::size_t>(k), 'x'));
      joints.position.push_back(0.5 * k - 0.25);
      joints.effort.push_back(8.0 * k - 1.5);
    }
    joints.velocity = joints.position;
    Expect("joints" + std::to_string(count), joints);
  }
}

TEST_P(Ros, WritesMarkersTheSame) {
  const std::vector<Vector3> points = {{0, 1, 2}, {3, 4, 5.5}};
  const struct {
    const char *name, *text;
    std::size_t points;
    std::int32_t type;
  } cases[] = {{"arrow", "", 2, RosMarker::kArrow},
               {"line", "", 2, RosMarker::kLineStrip},
               {"words", "red", 0, RosMarker::kLineStrip},
               {"odd", "ab", 1, RosMarker::kLineStrip}};
  for (const auto& c : cases) {
    RosMarker m;
    m.header = header_;
    m.ns = std::string("force") + c.text;
    m.id = 1;
    m.type = c.type;
    m.pose = pose_;
    m.scale = {0.01, 0.02, 0};
    m.color = {0.5, 0.25, 0.75, 1};
    m.points.assign(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(c.points));
    m.text = c.text;
    Expect(c.name, m);
  }
}

TEST(Framing, GivesFramesHoweverTheyArrive) {
  const std::string stream = Encode("__subscribe", "{\"a\":1}") + Encode("", "") +
                             Encode(std::string("__topic_list\0", 13), std::string("{}\0", 3)) +
                             Encode("/predictor/stop", std::string(1, '\x01'));
  for (std::size_t step = 1; step <= stream.size(); ++step) {
    FrameReader reader;
    std::vector<std::string> seen;
    for (std::size_t at = 0; at < stream.size(); at += step) {
      reader.Feed(std::string_view(stream).substr(at, step));
      while (const auto frame = reader.Next())
        seen.push_back(frame->destination + "|" + frame->payload);
    }
    ASSERT_EQ(seen, (std::vector<std::string>{"__subscribe|{\"a\":1}", "__topic_list|{}",
                                              std::string("/predictor/stop|\x01", 17)}));
    EXPECT_FALSE(reader.broken());
  }
}

TEST(Framing, RefusesLengthsThatNoFrameHas) {
  FrameReader destination, payload;
  destination.Feed(std::string(4, '\xff'));
  EXPECT_FALSE(destination.Next());
  EXPECT_TRUE(destination.broken());
  payload.Feed(Bytes("01000000 61 ffffff7f"));
  EXPECT_FALSE(payload.Next());
  EXPECT_TRUE(payload.broken());
}

}  // namespace
}  // namespace predictor::ros_tcp
