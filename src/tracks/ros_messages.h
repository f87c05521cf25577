// Converts ROS 2 messages to numbers over time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tracks/series.h"

namespace predictor::tracks {

// The clock from which a message takes its time.
enum class MessageTime {
  kStamp,     // header.stamp, if the message has one
  kReceived,  // when the recorder received it
};

class Cdr;  // reader of serialised messages

// Collects the messages of one topic as channels TOPIC.FIELD, for example
// /left/wrench.wrench.force.x. The messages must be encoded as CDR, in either byte order. The
// supported types of geometry_msgs are Wrench, Pose, Point, Vector3 and Quaternion, each with and
// without Stamped, PoseWithCovarianceStamped and TransformStamped. The other supported types are
// TFMessage (as TOPIC[CHILD FRAME].transform, relative to any parent), Odometry (its pose),
// JointState (as TOPIC.position[JOINT]) and Float64 of std_msgs. Positions have the unit m, forces
// N, torques N m (REP 103).
class RosTopic {
 public:
  RosTopic(std::string topic, const std::string& type);
  static bool IsKnown(const std::string& type);

  // `received` is in [ns]. Throws InputError if the bytes are not a message of a supported type.
  void Add(std::string_view cdr, std::int64_t received, MessageTime clock);
  // Moves the channels to `series`. Throws InputError if a time is earlier than the one before it.
  // A message with the same time as its predecessor is omitted.
  void Finish(const std::string& file, std::vector<Series>* series);

 private:
  // In the following functions, `cdr` contains one message, or one transform of a TFMessage.
  void AddOne(Cdr* cdr, std::int64_t received, MessageTime clock);
  void AddTransforms(Cdr* cdr, std::int64_t received, MessageTime clock);
  void Put(const std::string& field, const char* unit, double value);

  std::string topic_, type_;
  std::vector<double> times_;
  std::vector<std::string> order_;
  std::map<std::string, Series> channels_;  // channels by field
  std::vector<RosTopic> frames_;            // topics of a TFMessage, one for each child frame
};

// Reads a ROS 2 bag according to its format: MCAP or SQLite (.db3), or a folder that contains one
// such file. Topics of other types are omitted, and the error about a missing channel lists their
// names.
SeriesFile ReadRosBag(const std::filesystem::path& file, MessageTime clock);

}  // namespace predictor::tracks
