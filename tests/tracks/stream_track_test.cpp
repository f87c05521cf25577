// Tests the conversion of streams to measurements of the person.
#include "tracks/stream_track.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/stream_sample.h"

namespace predictor::tracks {
namespace {

StreamDescription Trackers() {
  StreamDescription stream{.name = "trackers", .rate = 100};
  stream.channels = {"elbow.x", "elbow.y", "elbow.z", "HR"};
  stream.units = {"mm", "mm", "mm", "1/min"};
  stream.map =
      "stream: trackers\n"
      "offset: -0.01\n"
      "frame: {xyz: [0, 0, 1], rpy: [0, 0, 90 deg]}\n"
      "left_elbow: {position: [elbow]}\n"
      "series:\n"
      "  - {name: pulse, channel: HR}\n";
  return stream;
}

std::string MessageOf(const StreamDescription& stream) {
  try {
    const StreamTrack track(stream);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StreamTrack, ConvertsSamplesInParts) {
  StreamTrack track(Trackers());
  for (int i = 0; i < 10; ++i) {
    track.Take(0.1 * i, std::array{100.0 * i, 50.0, 0.0, 60.0 + i});
    if (i % 3 == 2) track.Convert();
  }
  track.Convert();
  const BodyTrack& body = track.track();
  EXPECT_EQ(body.offset, 0);  // the times contain it already
  ASSERT_TRUE(body.elbows[0]);
  EXPECT_EQ(body.elbows[0]->times.size(), 10u);
  // The frame is rotated by 90° about z, and its origin is 1 m above that of W.
  const auto p = body.elbows[0]->PositionAt(0.39);
  ASSERT_TRUE(p);
  EXPECT_NEAR((*p - Vector3(-0.05, 0.4, 1)).norm(), 0, 1e-12);
  ASSERT_EQ(body.signals.size(), 1u);
  EXPECT_EQ(body.signals[0].unit, "1/min");
  EXPECT_EQ(body.signals[0].values.back(), 69);
}

TEST(StreamTrack, LeavesOutSamplesThatDoNotFit) {
  StreamTrack track(Trackers());
  const std::array values = {1.0, 2.0, 3.0, 60.0};
  track.Take(1, values);
  track.Take(1, values);    // not later
  track.Take(0.5, values);  // the clock went back
  track.Take(std::nan(""), values);
  track.Take(2, std::span<const double>(values).first(3));  // another number of channels
  track.Convert();
  EXPECT_EQ(track.track().elbows[0]->times.size(), 1u);
}

TEST(StreamTrack, ForgetsOldMeasurements) {
  StreamTrack track(Trackers());
  for (int i = 0; i < 100; ++i) track.Take(i, std::array{1.0, 2.0, 3.0, 60.0});
  track.Convert();
  track.Forget(90);
  EXPECT_EQ(track.track().elbows[0]->times.size(), 9u);  // the offset is -0.01 s
  EXPECT_EQ(track.track().elbows[0]->p.size(), 9u);
  EXPECT_EQ(track.track().signals[0].values.size(), 9u);
}

TEST(StreamTrack, TakesTheNamesOfChannelsWithoutAMapping) {
  StreamDescription stream{.name = "vr"};
  stream.channels = {"right_elbow.p.x", "right_elbow.p.y", "right_elbow.p.z", "pulse"};
  stream.units = {"m", "m", "m", ""};
  const StreamTrack track(stream);
  EXPECT_TRUE(track.track().elbows[1]);
  EXPECT_FALSE(track.track().elbows[0]);
  EXPECT_EQ(track.track().signals.at(0).name, "pulse");
}

TEST(StreamTrack, RefusesAMappingThatDoesNotFit) {
  StreamDescription stream = Trackers();
  stream.channels[0] = "elbow.X";
  EXPECT_NE(MessageOf(stream).find("There is no channel"), std::string::npos) << MessageOf(stream);
  stream = Trackers();
  stream.units[0] = "";
  EXPECT_NE(MessageOf(stream).find("unit"), std::string::npos) << MessageOf(stream);
  stream.map = "stream: trackers\n";
  EXPECT_NE(MessageOf(stream).find("maps nothing"), std::string::npos) << MessageOf(stream);
  stream.map = "stream: trackers\nleft_hand: {position: [elbow]}\n";
  EXPECT_NE(MessageOf(stream).find("Remove left_hand"), std::string::npos) << MessageOf(stream);
  stream.map = "file: a.csv\nleft_elbow: {position: [elbow]}\n";
  EXPECT_NE(MessageOf(stream).find("stream"), std::string::npos) << MessageOf(stream);
}

TEST(StreamDescription, IsReadBack) {
  const StreamDescription read = ParseStream(TextOf(Trackers()));
  EXPECT_EQ(read.name, "trackers");
  EXPECT_EQ(read.map, Trackers().map);
  EXPECT_EQ(read.rate, 100);
  EXPECT_EQ(read.channels, Trackers().channels);
  EXPECT_EQ(read.units, Trackers().units);
}

// The text may come from another process or from a file.
TEST(StreamDescription, RefusesOtherText) {
  StreamDescription many = Trackers();
  many.channels.resize(kMaxStreamChannels + 1);
  many.units.resize(kMaxStreamChannels + 1);
  StreamDescription none = Trackers();
  none.channels.clear(), none.units.clear();
  StreamDescription uneven = Trackers();
  uneven.units.pop_back();
  StreamDescription long_label = Trackers();
  long_label.channels[0].assign(300, 'a');
  for (const std::string& text : {std::string("{"), std::string("[]"), std::string("{}"),
                                  TextOf(many), TextOf(none), TextOf(uneven), TextOf(long_label)})
    EXPECT_THROW(ParseStream(text), InputError) << text;
}

}  // namespace
}  // namespace predictor::tracks
