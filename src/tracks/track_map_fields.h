// Lists every key of a mapping with its unit, meaning and range.
#pragma once

#include <string>
#include <vector>

#include "scenario/fields.h"
#include "tracks/track_map.h"

namespace predictor::tracks {

inline std::vector<std::string> NamesOf(WrenchAxes) { return {"file", "hand"}; }
inline std::vector<std::string> NamesOf(WrenchOn) { return {"handle", "hand"}; }
inline std::vector<std::string> NamesOf(ArmSide) { return {"left", "right"}; }
inline std::vector<std::string> NamesOf(TrackClock) { return {"recording", "unix", "auto"}; }

template <class V>
void PartFields(V& v, PartMap& s) {
  const auto names = [](const char* doc, std::size_t most) { return List(Word(doc), 0, most); };
  v("position", s.position,
    names("channels of x, y, z; or one name, to which .x, .y, .z are added", 3));
  v("markers", s.markers, names("points whose mean is the position", 16));
  v("rotation", s.rotation,
    names("channels of the quaternion w, x, y, z; or one name, to which .w, .x, .y, .z are added",
          4));
  v("front", s.front, names("markers in front: x points from back to front", 8));
  v("back", s.back, names("markers behind", 8));
  v("left", s.left, names("markers on the left: y points from right to left", 8));
  v("right", s.right, names("markers on the right", 8));
  v("xyz", s.xyz, Number("m", "position of the part in the tracked frame", Within(2)));
  v("rpy", s.rpy,
    Number("rad", "roll, pitch, yaw of the part in the tracked frame", Within(kFullTurn)));
}

template <class V>
void Fields(V& v, PartMap& s) {
  PartFields(v, s);
}

template <class V>
void Fields(V& v, HandMap& s) {
  PartFields(v, s);
  const auto three = [](const char* doc) { return List(Word(doc), 0, 3); };
  v("force", s.force, three("channels of the force along x, y, z, or one name"));
  v("torque", s.torque, three("channels of the torque about x, y, z, or one name"));
  v("axes", s.axes, Word("whose axes the force and the torque refer to: hand or file"));
  v("on", s.on, Word("what the force and the torque act on: handle or hand"));
  v("about", s.about,
    Number("m", "point about which the torque acts, in the frame of the handle", Within(2)));
  v("holds", s.holds, Word("channel above 0.5 while the hand holds; \"\": it always holds"));
}

template <class V>
void Fields(V& v, SeriesMap& s) {
  v("name", s.name, Required(Word("name in the results")));
  v("channel", s.channel, Required(Word("channel of the file")));
  v("unit", s.unit, Word("\"\": as the file states it"));
}

template <class V>
void Fields(V& v, EmgMap& s) {
  v("channel", s.channel, Required(Word("channel of the file with the raw electromyogram")));
  v("arm", s.arm, Required(Word("arm of the muscles")));
  v("muscles", s.muscles, Required(List(Word("muscles under the electrode"), 1, 4)));
  v("mvc", s.mvc,
    Number("", "envelope of a maximum voluntary contraction, in the unit of the channel",
           From(0, 1e9)));
  v("shape", s.shape,
    Number("", "A of the activation (e^(A u) - 1)/(e^A - 1); 0: straight", From(-3, 0)));
  v("delay", s.delay, Number("s", "from the electrical to the mechanical onset", From(0.01, 0.08)));
  v("band_low", s.band_low, Number("Hz", "lower end of the band-pass", From(10, 100)));
  v("band_high", s.band_high,
    Number("Hz", "upper end of the band-pass, below half of the channel's rate", From(100, 1000)));
  v("weight", s.weight,
    Number("",
           "cost of an activation that differs from the measured one, relative to that of an "
           "activation",
           Above(0, 1e6)));
}

// The keys that do not depend on the kind of source.
template <class V>
void BodyFields(V& v, TrackMap& s) {
  v("frame", s.frame, Part("the file's frame in W"));
  v("unit", s.unit, Word("unit of positions; \"\": as the file states it"));
  v("force_unit", s.force_unit, Word("unit of forces; \"\": as the file states it"));
  v("torque_unit", s.torque_unit, Word("unit of torques; \"\": as the file states it"));
  v("head", s.head, Part("the eyes; x forward, y left, z up"));
  v("left_elbow", s.left_elbow, Part("centre of the left elbow"));
  v("right_elbow", s.right_elbow, Part("centre of the right elbow"));
  v("left_hand", s.left_hand, Part("the left hand or its handle"));
  v("right_hand", s.right_hand, Part("the right hand or its handle"));
  v("series", s.series, List(Part("other measured numbers, such as heart rate"), 0, 64));
  v("emg", s.emg, List(Part("raw electromyograms of arm muscles"), 0, 64));
}

template <class V>
void TrackFields(V& v, TrackMap& s) {
  v("time", s.time,
    Word("table: the column with the times; \"\": time or timestamp. Bag: received selects the "
         "times at which the messages were received, instead of their own stamps"));
  v("time_unit", s.time_unit, Word("\"\": as the header states it, otherwise s"));
  v("rate", s.rate,
    Number("Hz", "rate of the rows of a table without times; 0: the table has times",
           From(0, 1e5)));
  v("clock", s.clock, Word("what the file's times mean"));
  v("offset", s.offset, Number("s", "added to the file's times", Within(1e10)));
  BodyFields(v, s);
}

template <class V>
void Fields(V& v, TrackMap& s) {
  v("file", s.file, Required(Word("data, relative to this mapping")));
  TrackFields(v, s);
}

}  // namespace predictor::tracks
