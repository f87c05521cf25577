// Measurements of the person that another system sends as a stream during a run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tracks/body_track.h"

namespace predictor::tracks {

// What is known about a stream when the run starts.
struct StreamDescription {
  std::string name;                   // as the sender calls the stream
  std::string map;                    // mapping (YAML); "": the channels are named as in a table
  double rate = 0;                    // samples per second, as the sender states it; 0: irregular
  std::vector<std::string> channels;  // labels
  std::vector<std::string> units;     // of the channels; "": not stated
};

// The description as JSON. The recording and the processes alongside the run pass on this text.
std::string TextOf(const StreamDescription& stream);
// Throws InputError if the text is something else or exceeds the limits of core/stream_sample.h.
StreamDescription ParseStream(const std::string& text);

// A mapping of a stream: a mapping of a track with the name of a stream instead of a file.
struct StreamMap : TrackMap {
  std::string stream;  // name or type of the stream
};
// Throws InputError with file:line:column.
StreamMap ParseStreamMap(const std::string& text, const std::string& name);

// Converts the samples of one stream to a BodyTrack with the same rules as for a file.
class StreamTrack {
 public:
  // Throws InputError if the mapping does not fit the channels.
  explicit StreamTrack(const StreamDescription& stream);

  const std::string& name() const { return file_.name; }
  std::size_t channels() const { return file_.series.size(); }
  double offset() const { return map_.offset; }  // added to the times of the samples [s]
  // Takes the next sample. `time` is by the clock of the user of the track [s]. A sample is left
  // out if it is not later than the previous one or has another number of channels.
  void Take(double time, std::span<const double> values);
  // Converts the samples that were taken since the last call, and appends them to the track. Throws
  // InputError if they contradict the mapping; they are then left out.
  void Convert();
  // Forgets what was measured before `time` [s].
  void Forget(double time);
  // Its times contain the offset already.
  const BodyTrack& track() const { return track_; }

 private:
  void Append(BodyTrack&& part);

  StreamMap map_;
  SeriesFile file_;  // the samples that are not converted yet
  std::vector<double> times_;
  double last_ = -1e300;
  BodyTrack track_;
};

}  // namespace predictor::tracks
