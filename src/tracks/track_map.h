// The mapping from the channels of another system's file to parts of a person's body.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenario/problems.h"
#include "scenario/scenario.h"
#include "scenario/yaml_tree.h"
#include "tracks/series.h"

namespace predictor::tracks {

// The source of the pose of a part of the body. The frame of the part is the tracked frame T,
// multiplied by the pose `xyz`, `rpy`.
struct PartMap {
  std::vector<std::string> position;  // three channels, or NAME for NAME.x, NAME.y, NAME.z
  std::vector<std::string> markers;   // or points whose mean is the position; all must be present
  std::vector<std::string> rotation;  // four channels w, x, y, z, or NAME for NAME.w, ...
  // As an alternative, the source consists of four sets of markers on the sides of the part. The x
  // axis of T then points from back to front, and its y axis from right to left.
  std::vector<std::string> front, back, left, right;
  Vector3 xyz = Vector3::Zero(), rpy = Vector3::Zero();
};

enum class WrenchAxes { kFile, kHand };
enum class WrenchOn { kHandle, kHand };

struct HandMap : PartMap {                 // the pose is that of the handle's frame
  std::vector<std::string> force, torque;  // three channels each, or one NAME, as in `position`
  WrenchAxes axes = WrenchAxes::kFile;     // axes of the components
  WrenchOn on = WrenchOn::kHandle;         // the body on which the wrench acts
  Vector3 about = Vector3::Zero();  // point about which the torque acts, in the handle's frame [m]
  std::string holds;                // channel that is above 0.5 while the hand holds
};

struct SeriesMap {
  std::string name, channel, unit;  // unit: "": as the file states it
};

enum class ArmSide { kLeft, kRight };

// The raw electromyogram of one or several muscles of an arm. The names of the muscles are the keys
// of muscles::MuscleTable, which belongs to a module that the tracks module does not use.
struct EmgMap {
  std::string channel;
  ArmSide arm = ArmSide::kLeft;
  std::vector<std::string> muscles;
  // Envelope of a maximum voluntary contraction, in the unit of the channel. An activation can be
  // computed from a voltage only relative to this envelope. The value 0 means that the envelope is
  // not given, which CheckTrackMap refuses.
  double mvc = 0;
  double shape = -2, delay = 0.04;        // as in muscles::EmgProcessing; [s]
  double band_low = 20, band_high = 450;  // [Hz]
  double weight = 10;                     // see muscles::ActivationProblem::trust (D)
};

// The meaning of the times in the file.
enum class TrackClock {
  kRecording,  // seconds since the first tick of the recording
  kUnix,       // seconds since 1970, by a computer whose clock agrees with that of the run
  kAuto,       // unknown: estimated from the motion of the hands
};

struct TrackMap {
  std::string file;  // relative to the mapping
  std::string time, time_unit;
  double rate = 0;  // rate of the rows of a table without times [Hz]

  TimeColumn TimeOf() const { return {time, time_unit, rate}; }
  TrackClock clock = TrackClock::kRecording;
  double offset = 0;                          // added to the file's times [s]
  PoseSpec frame;                             // pose of the file's frame in W
  std::string unit, force_unit, torque_unit;  // "": as the file states it
  std::optional<PartMap> head, left_elbow, right_elbow;
  std::optional<HandMap> left_hand, right_hand;
  std::vector<SeriesMap> series;
  std::vector<EmgMap> emg;

  bool MapsNothing() const {
    return !head && !left_elbow && !right_elbow && !left_hand && !right_hand && series.empty() &&
           emg.empty();
  }
};

// Returns the mapping of a table whose columns are named like the parts: head.p.x [m], head.q.w,
// left_elbow.p.x [m], left_hand.p.x [m], left_hand.force.x [N], left_hand.torque.x [N m],
// left_hand.holds, ..., in W and in the clock of the recording. All other columns are signals.
TrackMap MapOfColumns(const SeriesFile& file);

// Throws InputError, which gives the place (file:line:column) and the text to write instead.
TrackMap ParseTrackMap(const std::string& text, const std::string& name);
TrackMap LoadTrackMap(const std::filesystem::path& file);
// Reports parts that are described incompletely or twice, and electromyograms that cannot be
// normalised.
void CheckTrackMap(const TrackMap& map, const YamlNode& root, Problems* problems);

}  // namespace predictor::tracks
